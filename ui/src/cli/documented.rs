//! The documentation names flags and commands that exist.

#[path = "../../tests/cli/shell.rs"]
mod shell;

use super::Cli;
use clap::{CommandFactory, FromArgMatches};
use std::path::Path;

/// Pages with command lines, and the least number that each has.
const PAGES: [(&str, usize); 3] = [("README.md", 15), ("docs/PROFILING.md", 5), ("docs/STORE.md", 8)];

/// Returns a word with numbers for the variables of the shell in it, which count or name a shard.
fn with_numbers(word: &str) -> String {
    let mut parts = word.split('$');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| {
        let end = part.find(|c: char| !c.is_ascii_uppercase() && c != '_').unwrap_or(part.len());
        let number = if part[..end].ends_with("_ID") { "0" } else { "4" };
        text + number + &part[end..]
    })
}

#[test]
fn every_command_of_the_documentation_is_understood() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (page, least) in PAGES {
        let commands = shell::commands(&std::fs::read_to_string(root.join(page)).expect(page));
        assert!(commands.len() >= least, "{page}: {commands:?}");
        for words in commands {
            let words = words.iter().map(|word| with_numbers(word));
            let line: Vec<String> = std::iter::once("afterimage".to_owned()).chain(words).collect();
            let parsed = Cli::command().try_get_matches_from(&line).and_then(|m| Cli::from_arg_matches(&m));
            assert!(parsed.is_ok(), "{page}: {}: {}", line.join(" "), parsed.unwrap_err());
        }
    }
}
