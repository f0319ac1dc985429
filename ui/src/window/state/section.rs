//! The section of the model that the window shows.

use afterimage::trace::section::CutPlane;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A plane that cuts the model open for the camera, and whether it does so now.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SectionView {
    /// False while the plane is only remembered.
    pub is_on: bool,
    /// The plane, world metres.
    #[serde(flatten)]
    pub plane: CutPlane,
}

impl SectionView {
    /// The section that a scene begins with: through the middle of the building, across the axis
    /// that the camera looks along most, without the side of the camera.
    pub fn new([low, high]: [DVec3; 2], eye: DVec3, forward: DVec3) -> Self {
        let along = forward.abs();
        let axis = (0..3).fold(0, |best, axis| if along[axis] > along[best] { axis } else { best });
        let plane = CutPlane::away_from(axis, (low[axis] + high[axis]) / 2.0, eye);
        Self { is_on: true, plane }
    }

    /// True where a section that was read from a file is possible.
    pub fn is_valid(&self) -> bool {
        self.plane.axis < 3 && self.plane.at_m.is_finite()
    }
}
