//! The licences of all dependencies permit distributing the program. They are read from the
//! packages.

use serde_json::Value;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::process::Command;

/// Licences whose terms a program under MIT or Apache-2.0 can meet.
const PERMITTED: [&str; 13] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "0BSD",
    "ISC",
    "Zlib",
    "BSL-1.0",
    "CC0-1.0",
    "Unlicense",
    "Unicode-3.0",
    "MPL-2.0",
];

/// Licences that are permitted for fonts, which are data.
const PERMITTED_FONTS: [&str; 2] = ["OFL-1.1", "Ubuntu-font-1.0"];

/// True if every part of a licence expression offers a permitted choice.
fn is_permitted(expression: &str) -> bool {
    let is_fine = |word: &str| PERMITTED.contains(&word) || PERMITTED_FONTS.contains(&word);
    let trimmed = |part: &str| part.trim().trim_matches(['(', ')']).trim().to_owned();
    let expression = expression.replace('/', " OR ");
    expression.split(" AND ").all(|part| part.split(" OR ").any(|choice| is_fine(&trimmed(choice))))
}

/// Name, version and licence of every package that is linked into the program, on any system.
fn packages() -> Option<BTreeSet<[String; 3]>> {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked", "--offline", "--manifest-path"])
        .arg(manifest)
        .output()
        .ok()
        .filter(|o| o.status.success())?;
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let by_id = |list: &Value| -> HashMap<String, Value> {
        list.as_array().unwrap().iter().map(|v| (v["id"].as_str().unwrap().to_owned(), v.clone())).collect()
    };
    let (all, nodes) = (by_id(&metadata["packages"]), by_id(&metadata["resolve"]["nodes"]));
    let members = metadata["workspace_members"].as_array().unwrap();
    let mut todo: Vec<String> = members.iter().map(|m| m.as_str().unwrap().to_owned()).collect();
    let mut seen: BTreeSet<String> = todo.iter().cloned().collect();
    while let Some(id) = todo.pop() {
        for dependency in nodes[&id]["deps"].as_array().unwrap() {
            // The encoder's tests with random input are not part of a program.
            let is_linked = dependency["dep_kinds"].as_array().unwrap().iter();
            let is_linked =
                is_linked.into_iter().any(|k| k["kind"].is_null() && k["target"] != "cfg(fuzzing)");
            let id = dependency["pkg"].as_str().unwrap().to_owned();
            if is_linked && seen.insert(id.clone()) {
                todo.push(id);
            }
        }
    }
    let text = |package: &Value, key: &str| package[key].as_str().unwrap_or("none stated").to_owned();
    let others = seen.iter().filter(|id| !members.iter().any(|m| m.as_str() == Some(id.as_str())));
    Some(others.map(|id| ["name", "version", "license"].map(|key| text(&all[id], key))).collect())
}

#[test]
fn every_licence_permits_distribution() {
    let Some(packages) = packages() else {
        eprintln!("skipped: cargo cannot list the packages here");
        return;
    };
    assert!(packages.len() > 100);
    let refused: Vec<_> = packages.iter().filter(|[.., licence]| !is_permitted(licence)).collect();
    assert!(refused.is_empty(), "{refused:?}");
    if std::env::var_os("UPDATE_LICENCES").is_some() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/LICENCES.md");
        let list = std::fs::read_to_string(&path).unwrap();
        let (head, _) = list.split_once("|---|---|---|\n").unwrap();
        let rows: String = packages
            .iter()
            .map(|[name, version, licence]| format!("| {name} | {version} | {licence} |\n"))
            .collect();
        std::fs::write(&path, format!("{head}|---|---|---|\n{rows}")).unwrap();
    }
}

#[test]
fn expressions_are_read_as_choices_within_parts() {
    for fine in ["MIT", "Apache-2.0 OR GPL-2.0-only", "MIT/Apache-2.0", "(MIT OR Apache-2.0) AND Unicode-3.0"]
    {
        assert!(is_permitted(fine), "{fine}");
    }
    for refused in ["GPL-3.0", "AGPL-3.0-only", "MIT AND GPL-2.0-only", "none stated"] {
        assert!(!is_permitted(refused), "{refused}");
    }
}
