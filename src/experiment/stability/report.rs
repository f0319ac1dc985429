//! Which cases hold.

use super::case::Case;
use super::run::{cases, measured_name};
use crate::experiment::run::report::{Block, Picture, Section, fields};
use crate::experiment::run::{Identity, Report, RunRecord};
use serde_json::{Value, json};

/// A case with its record.
struct Row<'a> {
    case: &'static Case,
    record: &'a RunRecord,
}

impl<'a> Row<'a> {
    fn of(record: &'a RunRecord) -> Option<Self> {
        let case = cases().find(|case| record.text("case") == Some(case.name))?;
        Some(Self { case, record })
    }

    fn measured(&self) -> Option<f64> {
        self.record.number(measured_name(self.case))
    }

    fn is_ok(&self) -> bool {
        self.measured().is_some_and(|measured| self.case.holds(measured))
    }

    /// The note, and the known reason of a case that does not hold.
    fn remark(&self) -> String {
        let reason = if self.is_ok() { "" } else { self.case.known_limit };
        let texts = [self.record.text("note").unwrap_or_default(), reason];
        texts.into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join("; ")
    }

    fn json(&self) -> Value {
        json!({
            "name": self.case.name,
            "expected": self.case.expected,
            "measured": self.measured(),
            "bound": self.case.bound,
            "ok": self.is_ok(),
            "note": self.remark(),
        })
    }

    fn line(&self) -> Vec<Value> {
        let Case { name, expected, bound, .. } = *self.case;
        let holds = if self.is_ok() { "yes" } else { "NO" };
        vec![
            name.into(),
            expected.into(),
            self.measured().into(),
            bound.into(),
            holds.into(),
            self.remark().into(),
        ]
    }

    fn picture(&self) -> Option<Picture> {
        Some(Picture::new(self.record.text("picture")?, self.case.name))
    }
}

pub(crate) fn report(_: &Identity, records: &[RunRecord]) -> Report {
    let rows: Vec<Row<'_>> = records.iter().filter_map(Row::of).collect();
    let failing: Vec<&Row<'_>> = rows.iter().filter(|row| !row.is_ok()).collect();
    let mut headline = vec![format!("{} of {} cases hold.", rows.len() - failing.len(), rows.len())];
    headline.extend(failing.iter().map(|row| format!("Does not hold: {}: {}", row.case.name, row.remark())));
    let columns = ["case", "measure", "measured", "at most", "ok", "remark"];
    let table = Block::table("Cases", columns, rows.iter().map(Row::line));
    let pictures = Block::Pictures(rows.iter().filter_map(Row::picture).collect());
    let names: Vec<&str> = failing.iter().map(|row| row.case.name).collect();
    Report {
        headline,
        summary: fields(json!({
            "cases": rows.iter().map(Row::json).collect::<Value>(),
            "ok": failing.is_empty(),
        })),
        sections: vec![Section::new("Cases", vec![table]), Section::new("Pictures", vec![pictures])],
        failure: (!failing.is_empty()).then(|| format!("these cases do not hold: {}", names.join("; "))),
        ..Report::default()
    }
}
