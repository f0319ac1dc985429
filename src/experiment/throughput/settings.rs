//! Settings of experiment `throughput`; it has a single cell.

use crate::camera::Camera;
use crate::experiment::run::{Cell, Effort, ExperimentContext, ExperimentSettings, RunRecord};
use crate::trace::{BounceLimit, TraceSettings, Tracer};

/// View and settings that are timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThroughputSettings {
    /// Camera of the view.
    pub camera: Camera,
    /// Width and height of the view in pixels.
    pub size: [u32; 2],
    /// Samples, bounces and seed of shading and of shadow rays.
    pub trace: TraceSettings,
}

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    // The stages are those of direct light, which every frame has.
    let usual = ExperimentSettings { effort, bounces: BounceLimit::NONE, ..ExperimentSettings::default() };
    match effort {
        Effort::Quick => ExperimentSettings { size: [320, 180], samples: 4, ..usual },
        Effort::Usual => ExperimentSettings { size: [1280, 720], ..usual },
    }
}

pub(crate) fn cells(_: &ExperimentContext<'_>) -> Vec<Cell> {
    vec![Cell(RunRecord::default().with("part", "all"))]
}

/// Returns the camera moved forward by a hundredth of the scene's diagonal and turned by 3 degrees.
pub(super) fn moved(tracer: &Tracer, camera: &Camera) -> Camera {
    let [low, high] = tracer.scene().bounds_m;
    let step = camera.forward() * ((high - low).length() * 0.01);
    Camera { eye: camera.eye + step, yaw: camera.yaw + 3f64.to_radians(), ..*camera }
}
