//! Measures one case.

use super::case::{Case, Trial};
use super::catalogue;
use crate::experiment::run::{
    Cell, CellOutcome, Effort, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    ExperimentSettings { effort, size: [96, 64], samples: 2, repetitions: 1, ..ExperimentSettings::default() }
}

pub(crate) fn cells(_: &ExperimentContext<'_>) -> Vec<Cell> {
    catalogue::cases().map(|case| Cell(RunRecord::default().with("case", case.name))).collect()
}

pub(crate) fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let name = cell.text("case").unwrap_or_default();
    let Some(case) = catalogue::cases().find(|case| case.name == name) else {
        return Err(ExperimentError::Unsuitable(format!("there is no case '{name}'")));
    };
    let trial = match context.settings.effort {
        Effort::Quick => Trial::QUICK,
        Effort::Usual => Trial::FULL,
    };
    let found = case.run(&trial)?;
    let mut record = RunRecord::default();
    record.set(measured_name(case), found.value);
    record.set("note", found.note);
    if let Some((size, srgb)) = found.picture {
        let file = format!("{}.png", name.replace(|c: char| !c.is_ascii_alphanumeric(), "-"));
        context.save_picture(&file, size, &srgb)?;
        record.set("picture", file);
    }
    Ok(Some(vec![record]))
}

/// Records say by their names what depends on the clock.
pub(super) fn measured_name(case: &Case) -> &'static str {
    if case.is_timed { "measured_secs_ratio" } else { "measured" }
}
