//! The difference between the smooth light of a tilted normal and that of the normal without its
//! normal map.

use super::bounces::SmoothSettings;
use super::dimension::DIRECTION;
use crate::bsdf::Diffuse;
use crate::math::sequence::Sequence;
use crate::trace::{RayCounts, SurfacePoint, Tracer};
use glam::Vec3;

impl Tracer {
    /// Returns the smooth light that arrives for the tilted normal of a point, less that for its
    /// plain one, each as the radiance of a white surface, by some samples of a sequence.
    ///
    /// Every other direction is taken about the one normal, the rest about the other, and counts by
    /// the difference of its cosines over their mean: at most twice its light, and as little as the
    /// tilt is small.
    pub(crate) fn smooth_light_of_tilt(
        &self,
        point: &SurfacePoint,
        samples: u32,
        sequence: Sequence,
        settings: SmoothSettings<'_>,
        rays: &mut RayCounts,
    ) -> Vec3 {
        let plain = point.as_stored();
        let facings = [&plain, point].map(|point| point.facing(self.scene()));
        // An even number: a half about each normal.
        let samples = samples.next_multiple_of(2);
        let mut sum = Vec3::ZERO;
        for sample in 0..samples {
            let facing = &facings[(sample & 1) as usize];
            let random = sequence.pair(sample / 2, DIRECTION);
            let Some(direction) = Diffuse::sample_direction(facing, random) else { continue };
            let cosine = |normal: Vec3| normal.dot(direction).max(0.0);
            let [before, after] = [cosine(plain.shading_normal), cosine(point.shading_normal)];
            let weight = 2.0 * (after - before) / (after + before).max(f32::MIN_POSITIVE);
            sum +=
                weight * self.smooth_light_along((point, direction), (sequence, sample / 2), settings, rays);
        }
        sum / samples as f32
    }
}
