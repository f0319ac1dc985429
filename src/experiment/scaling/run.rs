//! The axes along which frame time is measured, and the measurement of one value in every mode.

use crate::camera::Camera;
use crate::experiment::measure::{References, Trial};
use crate::experiment::run::{
    Cell, CellOutcome, Effort, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};
use crate::render::{Mode, Renderer};
use crate::scene::builtin::statue_hall;
use crate::trace::{BounceLimit, TraceSettings, Tracer};
use std::sync::Arc;

pub(super) const MODES: [Mode; 4] = [Mode::Full, Mode::Paper, Mode::Exact, Mode::Fast];

/// Names of the axes and their values; the quick effort leaves out the last value.
pub(super) const AXES: [(&str, &[u32]); 5] = [
    ("triangles", &[100_000, 316_000, 1_000_000, 3_160_000, 10_000_000]),
    ("pixels", &[160 * 90, 320 * 180, 640 * 360, 1280 * 720]),
    ("references", &[1, 2, 4, 8]),
    ("lights", &[1, 2, 4, 8, 16]),
    ("samples", &[1, 4, 16, 64]),
];

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    let (size, repetitions, samples) = match effort {
        Effort::Quick => ([160, 90], 3, 4),
        Effort::Usual => ([640, 360], 5, 8),
    };
    // Lights and their shadow rays are what is scaled.
    let usual = ExperimentSettings { effort, bounces: BounceLimit::NONE, ..ExperimentSettings::default() };
    ExperimentSettings { size, repetitions, samples, views: 1, ..usual }
}

pub(crate) fn cells(context: &ExperimentContext<'_>) -> Vec<Cell> {
    let threads: Vec<u32> = (1..=rayon::current_num_threads() as u32).collect();
    let is_quick = context.settings.effort == Effort::Quick;
    let mut cells = Vec::new();
    for (axis, values) in AXES {
        let values = if is_quick { &values[..values.len() - 1] } else { values };
        cells.extend(values.iter().map(|value| cell(axis, *value)));
    }
    cells.extend(threads.into_iter().filter(|n| n.is_power_of_two()).map(|value| cell("threads", value)));
    cells
}

fn cell(axis: &str, value: u32) -> Cell {
    Cell(RunRecord::default().with("axis", axis).with("value", value))
}

/// Number of references, unless it is varied.
const REFERENCES: u32 = 2;

/// Number of triangles and of lamps in the hall, unless it is varied.
const HALL: [u32; 2] = [100_000, 4];

/// Measures one value of an axis in every mode. The modes share references and scene.
pub(crate) fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let unknown = || ExperimentError::UnknownCell { experiment: "scaling", cell: cell.label() };
    let axis = cell.text("axis").ok_or_else(unknown)?;
    let value = cell.number("value").ok_or_else(unknown)? as u32;
    let trace = context.settings.trace();
    match axis {
        "triangles" => in_hall(context, value, HALL[1]),
        "lights" => in_hall(context, HALL[0], value),
        "threads" => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(value as usize).build().map_err(|e| {
                ExperimentError::Unsuitable(format!("cannot start a pool of {value} threads: {e}"))
            })?;
            pool.install(|| in_scene(context, REFERENCES, trace))
        }
        "references" => in_scene(context, value, trace),
        "samples" => in_scene(context, REFERENCES, TraceSettings { samples: value, ..trace }),
        _ => {
            // All sizes have the aspect ratio 16:9.
            let height = (f64::from(value) * 9.0 / 16.0).sqrt().round() as u32;
            let size = [value / height.max(1), height];
            let settings = ExperimentSettings { size, ..context.settings.clone() };
            in_scene(&ExperimentContext { settings: &settings, ..*context }, REFERENCES, trace)
        }
    }
}

/// Measures in the given scene, from the middle of its walk.
fn in_scene(context: &ExperimentContext<'_>, references: u32, trace: TraceSettings) -> CellOutcome {
    time(context, &context.camera_on_walk(0.5)?, references, &trace)
}

/// Measures in a generated hall of statues.
fn in_hall(context: &ExperimentContext<'_>, triangles: u32, lamps: u32) -> CellOutcome {
    let tracer = Arc::new(Tracer::new(Arc::new(statue_hall(triangles as usize, lamps)?)));
    let camera = *tracer.scene().start();
    time(&ExperimentContext { tracer: &tracer, ..*context }, &camera, REFERENCES, &context.settings.trace())
}

/// Renders one view in all modes. The modes alternate within a repetition, so that other load on
/// the machine affects all of them equally.
fn time(context: &ExperimentContext<'_>, target: &Camera, count: u32, trace: &TraceSettings) -> CellOutcome {
    let poses: Vec<Camera> = (0..count).map(|i| beside(context.tracer, target, i)).collect();
    let Some(references) = References::trace(context, &poses, trace) else { return Ok(None) };
    let mut records = Vec::new();
    let mut renderers = MODES.map(|_| Renderer::default());
    for repetition in 0..=context.settings.repetitions {
        for (mode, renderer) in MODES.into_iter().zip(&mut renderers) {
            let trial = Trial { mode, trace: *trace, camera: *target, references: &references };
            let Some(frame) = trial.render(context, renderer) else { return Ok(None) };
            let sum: f64 = frame.radiance.iter().map(|r| f64::from(r.element_sum())).sum();
            records.push(
                RunRecord::default()
                    .with("mode", mode.name())
                    .with("repetition", repetition)
                    .with("is_warm_up", repetition == 0)
                    .with("frame_secs", frame.stats.secs.frame)
                    .with("reference_secs", references.secs(mode))
                    .with("triangles", context.tracer.scene().triangles.len())
                    .with("build_secs", context.tracer.build_secs())
                    .with("mean_radiance", sum / frame.radiance.len().max(1) as f64)
                    .with_fields(&frame.stats.types.percentages()),
            );
        }
    }
    Ok(Some(records))
}

/// Returns the camera of a reference: a step to the right of the view, a step to the left, two
/// steps to the right, and so on, limited by the nearest surface.
fn beside(tracer: &Tracer, target: &Camera, number: u32) -> Camera {
    const STEP_M: f64 = 0.2;
    /// Maximum share of the free distance, so that no reference stands in or behind a surface.
    const MAX_SHARE: f64 = 0.6;
    let side = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
    let way = target.world_from_camera().x_axis * side;
    let reach = STEP_M * f64::from(number / 2 + 1);
    let hit = tracer.probe(target.eye, way, reach / MAX_SHARE);
    let free = hit.map_or(reach, |p| reach.min(MAX_SHARE * p.distance_m));
    Camera { eye: target.eye + way * free, ..*target }
}
