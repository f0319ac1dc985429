//! Renders one cell of Table 1.

use super::plan::mode_and_references;
use super::views::{Views, views};
use crate::experiment::measure::{References, Trial, truth_of};
use crate::experiment::run::{CellOutcome, ExperimentContext, ExperimentError, RunRecord};
use crate::raster::color::ToneMap;
use crate::raster::load::exposed;
use crate::raster::metrics::{error_picture, flip_map};
use crate::render::aov::{display_picture, types_picture};
use crate::render::{Frame, Mode, Renderer};
use glam::Vec3;

pub(crate) fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let (mode, count) = mode_and_references(cell)?;
    let views = views(context)?;
    let Some(references) = References::trace(context, &views.references[..count], &context.settings.trace())
    else {
        return Ok(None);
    };
    let Some(truth) = truth_of(context, &views.target) else { return Ok(None) };
    let trial =
        Trial { mode, trace: context.settings.trace(), camera: views.target, references: &references };
    let mut renderer = Renderer::default();
    let records = trial.measure(context, &truth, &mut renderer)?;
    if records.is_some() {
        save_pictures(context, &format!("{}-{count}", mode.name()), renderer.frame(), &truth)?;
        if mode == Mode::Full {
            save_references(context, &views, context.exposure_ev(&truth))?;
        }
    }
    Ok(records)
}

/// The picture, its types, and its error.
fn save_pictures(
    context: &ExperimentContext<'_>,
    name: &str,
    frame: &Frame,
    truth: &[Vec3],
) -> Result<(), ExperimentError> {
    let size = frame.view.size;
    let exposure_ev = context.exposure_ev(truth);
    let [shown, right] = [&frame.radiance[..], truth].map(|r| exposed(r, exposure_ev));
    let errors = error_picture(&flip_map(&shown, &right, size)?);
    context.save_picture(
        &format!("{name}.png"),
        size,
        &display_picture(frame, exposure_ev, ToneMap::Aces),
    )?;
    context.save_picture(&format!("{name}-types.png"), size, &types_picture(frame))?;
    context.save_picture(&format!("{name}-error.png"), size, &errors)
}

/// Figure 2: what stands in the references, mirrors and glass included.
fn save_references(
    context: &ExperimentContext<'_>,
    views: &Views,
    exposure_ev: f32,
) -> Result<(), ExperimentError> {
    for (number, pose) in (1..).zip(&views.references) {
        let none = References::none(context);
        let trial =
            Trial { mode: Mode::Full, trace: context.settings.trace(), camera: *pose, references: &none };
        let mut renderer = Renderer::default();
        if let Some(frame) = trial.render(context, &mut renderer) {
            let picture = display_picture(frame, exposure_ev, ToneMap::Aces);
            context.save_picture(&format!("reference-{number}.png"), frame.view.size, &picture)?;
        }
    }
    Ok(())
}
