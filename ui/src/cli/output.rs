//! The one place that writes to the terminal: data to stdout, words for people to stderr.
//!
//! A reader that has gone (`| head`) is no error of ours, so a failed write is let be.

use serde_json::Value;
use std::io::Write;

/// A line for people.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// A line of data.
pub(crate) fn data(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
}

/// The result of a command: one JSON object, or a table for people.
pub(crate) fn result(as_json: bool, object: &Value, table: impl FnOnce() -> String) {
    if as_json { data(&object.to_string()) } else { data(table().trim_end()) }
}

/// `what` and its value, one pair a line, aligned.
pub(crate) fn table(rows: &[(&str, String)]) -> String {
    let width = rows.iter().map(|(what, _)| what.chars().count()).max().unwrap_or(0);
    rows.iter().map(|(what, value)| format!("{what:<width$}  {value}\n")).collect()
}
