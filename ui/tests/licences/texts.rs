//! The licence texts of packages: gathered from their sources, each text once.

use super::packages::Package;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Beginnings of the names of files that hold licences, in lower case.
const NAMES: [&str; 8] = ["license", "licence", "copying", "notice", "unlicense", "copyright", "ofl", "ufl"];

/// Folders of a package whose files are not linked.
const UNLINKED: [&str; 7] = ["tests", "test", "examples", "benches", "docs", "images", "fuzz"];

/// Kinds of licences, by words that only their texts have.
const KINDS: [(&str, &str); 11] = [
    ("SIL Open Font License", "sil open font license"),
    ("Ubuntu Font Licence", "ubuntu font licence"),
    ("Apache License 2.0", "apache license version 2.0"),
    (
        "MIT License",
        "permission is hereby granted, free of charge, to any person obtaining a copy of this software",
    ),
    ("BSD License", "redistribution and use in source and binary forms"),
    ("ISC License", "permission to use, copy, modify, and/or distribute this software for any purpose"),
    ("zlib License", "altered source versions must be plainly marked"),
    ("Boost Software License", "boost software license"),
    ("Unicode License", "unicode"),
    ("Unlicense", "this is free and unencumbered software released into the public domain"),
    ("Notice", ""),
];

/// A licence text, and where it applies.
#[derive(Default)]
pub(super) struct Entry {
    kind: usize,
    /// The text, without lines of copyright where it is the same for all.
    text: String,
    /// Name and version of each package, with its lines of copyright.
    packages: BTreeMap<String, BTreeSet<String>>,
}

/// Returns the words of a text in lower case: texts that differ in line breaks are the same.
fn words(text: &str) -> String {
    text.split(|c: char| c.is_whitespace() || "\"“”'’`*#".contains(c))
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
        .to_lowercase()
}

fn kind_of(text: &str) -> usize {
    let words = words(text).replace("license, version", "license version");
    KINDS.iter().position(|(_, mark)| words.contains(mark)).unwrap()
}

/// True for a line that names the holder of rights: by a year, the sign of copyright, or a group of
/// people. Terms begin lines with the word as well.
fn is_copyright(line: &str) -> bool {
    const MARKS: [&str; 7] = ["(c)", "(C)", "©", "ontributors", "evelopers", "uthors", "roject"];
    let line = line.trim().trim_start_matches(['#', '*', '-', ' ']);
    let is_to_fill_in = line.contains("yyyy");
    let names = MARKS.iter().any(|mark| line.contains(mark)) || line.contains(|c: char| c.is_ascii_digit());
    (line.starts_with("Copyright") || line.starts_with("(c)") || line.starts_with('©'))
        && names
        && !is_to_fill_in
}

/// Splits a text into its lines of copyright and the rest.
fn split(text: &str) -> (BTreeSet<String>, String) {
    let text = text.replace("\r\n", "\n").replace('\u{feff}', "");
    let copyright =
        text.lines().filter(|line| is_copyright(line)).map(|line| line.trim().to_owned()).collect();
    let rest: Vec<&str> = text.lines().filter(|line| !is_copyright(line)).map(str::trim_end).collect();
    (copyright, rest.join("\n").trim_matches('\n').to_owned())
}

/// Returns by what two texts of a kind are the same. The appendix of Apache's is an example.
fn key(kind: usize, text: &str) -> String {
    let words = words(text);
    let end = words.find("end of terms and conditions").unwrap_or(words.len());
    // A headline is no term.
    let words = words[..end].trim_start_matches("the ").trim_start_matches("mit license ");
    format!("{kind} {}", words.trim_start_matches("(mit) ").trim_end_matches(['.', ' ']))
}

/// Returns the files of a folder that hold licences, also of folders in it.
fn licence_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    for path in entries.map(|entry| entry.path()) {
        let name = path.file_name().unwrap().to_string_lossy().to_lowercase();
        if path.is_dir() && !UNLINKED.contains(&name.as_str()) {
            files.extend(licence_files(&path));
        } else if path.is_file() && !name.ends_with(".rs") && NAMES.iter().any(|n| name.starts_with(n)) {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// Returns the texts of a package's source. Where its authors offer a choice, those of the MIT
/// licence, else of Apache's, and BSD texts of what they took over.
fn texts_of(package: &Package) -> Vec<String> {
    let files = licence_files(&package.folder);
    let mut texts: Vec<String> = files
        .iter()
        .map(|file| String::from_utf8_lossy(&std::fs::read(file).unwrap()).into_owned())
        .collect();
    let is_kind = |text: &String, kind: &str| KINDS[kind_of(text)].0 == kind;
    let choices = [("MIT", "MIT License"), ("Apache-2.0", "Apache License 2.0")];
    let is_there = |(name, kind): &(&str, &str)| {
        package.licence.contains(name) && texts.iter().any(|text| is_kind(text, kind))
    };
    if !package.licence.contains("AND")
        && let Some((_, chosen)) = choices.iter().find(|choice| is_there(choice))
    {
        texts.retain(|text| is_kind(text, chosen) || is_kind(text, "BSD License"));
    }
    texts.retain(|text| words(text).len() > 60);
    texts
}

/// Returns the kind whose usual text is taken for a package without one.
fn usual_kind(licence: &str) -> usize {
    let name = if licence.contains("MIT") {
        "MIT License"
    } else if licence.contains("Apache-2.0") {
        "Apache License 2.0"
    } else if licence.contains("BSL-1.0") {
        "Boost Software License"
    } else {
        panic!("which text has {licence}?")
    };
    KINDS.iter().position(|(kind, _)| *kind == name).unwrap()
}

/// The holders of rights of a package that states none.
fn authors(package: &Package) -> String {
    match package.authors.as_slice() {
        [] => format!("Copyright (c) the authors of {}", package.name),
        names => format!("Copyright (c) {}", names.join(", ")),
    }
}

/// Gathers the texts of all packages, each once, by kind and by the number of packages.
pub(super) fn gather(packages: &[Package]) -> Vec<Entry> {
    let mut entries: BTreeMap<String, Entry> = BTreeMap::new();
    let mut without = Vec::new();
    for package in packages {
        let texts = texts_of(package);
        if texts.is_empty() {
            without.push(package);
        }
        for text in texts {
            let (mut copyright, text) = split(&text);
            if copyright.is_empty() {
                copyright.insert(authors(package));
            }
            let kind = kind_of(&text);
            let entry = entries.entry(key(kind, &text)).or_insert(Entry { kind, text, ..Entry::default() });
            entry
                .packages
                .entry(format!("{} {}", package.name, package.version))
                .or_default()
                .extend(copyright);
        }
    }
    let mut entries: Vec<Entry> = entries.into_values().collect();
    entries.sort_by_key(|entry| (entry.kind, usize::MAX - entry.packages.len()));
    let rust =
        ("the Rust standard library".to_owned(), "Copyright (c) the Rust Project contributors".to_owned());
    let more =
        without.iter().map(|p| (usual_kind(&p.licence), format!("{} {}", p.name, p.version), authors(p)));
    for (kind, name, copyright) in more.chain([(usual_kind("MIT"), rust.0, rust.1)]) {
        // The most frequent text of a kind is its usual one.
        let usual = entries.iter_mut().find(|entry| entry.kind == kind).unwrap();
        usual.packages.entry(name).or_default().insert(copyright);
    }
    entries
}

/// Returns the entries as one text.
pub(super) fn write(entries: &[Entry]) -> String {
    let mut all = "Licence texts of the libraries in Afterimage\n\nEach text is followed by the libraries that it applies to and \
        their holders of rights.\nMade by `UPDATE_LICENCES=1 cargo test -p afterimage-ui licences`.\n"
        .to_owned();
    for entry in entries {
        all +=
            &format!("\n{}\n{}\n\n{}\n\nThis applies to:\n", "=".repeat(80), KINDS[entry.kind].0, entry.text);
        for (package, copyright) in &entry.packages {
            all += &format!("- {package}\n");
            copyright.iter().for_each(|line| all += &format!("    {line}\n"));
        }
    }
    all
}

/// Returns the packages that no text applies to.
pub(super) fn missing(entries: &[Entry], packages: &[Package]) -> Vec<String> {
    let name = |p: &Package| format!("{} {}", p.name, p.version);
    packages.iter().map(name).filter(|name| !entries.iter().any(|e| e.packages.contains_key(name))).collect()
}

#[test]
fn texts_that_differ_in_breaks_and_holders_are_one() {
    let [a, b] = ["Copyright (c) 2020 A\n\nPermission is hereby granted, free of charge, to any person obtaining a copy\nof this software",
        "MIT License\n\nCopyright 2021 B\nPermission is hereby granted, free of charge, to any\nperson obtaining a copy of this software."]
        .map(split);
    assert_eq!(
        (a.0.first().unwrap().as_str(), b.0.first().unwrap().as_str()),
        ("Copyright (c) 2020 A", "Copyright 2021 B")
    );
    assert_eq!(kind_of(&a.1), 3);
    assert_eq!(key(3, &a.1), key(3, &b.1));
    for term in ["copyright statement(s).", "Copyright Holder(s) and", "   Copyright [yyyy] [name of owner]"]
    {
        assert!(!is_copyright(term), "{term}");
    }
}
