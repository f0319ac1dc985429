//! Which cases hold.

use super::case::Case;
use super::catalogue::cases;
use super::run::measured_name;
use crate::experiment::run::report::{Block, Picture, Section, Table};
use crate::experiment::run::{Identity, Report, RunRecord};
use serde_json::{Map, Value, json};

/// JSON has no NaN.
fn finite(value: f64) -> Value {
    serde_json::Number::from_f64(value).map_or(Value::Null, Value::Number)
}

/// One case with its record.
struct Row {
    case: &'static Case,
    measured: Option<f64>,
    note: String,
    picture: Option<String>,
}

impl Row {
    fn of(record: &RunRecord) -> Option<Self> {
        let case = cases().find(|case| record.text("case") == Some(case.name))?;
        Some(Self {
            case,
            measured: record.number(measured_name(case)),
            note: record.text("note").unwrap_or_default().to_owned(),
            picture: record.text("picture").map(str::to_owned),
        })
    }

    fn is_ok(&self) -> bool {
        self.measured.is_some_and(|measured| self.case.holds(measured))
    }

    /// The note, and for a case that does not hold the reason where it is known.
    fn remark(&self) -> String {
        let reason = if self.is_ok() { "" } else { self.case.known_limit };
        [self.note.as_str(), reason]
            .into_iter()
            .filter(|text| !text.is_empty())
            .collect::<Vec<_>>()
            .join("; ")
    }

    fn json(&self) -> Value {
        json!({
            "name": self.case.name,
            "expected": self.case.expected,
            "measured": self.measured,
            "bound": self.case.bound,
            "ok": self.is_ok(),
            "note": self.remark(),
        })
    }

    fn line(&self) -> Vec<Value> {
        let word = if self.is_ok() { "yes" } else { "NO" };
        let [bound, measured] = [Some(self.case.bound), self.measured].map(|n| n.map_or(Value::Null, finite));
        vec![
            self.case.name.into(),
            self.case.expected.into(),
            measured,
            bound,
            word.into(),
            self.remark().into(),
        ]
    }
}

pub(crate) fn report(_: &Identity, records: &[RunRecord]) -> Report {
    let rows: Vec<Row> = records.iter().filter_map(Row::of).collect();
    let failing: Vec<&Row> = rows.iter().filter(|row| !row.is_ok()).collect();
    let mut summary = Map::new();
    summary.insert("cases".to_owned(), rows.iter().map(Row::json).collect());
    summary.insert("ok".to_owned(), failing.is_empty().into());
    let mut headline = vec![format!("{} of {} cases hold", rows.len() - failing.len(), rows.len())];
    headline.extend(failing.iter().map(|row| format!("does not hold: {}: {}", row.case.name, row.remark())));
    let columns = ["case", "must hold", "measured", "at most", "ok", "remark"].map(str::to_owned).to_vec();
    let table = Table { title: "Cases".to_owned(), columns, rows: rows.iter().map(Row::line).collect() };
    let pictures =
        rows.iter().filter_map(|row| Some(Picture::new(row.picture.clone()?, row.case.name))).collect();
    let section = |title: &str, block| Section { title: title.to_owned(), blocks: vec![block] };
    let names: Vec<&str> = failing.iter().map(|row| row.case.name).collect();
    Report {
        headline,
        notes: Vec::new(),
        summary,
        sections: vec![section("Cases", Block::Table(table)), section("Pictures", Block::Pictures(pictures))],
        failure: (!failing.is_empty()).then(|| format!("these cases do not hold: {}", names.join("; "))),
    }
}
