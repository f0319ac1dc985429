//! The commands of the README, run one after the other as a reader would, on a small room and with
//! little work.

use super::{Bench, shell, stderr};
use std::path::Path;

/// Values that make a command short: flag, value, and the commands that need it if it is not given.
const SHORT: [(&str, &str, &[&str]); 6] = [
    ("--size", "32x24", &PICTURES),
    ("--samples", "1", &PICTURES),
    ("--bounces", "0", &["tour", "bake"]),
    ("--frames", "3", &["tour"]),
    ("--truth-samples", "2", &["tour"]),
    ("--seconds", "0.2", &[]),
];

/// Commands that take a size of pictures.
const PICTURES: [&str; 3] = ["render", "tour", "bake"];

/// Commands of many seconds, which tests of their own run.
const LONG: [&str; 2] = ["experiment stability", "experiment throughput"];

/// Shortens a command of the README; `None` for those that are left out.
fn short(words: &[String]) -> Option<Vec<String>> {
    let command = words.first()?;
    let line = words.join(" ").replace("path/to/house", "house").replace("light/", "light");
    if LONG.iter().any(|long| line.starts_with(long)) || command.contains('.') || command.contains(':') {
        return None;
    }
    // The gallery takes seconds to load; one command shows its views.
    let line =
        if line.contains("--view") { line } else { line.replace("builtin:gallery", "builtin:cornell") };
    let mut words: Vec<String> = line.split(' ').map(str::to_owned).collect();
    for (flag, value, needed_by) in SHORT {
        match words.iter().position(|word| word == flag) {
            // Of a small room, all is baked before the time is over.
            Some(_) if command == "bake" && flag == "--seconds" => {}
            Some(at) => words[at + 1] = value.to_owned(),
            None if needed_by.contains(&command.as_str()) => words.extend([flag, value].map(str::to_owned)),
            None => {}
        }
    }
    if line.contains("equirectangular") {
        // Twice as wide as high.
        words.iter_mut().filter(|word| *word == "32x24").for_each(|size| "32x16".clone_into(size));
    }
    Some(words)
}

#[test]
fn every_command_of_the_readme_runs() {
    let bench = Bench::new();
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../README.md")).unwrap();
    std::fs::copy(bench.path("room.obj"), bench.path("house.obj")).unwrap();
    for name in ["a.png", "b.png"] {
        assert!(bench.run(&format!("render room.obj --size 8x6 --samples 1 -o {name}")).status.success());
    }
    let commands: Vec<Vec<String>> = shell::commands(&page).iter().filter_map(|words| short(words)).collect();
    assert!(commands.len() >= 11, "{commands:?}");
    for line in commands.iter().map(|words| words.join(" ")) {
        let output = bench.run(&line);
        assert!(output.status.success(), "{line}: {}", stderr(&output));
    }
}
