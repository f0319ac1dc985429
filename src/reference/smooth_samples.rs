//! Samples of smooth light, before they are filtered.

use crate::trace::ArrivingLight;
use glam::Vec3;

/// Samples of the smooth light of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SmoothSamples {
    /// Sums of the samples with even and with odd numbers, as radiance of a white surface.
    pub(crate) sums: [Vec3; 2],
    /// Number of samples of both together.
    pub(crate) count: u32,
}

impl SmoothSamples {
    /// Adds the samples that follow.
    pub(crate) fn add(&mut self, light: &ArrivingLight) {
        for (sum, more) in self.sums.iter_mut().zip(light.smooth_sums) {
            *sum += more;
        }
        self.count += light.paths;
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.sums.iter().all(|sum| sum.is_finite())
    }
}

impl From<&ArrivingLight> for SmoothSamples {
    fn from(light: &ArrivingLight) -> Self {
        Self { sums: light.smooth_sums, count: light.paths }
    }
}
