//! Records as comma-separated values.

use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Returns a table with one line per record and one column per number, named by its path in the
/// record (`types.type1_percent`). The cell of an absent value is empty.
pub fn csv<T: Serialize>(records: &[T]) -> String {
    let mut columns: Vec<String> = Vec::new();
    let mut rows: Vec<BTreeMap<String, String>> = Vec::new();
    for record in records {
        let mut cells = Vec::new();
        flatten(String::new(), &serde_json::to_value(record).unwrap_or(Value::Null), &mut cells);
        for (name, _) in &cells {
            if !columns.contains(name) {
                columns.push(name.clone());
            }
        }
        rows.push(cells.into_iter().collect());
    }
    // A group that is absent in one record and present in another would leave a column of its own
    // name.
    let all = columns.clone();
    columns.retain(|group| !all.iter().any(|name| is_member(name, group)));
    let cell = |row: &BTreeMap<String, String>, column: &String| row.get(column).cloned().unwrap_or_default();
    let line = |row| columns.iter().map(|c| cell(row, c)).collect::<Vec<_>>().join(",");
    std::iter::once(columns.join(",")).chain(rows.iter().map(line)).map(|l| l + "\n").collect()
}

fn is_member(name: &str, group: &str) -> bool {
    name.strip_prefix(group).is_some_and(|rest| rest.starts_with('.'))
}

fn flatten(name: String, value: &Value, cells: &mut Vec<(String, String)>) {
    let below = |key: &str| if name.is_empty() { key.to_owned() } else { format!("{name}.{key}") };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| flatten(below(key), value, cells)),
        Value::Array(list) => {
            for (axis, value) in ["x", "y", "z"].iter().zip(list) {
                flatten(below(axis), value, cells);
            }
        }
        Value::Null => cells.push((name, String::new())),
        // Text may contain a comma or a quote.
        Value::String(text) => cells.push((name, format!("\"{}\"", text.replace('"', "\"\"")))),
        other => cells.push((name, other.to_string())),
    }
}
