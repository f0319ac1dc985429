//! The paper's Table 1, row by row, from our scenes, and its figures 2 to 4.
//!
//! Source: the paper, section 4. We differ: wall time of all threads instead of one processor's; 16 shadow rays per
//! light; the look-up modes `fast` and `exact` stand beside.

mod report;
mod views;

use crate::camera::Camera;
use crate::experiment::run::{
    Cell, CellOutcome, Effort, Experiment, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};
use crate::experiment::trial::{References, Trial, truth_of};
use crate::raster::color::ToneMap;
use crate::raster::load::exposed;
use crate::raster::metrics::{error_picture, flip_map};
use crate::render::aov::{display_picture, types_picture};
use crate::render::{Frame, Mode, Renderer};
use glam::Vec3;
use views::{Views, views};

/// See the module.
pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "table1",
    about: "the paper's Table 1 and figures 2 to 4",
    settings,
    cells,
    run_cell,
    report: report::report,
};

/// The paper's: no reference, or one, or two.
const CELLS: [(Mode, usize); 7] = [
    (Mode::Full, 0),
    (Mode::Paper, 1),
    (Mode::Paper, 2),
    (Mode::Fast, 1),
    (Mode::Fast, 2),
    (Mode::Exact, 1),
    (Mode::Exact, 2),
];

fn settings(effort: Effort) -> ExperimentSettings {
    let (size, repetitions, truth_samples) = match effort {
        Effort::Quick => ([128, 128], 1, 128),
        Effort::Usual => ([256, 256], 5, 4096),
    };
    ExperimentSettings { effort, size, repetitions, truth_samples, views: 1, ..ExperimentSettings::default() }
}

fn cells(_: &ExperimentContext<'_>) -> Vec<Cell> {
    let cell = |(mode, references): (Mode, usize)| {
        Cell(RunRecord::default().with("mode", mode.name()).with("references", references))
    };
    CELLS.into_iter().map(cell).collect()
}

fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
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

fn mode_and_references(cell: &RunRecord) -> Result<(Mode, usize), ExperimentError> {
    let find = |&(mode, count): &(Mode, usize)| {
        cell.text("mode") == Some(mode.name()) && cell.number("references") == Some(count as f64)
    };
    let unknown = || ExperimentError::Unsuitable(format!("table1 has no cell '{}'", cell.label()));
    CELLS.into_iter().find(find).ok_or_else(unknown)
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

/// A camera of the view file.
fn camera(key: &crate::camera::CameraKey, fov_y_deg: f64) -> Camera {
    Camera::look_at(key.eye, key.at, fov_y_deg)
}
