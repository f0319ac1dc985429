//! Renders one cell of Table 1.

use super::plan::mode_and_references;
use super::views::views;
use crate::camera::Camera;
use crate::experiment::measure::{FramePictures, References, Trial, truth_of};
use crate::experiment::run::{CellOutcome, ExperimentContext, ExperimentError, RunRecord};
use crate::raster::color::ToneMap;
use crate::render::aov::display_rows;
use crate::render::{Mode, Renderer};

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
        let (name, exposure_ev) = (format!("{}-{count}", mode.name()), context.exposure_ev(&truth));
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
