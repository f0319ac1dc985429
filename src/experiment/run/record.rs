//! What a cell leaves behind, as flat as a line of a table.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// One line: names with their units (`frame_secs`, `psnr_db`) and values, in the order they were set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct RunRecord(pub Map<String, Value>);

/// Names that hold one of these depend on the clock; all others are the same to the bit in every run of one seed.
const OF_THE_CLOCK: [&str; 6] = ["_secs", "speedup", "per_sec", "_ns", "_us", "_over_memory_floor"];

impl RunRecord {
    /// The same with one more value, or another one of that name.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.set(name, value);
        self
    }

    /// Sets a value.
    pub fn set(&mut self, name: &str, value: impl Into<Value>) {
        self.0.insert(name.to_owned(), value.into());
    }

    /// The same with every field of a structure; a structure in it gives its fields `group.field`.
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

    /// A number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.0.get(name)?.as_f64()
    }

    /// A text.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.0.get(name)?.as_str()
    }

    /// True where a flag of that name is set.
    pub fn is(&self, name: &str) -> bool {
        self.0.get(name).and_then(Value::as_bool) == Some(true)
    }

    /// True where the record has all these values.
    pub fn agrees_with(&self, wanted: &RunRecord) -> bool {
        wanted.0.iter().all(|(name, value)| self.0.get(name) == Some(value))
    }

    /// What is the same in every run of one seed.
    #[must_use]
    pub fn without_times(&self) -> Self {
        let is_timeless = |name: &str| !OF_THE_CLOCK.iter().any(|part| name.contains(part));
        Self(
            self.0
                .iter()
                .filter(|(name, _)| is_timeless(name))
                .map(|(n, v)| (n.clone(), v.clone()))
                .collect(),
        )
    }

    /// `mode paper, samples 16`.
    pub fn label(&self) -> String {
        let word = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let pairs: Vec<String> =
            self.0.iter().map(|(name, value)| format!("{name} {}", word(value))).collect();
        pairs.join(", ")
    }
}

/// The records of the frames that count: those of warm-ups are kept, marked, and left out of every sum.
pub fn counted(records: &[RunRecord]) -> impl Iterator<Item = &RunRecord> + Clone {
    records.iter().filter(|r| !r.is("is_warm_up"))
}
