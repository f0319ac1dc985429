//! The packages that are linked into the program, as cargo knows them.

use serde_json::Value;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The systems that the program is built for. Packages for others are never linked.
const TARGETS: [&str; 4] =
    ["x86_64-unknown-linux-gnu", "x86_64-pc-windows-msvc", "x86_64-apple-darwin", "aarch64-apple-darwin"];

/// A package that is linked into the program.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Package {
    pub(super) name: String,
    pub(super) version: String,
    /// The licence expression that its authors state.
    pub(super) licence: String,
    pub(super) authors: Vec<String>,
    /// Folder of its source.
    pub(super) folder: PathBuf,
}

/// Returns the output of a command of cargo; `None` where it fails, as without network and without
/// the sources of packages.
fn cargo(arguments: &[&str]) -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = Command::new(env!("CARGO"));
    let output = command.args(arguments).args(["--locked", "--offline"]).current_dir(folder).output().ok()?;
    String::from_utf8(output.stdout).ok().filter(|_| output.status.success())
}

/// Returns all packages that are linked, sorted; not those that only run while the program is
/// built or tested.
pub(super) fn linked() -> Option<Vec<Package>> {
    let metadata: Value = serde_json::from_str(&cargo(&["metadata", "--format-version", "1"])?).unwrap();
    let text = |package: &Value, key: &str| package[key].as_str().unwrap_or("none stated").to_owned();
    let package = |package: &Value| Package {
        name: text(package, "name"),
        version: text(package, "version"),
        licence: text(package, "license"),
        authors: serde_json::from_value(package["authors"].clone()).unwrap(),
        folder: Path::new(package["manifest_path"].as_str().unwrap()).parent().unwrap().to_owned(),
    };
    let all = metadata["packages"].as_array().unwrap().iter().map(package);
    let by_name: HashMap<String, Package> = all.map(|p| (format!("{} v{}", p.name, p.version), p)).collect();
    let mut arguments =
        vec!["tree", "--package", "afterimage-ui", "--edges", "normal,no-proc-macro", "--prefix", "none"];
    arguments.extend(TARGETS.iter().flat_map(|target| ["--target", target]));
    let tree = cargo(&arguments)?;
    let names: BTreeSet<String> =
        tree.lines().map(|line| line.split(' ').take(2).collect::<Vec<_>>().join(" ")).collect();
    let is_own = |name: &str| name.starts_with("afterimage");
    let linked = names.iter().filter(|name| !name.is_empty() && !is_own(name));
    Some(linked.map(|name| by_name[name].clone()).collect())
}
