//! The view of Table 1 and its references.

use crate::camera::{Camera, CameraKey};
use crate::experiment::run::{ExperimentContext, ExperimentError};
use serde::Deserialize;

/// The view, and the references it reuses, best first.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Views {
    pub(super) target: Camera,
    pub(super) references: [Camera; 2],
}

/// Views chosen for `builtin:gallery-bench`; the file states how.
const CHOSEN: &str = include_str!("../../../assets/experiments/table1.toml");

#[derive(Deserialize)]
struct ViewFile {
    scene: String,
    fov_y_deg: f64,
    target: CameraKey,
    references: [CameraKey; 2],
}

/// Positions of another scene's references relative to the middle of its walk, as shares of the
/// walk.
const WALK_SHARES: [f64; 2] = [-0.02, 0.02];

/// Returns the views of the file for its scene, and for any other scene views around the middle of
/// its walk.
pub(super) fn views(context: &ExperimentContext<'_>) -> Result<Views, ExperimentError> {
    let file: ViewFile = toml::from_str(CHOSEN)
        .map_err(|e| ExperimentError::Unsuitable(format!("the views of table1 are invalid: {e}")))?;
    if file.scene == context.tracer.scene().name {
        let at = |key: &CameraKey| Camera::look_at(key.eye, key.at, file.fov_y_deg);
        return Ok(Views { target: at(&file.target), references: file.references.each_ref().map(at) });
    }
    let on_walk = |share: f64| context.camera_on_walk(0.5 + share);
    let [before, after] = WALK_SHARES.map(on_walk);
    Ok(Views { target: on_walk(0.0)?, references: [before?, after?] })
}
