//! The licences of all dependencies permit distributing the program. They are read from the
//! packages.

mod packages;
mod texts;

use packages::{Package, linked};
use std::path::Path;

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

/// File with the list of licences.
const LIST: &str = "assets/LICENCES.md";

/// File with the texts of licences.
const TEXTS: &str = "assets/LICENCE-TEXTS.txt";

/// The packages; `None`, with a line, where cargo cannot list them.
fn packages() -> Option<Vec<Package>> {
    let packages = linked();
    if packages.is_none() {
        eprintln!("skipped: cargo cannot list the packages here; `cargo fetch --locked` makes it possible");
    }
    packages
}

#[test]
fn every_licence_permits_distribution() {
    let Some(packages) = packages() else { return };
    assert!(packages.len() > 100);
    let refused: Vec<_> = packages.iter().filter(|package| !is_permitted(&package.licence)).collect();
    assert!(refused.is_empty(), "{refused:?}");
}

/// Writes a file of the package if `UPDATE_LICENCES` is set; else it must be as `expected`.
fn assert_current(file: &str, expected: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    if std::env::var_os("UPDATE_LICENCES").is_some() {
        std::fs::write(&path, expected).unwrap();
    }
    let current = std::fs::read_to_string(&path).unwrap_or_default().replace("\r\n", "\n");
    let first = current.lines().zip(expected.lines()).find(|(is, should)| is != should);
    assert!(
        current == expected,
        "{file} is stale, first at {first:?}; run `UPDATE_LICENCES=1 cargo test -p afterimage-ui licences`"
    );
}

#[test]
fn the_list_and_the_texts_are_those_of_the_packages() {
    let Some(packages) = packages() else { return };
    let list = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(LIST)).unwrap();
    let head = list.replace("\r\n", "\n").split_once("|---|---|---|\n").unwrap().0.to_owned();
    let row = |p: &Package| format!("| {} | {} | {} |\n", p.name, p.version, p.licence);
    assert_current(LIST, &format!("{head}|---|---|---|\n{}", packages.iter().map(row).collect::<String>()));
    let entries = texts::gather(&packages);
    assert_eq!(texts::missing(&entries, &packages), Vec::<String>::new());
    let texts = texts::write(&entries);
    assert!(!texts.to_lowercase().contains("gnu general public"), "a choice that is not taken");
    assert_current(TEXTS, &texts);
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
