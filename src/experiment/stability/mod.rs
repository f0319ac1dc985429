//! Stiff and extreme cases, each with what must hold, what was measured and the bound: scale, camera, geometry, materials,
//! cache, theorems of rays, and the known artefacts of warping.
//!
//! A case is data and a function that measures; a program decides, nobody's eye. A case that cannot hold says why.

mod artefacts;
mod bench;
mod cache;
mod camera;
mod geometry;
mod materials;
mod scale;
mod theorems;

use crate::experiment::run::report::{Block, Picture, Section, Table};
use crate::experiment::run::{
    Cell, CellOutcome, Effort, Experiment, ExperimentContext, ExperimentError, ExperimentSettings, Identity,
    Report, RunRecord,
};
use serde_json::{Map, Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// See the module.
pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "stability",
    about: "stiff and extreme cases: what must hold, measured",
    settings: |effort| ExperimentSettings {
        effort,
        size: [96, 64],
        samples: 2,
        repetitions: 1,
        ..ExperimentSettings::default()
    },
    cells,
    run_cell,
    report,
};

/// One thing that must hold.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Letter and number of the catalogue in `docs/ROBUSTNESS.md`, and a few words.
    pub name: &'static str,
    /// What must hold, with the unit of the measured number.
    pub expected: &'static str,
    /// What is measured may be this large.
    pub bound: f64,
    /// True where it depends on the clock: such a case is no test, and its number differs from run to run.
    pub is_timed: bool,
    /// Why it does not hold, for a case that is known not to.
    pub known_limit: &'static str,
    /// Measures it.
    measure: fn(&Trial) -> Result<Measured, ExperimentError>,
}

/// How much is tried.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Random rays, poses or angles.
    pub tries: u32,
    /// Frames, where one is made after the other.
    pub frames: u32,
}

impl Trial {
    /// Enough for a test.
    pub const QUICK: Self = Self { tries: 20_000, frames: 8 };
    /// What the figures of `docs/ROBUSTNESS.md` are made with.
    pub const FULL: Self = Self { tries: 1_000_000, frames: 100 };
}

/// What a case found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Held against the bound; NaN never holds.
    pub value: f64,
    /// More, in words.
    pub note: String,
    /// A picture that shows it: size, 8-bit sRGB.
    pub picture: Option<([u32; 2], Vec<[u8; 3]>)>,
}

impl From<f64> for Measured {
    fn from(value: f64) -> Self {
        Self { value, ..Self::default() }
    }
}

impl From<usize> for Measured {
    fn from(count: usize) -> Self {
        Self::from(count as f64)
    }
}

impl Case {
    /// A case of a name, what must hold, the bound, and how it is measured.
    const fn new(
        name: &'static str,
        expected: &'static str,
        bound: f64,
        measure: fn(&Trial) -> Result<Measured, ExperimentError>,
    ) -> Self {
        Self { name, expected, bound, is_timed: false, known_limit: "", measure }
    }

    /// The same, as one that depends on the clock.
    const fn timed(self) -> Self {
        Self { is_timed: true, ..self }
    }

    /// The same, as one that is known not to hold.
    const fn limited(self, known_limit: &'static str) -> Self {
        Self { known_limit, ..self }
    }

    /// Measures; a panic is a measurement too, one that never holds.
    ///
    /// # Errors
    /// [`ExperimentError`] where a scene cannot be made or a file not be written.
    pub fn run(&self, trial: &Trial) -> Result<Measured, ExperimentError> {
        let panicked = || Measured { value: f64::NAN, note: "it panicked".to_owned(), picture: None };
        catch_unwind(AssertUnwindSafe(|| (self.measure)(trial))).unwrap_or_else(|_| Ok(panicked()))
    }

    /// True where a measured number is within the bound.
    pub fn holds(&self, measured: f64) -> bool {
        measured <= self.bound
    }
}

/// Every case, in the order of the catalogue.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    let groups: [&[Case]; 7] = [
        scale::CASES,
        camera::CASES,
        geometry::CASES,
        materials::CASES,
        cache::CASES,
        theorems::CASES,
        artefacts::CASES,
    ];
    groups.into_iter().flatten()
}

fn cells(_: &ExperimentContext<'_>) -> Vec<Cell> {
    cases().map(|case| Cell(RunRecord::default().with("case", case.name))).collect()
}

fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let name = cell.text("case").unwrap_or_default();
    let Some(case) = cases().find(|case| case.name == name) else {
        return Err(ExperimentError::Unsuitable(format!("there is no case '{name}'")));
    };
    let trial = match context.settings.effort {
        Effort::Quick => Trial::QUICK,
        Effort::Usual => Trial::FULL,
    };
    let found = case.run(&trial)?;
    let mut record = RunRecord::default();
    record.set(measured_name(case), finite(found.value));
    record.set("note", found.note);
    if let Some((size, srgb)) = found.picture {
        let file = format!("{}.png", name.replace(|c: char| !c.is_ascii_alphanumeric(), "-"));
        context.save_picture(&file, size, &srgb)?;
        record.set("picture", file);
    }
    Ok(Some(vec![record]))
}

/// Records say by their names what depends on the clock.
fn measured_name(case: &Case) -> &'static str {
    if case.is_timed { "measured_secs_ratio" } else { "measured" }
}

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

fn report(_: &Identity, records: &[RunRecord]) -> Report {
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
