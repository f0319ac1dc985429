//! The cells of Table 1, and the rendering of one.

use super::views::views;
use crate::camera::Camera;
use crate::experiment::measure::{FramePictures, References, Trial, truth_of};
use crate::experiment::run::{
    Cell, CellOutcome, Effort, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};
use crate::raster::color::ToneMap;
use crate::render::{Mode, Renderer, aov::display_rows};
use crate::trace::BounceLimit;

/// Mode and number of references of each cell. The paper has none, one and two.
pub(super) const CELLS: [(Mode, usize); 7] = [
    (Mode::Full, 0),
    (Mode::Paper, 1),
    (Mode::Paper, 2),
    (Mode::Fast, 1),
    (Mode::Fast, 2),
    (Mode::Exact, 1),
    (Mode::Exact, 2),
];

/// The paper has direct light only, whatever the flags say.
pub(crate) const BOUNCES: BounceLimit = BounceLimit::NONE;

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    let (size, repetitions, truth_samples) = match effort {
        Effort::Quick => ([128, 128], 1, 128),
        Effort::Usual => ([256, 256], 5, 4096),
    };
    let usual = ExperimentSettings { effort, views: 1, ..ExperimentSettings::default() };
    ExperimentSettings { size, repetitions, truth_samples, bounces: BOUNCES, ..usual }
}

pub(crate) fn cells(_: &ExperimentContext<'_>) -> Vec<Cell> {
    let cell = |(mode, references): (Mode, usize)| {
        Cell(RunRecord::default().with("mode", mode.name()).with("references", references))
    };
    CELLS.into_iter().map(cell).collect()
}

/// Returns the mode and the number of references of a cell.
pub(super) fn mode_and_references(cell: &RunRecord) -> Result<(Mode, usize), ExperimentError> {
    let find = |&(mode, count): &(Mode, usize)| {
        cell.text("mode") == Some(mode.name()) && cell.number("references") == Some(count as f64)
    };
    CELLS
        .into_iter()
        .find(find)
        .ok_or_else(|| ExperimentError::UnknownCell { experiment: "table1", cell: cell.label() })
}

pub(crate) fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let (mode, count) = mode_and_references(cell)?;
    let (views, trace) = (views(context)?, context.settings.trace());
    let Some(references) = References::trace(context, &views.references[..count], &trace) else {
        return Ok(None);
    };
    let Some(truth) = truth_of(context, &views.target) else { return Ok(None) };
    let trial = Trial { mode, trace, camera: views.target, references: &references };
    let mut renderer = Renderer::default();
    let records = trial.measure(context, &truth, &mut renderer)?;
    if records.is_some() {
        let (name, exposure_ev) = (format!("{}-{count}", mode.name()), context.settings.exposure_ev);
        FramePictures::of(&name, renderer.frame(), &truth, exposure_ev)?.save(context)?;
        if mode == Mode::Full {
            save_references(context, &views.references, exposure_ev)?;
        }
    }
    Ok(records)
}

/// Figure 2: the references as pictures, mirrors and glass included.
fn save_references(
    context: &ExperimentContext<'_>,
    poses: &[Camera],
    exposure_ev: f32,
) -> Result<(), ExperimentError> {
    let references = References::none(context);
    for (number, &camera) in (1..).zip(poses) {
        let trial =
            Trial { mode: Mode::Full, trace: context.settings.trace(), camera, references: &references };
        let mut renderer = Renderer::default();
        if let Some(frame) = trial.render(context, &mut renderer) {
            let picture = display_rows(&frame.radiance, exposure_ev, ToneMap::Aces);
            context.save_picture(&format!("reference-{number}.png"), frame.view.size, &picture)?;
        }
    }
    Ok(())
}
