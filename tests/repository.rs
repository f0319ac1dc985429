//! The files of the repository can be checked out on every system.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Names that Windows keeps for devices, with any extension.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];

/// Returns the tracked files, as paths with `/`; `None` where this is no checkout.
fn tracked_files() -> Option<Vec<String>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new("git").arg("-C").arg(root).args(["ls-files", "-z"]).output().ok()?;
    let text = String::from_utf8(output.stdout).ok().filter(|_| output.status.success())?;
    let files: Vec<String> = text.split_terminator('\0').map(str::to_owned).collect();
    (!files.is_empty()).then_some(files)
}

/// Returns why a part of a path cannot be the name of a file or folder on Windows.
fn trouble(name: &str) -> Option<&'static str> {
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_lowercase();
    let is_port = stem.strip_prefix("com").or_else(|| stem.strip_prefix("lpt"));
    if DEVICES.contains(&stem.as_str())
        || is_port.is_some_and(|n| n.len() == 1 && n != "0" && n.as_bytes()[0].is_ascii_digit())
    {
        return Some("it is the name of a device");
    }
    if name.ends_with(['.', ' ']) {
        return Some("it ends with a dot or a space");
    }
    let is_refused = |c: char| "<>:\"|?*\\".contains(c) || c < ' ';
    name.contains(is_refused).then_some("it contains a character that is refused there")
}

#[test]
fn every_file_can_be_checked_out_on_windows() {
    let Some(files) = tracked_files() else {
        eprintln!("skipped: git lists no files here");
        return;
    };
    let troubles: Vec<String> = files
        .iter()
        .filter_map(|file| file.split('/').find_map(trouble).map(|why| format!("{file}: {why}")))
        .collect();
    assert!(troubles.is_empty(), "{troubles:#?}");
    let mut lower: Vec<String> = files.iter().map(|file| file.to_lowercase()).collect();
    lower.sort();
    let twice: Vec<_> = lower.windows(2).filter(|pair| pair[0] == pair[1]).collect();
    assert!(twice.is_empty(), "differ in case only: {twice:?}");
    let long: Vec<_> = files.iter().filter(|file| file.len() > 200).collect();
    assert!(long.is_empty(), "longer than Windows opens below a usual folder: {long:?}");
}

#[test]
fn the_names_that_windows_refuses_are_known() {
    for bad in
        ["nul", "NUL.txt", "con.tar.gz", "Com1", "lpt9.obj", "a.", "a ", "a:b", "what?", "a\\b", "a\tb"]
    {
        assert!(trouble(bad).is_some(), "{bad}");
    }
    for fine in ["null", "nul-bytes", "com0", "com10", "console", "auxiliary.rs", ".gitignore", "a.nul"] {
        assert!(trouble(fine).is_none(), "{fine}");
    }
}

/// Returns the files of Rust below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// Returns the files that a source embeds.
fn embedded(source: &Path) -> Vec<PathBuf> {
    let text = std::fs::read_to_string(source).unwrap();
    let calls = ["include_str!(\"", "include_bytes!(\""];
    let names =
        calls.into_iter().flat_map(|call| text.split(call).skip(1).filter_map(|rest| rest.split('"').next()));
    names.map(|name| source.parent().unwrap().join(name)).collect()
}

#[test]
fn a_package_embeds_nothing_that_it_does_not_contain() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (package, excluded) in
        [(root.to_owned(), &["tests", "ui", "docs"][..]), (root.join("ui"), &["tests"])]
    {
        let package = package.canonicalize().unwrap();
        let sources = sources(&package.join("src"));
        let files: Vec<PathBuf> = sources
            .iter()
            // Tests are not compiled where a package is used.
            .filter(|source| !source.ends_with("tests.rs"))
            .flat_map(|source| embedded(source))
            .collect();
        assert!(!files.is_empty(), "{}", package.display());
        for file in files {
            let real = file.canonicalize().unwrap_or_else(|error| panic!("{}: {error}", file.display()));
            let inside =
                real.strip_prefix(&package).unwrap_or_else(|_| panic!("{} is outside", real.display()));
            assert!(
                !excluded.iter().any(|folder| inside.starts_with(folder)),
                "{} is left out",
                inside.display()
            );
        }
    }
    for name in ["LICENSE-MIT", "LICENSE-APACHE"] {
        let text = |folder: &str| std::fs::read_to_string(root.join(folder).join(name)).unwrap();
        assert!(text(".") == text("ui"), "{name} differs in ui/");
    }
}
