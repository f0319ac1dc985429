//! The frame in which a rough lobe is computed.

use super::lobe::Facing;
use crate::math::sampling::frame_around;
use glam::{Mat3, Vec3};

/// A surface seen from a direction, with the normal as +Z.
pub(super) struct LocalFrame {
    axes: Mat3,
    /// Unit direction towards the viewer; its z is positive.
    pub(super) outgoing: Vec3,
}

/// Cosine (0..1) between the viewer's direction and the normal of the frame; 0 where there is none.
pub(super) fn cosine(facing: &Facing, incident: Vec3) -> f32 {
    LocalFrame::new(facing, incident).map_or(0.0, |frame| frame.outgoing.z.min(1.0))
}

impl LocalFrame {
    /// The frame about the shading normal, or about the triangle's normal where the shading normal
    /// would send the middle of the lobe into the surface, or faces away from the viewer. `None`
    /// where the surface is seen edge-on.
    pub(super) fn new(facing: &Facing, incident: Vec3) -> Option<Self> {
        let n = facing.shading_normal;
        let mirrored = incident - n * (2.0 * incident.dot(n));
        let is_usable = incident.dot(n) < 0.0 && mirrored.dot(facing.geometric_normal) > 0.0;
        let axes = frame_around(if is_usable { n } else { facing.geometric_normal });
        let outgoing = axes.transpose() * -incident;
        (outgoing.z > 0.0).then_some(Self { axes, outgoing })
    }

    /// A direction in this frame.
    pub(super) fn local(&self, direction: Vec3) -> Vec3 {
        self.axes.transpose() * direction
    }

    /// A unit direction in scene space.
    pub(super) fn scene(&self, local: Vec3) -> Vec3 {
        (self.axes * local).normalize_or(self.axes.z_axis)
    }

    /// Cosine to this frame's normal over that to the shading normal, for a scattered direction:
    /// values count by the latter. `None` where light cannot come from there.
    pub(super) fn cosine_ratio(&self, facing: &Facing, scattered: Vec3) -> Option<f32> {
        let [geometric, shading] =
            [facing.geometric_normal, facing.shading_normal].map(|normal| normal.dot(scattered));
        let along = self.axes.z_axis.dot(scattered);
        // All on one side of the surface.
        let is_lit = geometric * shading > 0.0 && geometric * along > 0.0;
        is_lit.then(|| if self.axes.z_axis == facing.shading_normal { 1.0 } else { along / shading })
    }
}
