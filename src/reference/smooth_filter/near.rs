//! Smooth light of a reference's pixel at a place that another frame of the same view shows there.

use super::walls::LIFT;
use crate::reference::ReferenceFrame;
use crate::trace::{NO_TRIANGLE, SurfacePoint, Tracer};
use glam::Vec3;

/// Distance to the point at most, relative to that of neighbouring pixels on a surface that faces
/// the viewer. No other value was tried.
const REACH: f32 = 4.0;

impl ReferenceFrame {
    /// Smooth light of a pixel, as the radiance of a white diffuse surface, where it holds for a
    /// point that the pixel shows in another frame of this view: the pixel's surface is no farther
    /// from it than a few pixels, and faces a similar way.
    pub(crate) fn smooth_light_near(
        &self,
        tracer: &Tracer,
        pixel: u32,
        point: &SurfacePoint,
    ) -> Option<Vec3> {
        let triangle = self.triangle()[pixel as usize];
        if !self.has_light(pixel) || triangle == NO_TRIANGLE {
            return None;
        }
        let (smooth, scale) = self.packed_smooth();
        let word = *smooth.get(pixel as usize)?;
        let offset = self.offset_from_eye(pixel);
        let own = SurfacePoint::from_position(tracer.scene(), triangle, self.view.eye + offset, offset);
        let most = REACH * self.view.scene_from_pixel.x_axis.length() * offset.length();
        let is_near = own.position.distance(point.position) <= most;
        let faces_alike = own.plain_normal.dot(point.plain_normal) > 0.0;
        let [a, b] = [&own, point].map(|p| (p.position, p.plain_normal));
        (is_near && faces_alike && tracer.see_each_other(a, b, LIFT)).then(|| scale.unpack(word))
    }
}
