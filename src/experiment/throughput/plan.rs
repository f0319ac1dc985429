//! One view, one cell.

use crate::camera::Camera;
use crate::experiment::run::{Cell, Effort, ExperimentContext, ExperimentSettings, RunRecord};
use crate::trace::{TraceSettings, Tracer};

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThroughputSettings {
    /// The view.
    pub camera: Camera,
    /// Of the view.
    pub size: [u32; 2],
    /// Samples, bounces, seed of shading and of the shadow rays.
    pub trace: TraceSettings,
}

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    let usual = ExperimentSettings { effort, ..ExperimentSettings::default() };
    match effort {
        Effort::Quick => ExperimentSettings { size: [320, 180], samples: 4, ..usual },
        Effort::Usual => ExperimentSettings { size: [1280, 720], ..usual },
    }
}

pub(crate) fn cells(_: &ExperimentContext<'_>) -> Vec<Cell> {
    vec![Cell(RunRecord::default().with("part", "all"))]
}

/// The pose after a hundredth of the scene's diagonal forwards and a turn of 3 degrees.
pub(super) fn moved(tracer: &Tracer, camera: &Camera) -> Camera {
    let [low, high] = tracer.scene().bounds_m;
    let step = camera.forward() * ((high - low).length() * 0.01);
    Camera { eye: camera.eye + step, yaw: camera.yaw + 3f64.to_radians(), ..*camera }
}
