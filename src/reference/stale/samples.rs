//! Samples of how much the light at a place differs between two states of a scene.

use crate::math::key::Key;
use crate::trace::SurfacePoint;
use glam::Vec3;

/// How much the light at a point may differ: the largest channel, as radiance of a white surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Doubt {
    /// Difference of the light straight from the lights.
    pub(super) direct: f32,
    /// Difference of the smooth light.
    pub(super) smooth: f32,
}

/// Samples of the doubt at a place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DoubtSamples {
    pub(super) count: f32,
    /// The largest mean of the difference of direct light, of single points.
    pub(super) direct: f32,
    /// Sum of the differences of smooth light.
    pub(super) sum: Vec3,
    /// Sum of their squares.
    pub(super) squares: Vec3,
}

/// The difference between two states of a scene, as it can be sampled at points.
pub(super) trait Difference: Sync {
    /// Samples at each of a place's points, at least and at most.
    const SAMPLES: [u32; 2];

    /// Samples at one point of every place together, while each has the least number or more.
    const MAX_SAMPLES: u32;

    /// Samples how much the light at a point may differ.
    fn at(&self, point: &SurfacePoint, samples: u32, key: Key) -> DoubtSamples;

    /// The doubt about a place, by its own samples and by all samples around it.
    fn doubt(own: &DoubtSamples, around: &DoubtSamples) -> Doubt;
}

impl DoubtSamples {
    /// All samples of both.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            direct: self.direct.max(other.direct),
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
        }
    }

    /// Adds a sample of smooth light.
    pub(super) fn add(&mut self, smooth: Vec3) {
        self.count += 1.0;
        self.sum += smooth;
        self.squares += smooth * smooth;
    }

    /// The means, and a number of their standard errors on top, where they are not below zero.
    pub(super) fn mean_plus(&self, errors: f32) -> Doubt {
        let count = self.count.max(1.0);
        let mean = self.sum / count;
        let variance = (self.squares / count - mean * mean).max(Vec3::ZERO) / count;
        let smooth = mean.abs() + errors * Vec3::from(variance.to_array().map(f32::sqrt));
        Doubt { direct: self.direct, smooth: smooth.max_element().max(0.0) }
    }
}
