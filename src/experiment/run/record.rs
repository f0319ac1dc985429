//! Flat records: one line of a table each.

use crate::experiment::statistics::median;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// One line of a table: names with their units (`frame_secs`, `psnr_db`) and values, in insertion
/// order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct RunRecord(pub Map<String, Value>);

/// A field whose name contains one of these depends on the clock. All other fields have the same
/// bits in every run with the same seed.
const TIMED_NAMES: [&str; 6] = ["_secs", "speedup", "per_sec", "_ns", "_us", "_over_memory_floor"];

impl RunRecord {
    /// Returns the record with one more value, or with a value replaced.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.set(name, value);
        self
    }

    /// Sets a value.
    pub fn set(&mut self, name: &str, value: impl Into<Value>) {
        self.0.insert(name.to_owned(), value.into());
    }

    /// Returns the record with every field of a structure. The fields of a nested structure are
    /// named `group.field`.
    #[must_use]
    pub fn with_fields(mut self, fields: &impl Serialize) -> Self {
        self.add("", serde_json::to_value(fields).unwrap_or(Value::Null));
        self
    }

    fn add(&mut self, name: &str, value: Value) {
        let Value::Object(fields) = value else {
            self.set(name, value);
            return;
        };
        for (field, value) in fields {
            let name = if name.is_empty() { field } else { format!("{name}.{field}") };
            self.add(&name, value);
        }
    }

    /// Returns the value of a field if it is a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.0.get(name)?.as_f64()
    }

    /// Returns the value of a field if it is text.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.0.get(name)?.as_str()
    }

    /// Returns true if a field is `true`.
    pub fn is(&self, name: &str) -> bool {
        self.0.get(name).and_then(Value::as_bool) == Some(true)
    }

    /// Returns true if the record has all values of `wanted`.
    pub fn agrees_with(&self, wanted: &RunRecord) -> bool {
        wanted.0.iter().all(|(name, value)| self.0.get(name) == Some(value))
    }

    /// Returns the fields that are equal in every run with the same seed.
    #[must_use]
    pub fn without_times(&self) -> Self {
        let is_timeless = |name: &str| !TIMED_NAMES.iter().any(|part| name.contains(part));
        let fields = self.0.iter().filter(|(name, _)| is_timeless(name));
        Self(fields.map(|(name, value)| (name.clone(), value.clone())).collect())
    }

    /// Returns the record as text, such as `mode paper, samples 16`.
    pub fn label(&self) -> String {
        let word = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let pairs: Vec<String> =
            self.0.iter().map(|(name, value)| format!("{name} {}", word(value))).collect();
        pairs.join(", ")
    }
}

/// Returns the records that count: warm-ups are stored and marked, but left out of all figures.
pub fn counted(records: &[RunRecord]) -> impl Iterator<Item = &RunRecord> + Clone {
    records.iter().filter(|r| !r.is("is_warm_up"))
}

/// Returns the records that count and have all values of `wanted`.
pub fn matching<'a>(records: &'a [RunRecord], wanted: &RunRecord) -> Vec<&'a RunRecord> {
    counted(records).filter(|r| r.agrees_with(wanted)).collect()
}

/// Returns the median of a field; `None` if no record has it.
pub fn median_of(records: &[&RunRecord], name: &str) -> Option<f64> {
    median(records.iter().filter_map(|r| r.number(name)))
}
