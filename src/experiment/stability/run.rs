//! The list of all cases, and the measurement of one.

use super::case::{Case, Trial};
use super::{
    artefacts, cache, camera, geometry, lamps, light, materials, relief, rough, scale, stored, theorems,
};
use crate::experiment::run::{
    Cell, CellOutcome, Effort, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};
use crate::trace::BounceLimit;

/// Every case, in the order of the catalogue.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    let groups: [&[Case]; 12] = [
        scale::CASES,
        camera::CASES,
        geometry::CASES,
        materials::CASES,
        rough::CASES,
        relief::CASES,
        cache::CASES,
        theorems::CASES,
        artefacts::CASES,
        light::CASES,
        lamps::CASES,
        stored::CASES,
    ];
    groups.into_iter().flatten()
}

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    // The cases state their own bounces where their theorem is about more than direct light.
    let usual = ExperimentSettings { effort, bounces: BounceLimit::NONE, ..ExperimentSettings::default() };
    ExperimentSettings { size: [96, 64], samples: 2, repetitions: 1, ..usual }
}

pub(crate) fn cells(_: &ExperimentContext<'_>) -> Vec<Cell> {
    cases().map(|case| Cell(RunRecord::default().with("case", case.name))).collect()
}

pub(crate) fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let name = cell.text("case").unwrap_or_default();
    let unknown = || ExperimentError::UnknownCell { experiment: "stability", cell: cell.label() };
    let case = cases().find(|case| case.name == name).ok_or_else(unknown)?;
    let found = case.run(match context.settings.effort {
        Effort::Quick => &Trial::QUICK,
        Effort::Usual => &Trial::FULL,
    })?;
    let mut record = RunRecord::default().with(measured_name(case), found.value).with("note", found.note);
    if let Some((size, srgb)) = found.picture {
        let file = format!("{}.png", name.replace(|c: char| !c.is_ascii_alphanumeric(), "-"));
        context.save_picture(&file, size, &srgb)?;
        record.set("picture", file);
    }
    Ok(Some(vec![record]))
}

/// Name of the value in records; it shows whether the value depends on the clock.
pub(super) fn measured_name(case: &Case) -> &'static str {
    if case.is_timed { "measured_secs_ratio" } else { "measured" }
}
