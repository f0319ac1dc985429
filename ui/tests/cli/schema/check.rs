//! The part of JSON Schema that the schemas use. A word that is not known here is a failure.

use serde_json::Value;

/// Words that check nothing.
const NOTES: [&str; 4] = ["$schema", "title", "description", "$defs"];

/// Returns why a document does not fit a schema, with the place of each problem.
pub(super) fn problems(schema: &Value, document: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(schema, schema, document, "", &mut found);
    found
}

fn check(root: &Value, schema: &Value, value: &Value, at: &str, found: &mut Vec<String>) {
    for (word, rule) in schema.as_object().unwrap() {
        let is_right = match word.as_str() {
            word if NOTES.contains(&word) => true,
            "$ref" => {
                check(
                    root,
                    root.pointer(rule.as_str().unwrap().trim_start_matches('#')).unwrap(),
                    value,
                    at,
                    found,
                );
                true
            }
            "type" => is_of_type(rule.as_str().unwrap(), value),
            "enum" => rule.as_array().unwrap().contains(value),
            "const" => rule == value,
            "minimum" => value.as_f64().is_none_or(|n| n >= rule.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|n| n <= rule.as_f64().unwrap()),
            "minItems" => value.as_array().is_none_or(|a| a.len() as u64 >= rule.as_u64().unwrap()),
            "maxItems" => value.as_array().is_none_or(|a| a.len() as u64 <= rule.as_u64().unwrap()),
            "pattern" => value.as_str().is_none_or(|text| fits_pattern(rule.as_str().unwrap(), text)),
            "anyOf" => rule.as_array().unwrap().iter().any(|choice| {
                let mut inner = Vec::new();
                check(root, choice, value, at, &mut inner);
                inner.is_empty()
            }),
            "required" => value.as_object().is_none_or(|o| {
                rule.as_array().unwrap().iter().all(|key| o.contains_key(key.as_str().unwrap()))
            }),
            "items" => {
                for (i, item) in value.as_array().into_iter().flatten().enumerate() {
                    check(root, rule, item, &format!("{at}/{i}"), found);
                }
                true
            }
            "properties" | "additionalProperties" => continue,
            other => panic!("the word '{other}' of the schema is not checked"),
        };
        if !is_right {
            found.push(format!("{at}: {word} {rule}"));
        }
    }
    check_keys(root, schema, value, at, found);
}

fn check_keys(root: &Value, schema: &Value, value: &Value, at: &str, found: &mut Vec<String>) {
    for (key, inner) in value.as_object().into_iter().flatten() {
        let at = format!("{at}/{key}");
        match (&schema["properties"][key], &schema["additionalProperties"]) {
            (Value::Null, Value::Bool(false)) => found.push(format!("{at}: unknown")),
            (Value::Null, Value::Object(_)) => {
                check(root, &schema["additionalProperties"], inner, &at, found)
            }
            (Value::Null, _) => {}
            (known, _) => check(root, known, inner, &at, found),
        }
    }
}

fn is_of_type(name: &str, value: &Value) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("the type '{other}' is not checked"),
    }
}

/// The two patterns that the schemas have.
fn fits_pattern(pattern: &str, text: &str) -> bool {
    let is_number = |t: &str| !t.is_empty() && t.bytes().all(|b| b.is_ascii_digit());
    match pattern {
        "^[0-9]+$" => is_number(text),
        "^[0-9]+[xX][0-9]+$" => {
            text.split_once(['x', 'X']).is_some_and(|(width, height)| is_number(width) && is_number(height))
        }
        other => panic!("the pattern '{other}' is not checked"),
    }
}
