//! All output to the terminal: data to stdout, messages to stderr.
//!
//! Failed writes are ignored: a closed pipe (`| head`) is not an error of the command.

use serde_json::Value;
use std::io::Write;

/// Writes a line to stderr.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Writes a line to stdout.
pub(crate) fn data(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
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
