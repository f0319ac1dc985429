//! Records as comma-separated values.

use serde::Serialize;
use serde_json::Value;

/// A table with a column per number, named by its place in the record (`types.type1_percent`), a line per record.
/// A record lacks a column where its value is absent.
pub fn csv<T: Serialize>(records: &[T]) -> String {
    let rows: Vec<Vec<(String, String)>> = records
        .iter()
        .map(|record| {
            let mut cells = Vec::new();
            flatten(String::new(), &serde_json::to_value(record).unwrap_or(Value::Null), &mut cells);
            cells
        })
        .collect();
    let mut columns: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !columns.contains(&name.as_str()) {
            columns.push(name);
        }
    }
    // Absent in a record, a group would otherwise leave a column of its own name.
    columns.retain(|c| !columns_start_with(&rows, c));
    let cell = |row: &[(String, String)], column: &str| {
        row.iter().find(|(name, _)| name == column).map_or(String::new(), |(_, value)| value.clone())
    };
    let line =
        |row: &Vec<(String, String)>| columns.iter().map(|c| cell(row, c)).collect::<Vec<_>>().join(",");
    std::iter::once(columns.join(",")).chain(rows.iter().map(line)).map(|l| l + "\n").collect()
}

fn columns_start_with(rows: &[Vec<(String, String)>], group: &str) -> bool {
    let is_member = |name: &str| name.strip_prefix(group).is_some_and(|rest| rest.starts_with('.'));
    rows.iter().flatten().any(|(name, _)| is_member(name))
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
        // Text may hold a comma or a quote.
        Value::String(text) => cells.push((name, format!("\"{}\"", text.replace('"', "\"\"")))),
        other => cells.push((name, other.to_string())),
    }
}
