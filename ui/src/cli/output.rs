//! All output to the terminal: data to stdout, messages to stderr.
//!
//! A closed pipe (`| head`) is not an error of the command. Data that cannot be written for another
//! reason, such as a full disk, makes the command fail when it ends.

use super::failure::Failure;
use serde_json::Value;
use std::io::{Error, ErrorKind, Write};
use std::sync::OnceLock;

/// Why data could not be written to stdout, if it could not.
static LOST: OnceLock<String> = OnceLock::new();

/// Writes a line to stderr.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Writes a line to stdout.
pub(crate) fn data(text: &str) {
    let mut out = std::io::stdout().lock();
    note(writeln!(out, "{text}").and_then(|()| out.flush()));
}

/// Notes the result of writing to stdout.
pub(crate) fn note(written: Result<(), Error>) {
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        let _ = LOST.set(error.to_string());
    }
}

/// Fails where data was lost because stdout could not be written.
pub(crate) fn check() -> Result<(), Failure> {
    match LOST.get() {
        Some(cause) => Err(Failure::Failed(format!(
            "the result cannot be written to stdout: {cause}; make room there, or send it elsewhere"
        ))),
        None => Ok(()),
    }
}

/// Writes the result of a command: as one JSON object, or as a table.
pub(crate) fn result(as_json: bool, object: &Value, table: impl FnOnce() -> String) {
    if as_json { data(&object.to_string()) } else { data(table().trim_end()) }
}

/// One aligned line for each name and value.
pub(crate) fn table(rows: &[(&str, String)]) -> String {
    let width = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    rows.iter().map(|(name, value)| format!("{name:<width$}  {value}\n")).collect()
}

/// Adds the fields of a serializable value to a JSON object.
pub(crate) fn extend(object: &mut Value, further: impl serde::Serialize) {
    let further = serde_json::to_value(further).unwrap_or(Value::Null);
    if let (Value::Object(object), Value::Object(further)) = (object, further) {
        object.extend(further);
    }
}
