//! Samples of the light of a pixel while its reference is being refined.

use super::smooth_samples::SmoothSamples;
use crate::trace::ArrivingLight;
use glam::Vec3;

/// Sums over the samples of a pixel's light, in 32-bit numbers: a mean packed into nine bits stops
/// changing after some 500 samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SampleSums {
    /// Number of samples.
    pub(crate) samples: u32,
    /// Sum of the samples of light straight from the lights, as radiance of a white surface.
    direct: Vec3,
    /// Samples of smooth light; none without bounces, and at black surfaces.
    pub(crate) smooth: SmoothSamples,
}

impl SampleSums {
    /// Adds the light that the next `samples` samples have brought.
    pub(crate) fn add(&mut self, light: &ArrivingLight, samples: u32) {
        self.samples += samples;
        self.direct += light.direct() * samples as f32;
        self.smooth.add(light);
    }

    /// The mean of the light straight from the lights, as the radiance of a white surface.
    pub(crate) fn direct(&self) -> Vec3 {
        self.direct / self.samples.max(1) as f32
    }
}
