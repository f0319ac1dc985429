//! The settings that decide the noise of a picture, and the rays that they cost.

use super::bounce_limit::BounceLimit;
use std::ops::AddAssign;

/// How many rays a pixel takes, and the seed of its random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceSettings {
    /// Light samples per pixel: this many for each light that matters at a point, up to 64 lights,
    /// and this many paths for light that surfaces scatter. Where more lights matter, lamps share
    /// 16 shadow rays for each sample.
    pub samples: u32,
    /// Largest number of diffuse bounces of a path: 0 is direct light only, [`Self::ALL_BOUNCES`]
    /// as many as matter.
    pub bounces: u32,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl TraceSettings {
    /// Value of [`Self::bounces`] for as many bounces as matter.
    pub const ALL_BOUNCES: u32 = BounceLimit::ALL.0;

    /// The limit of bounces, as people write and read it.
    pub fn bounce_limit(&self) -> BounceLimit {
        BounceLimit(self.bounces)
    }

    /// Shadow rays per light for a surface that covers only a share (0..1) of the pixel; at least
    /// one.
    pub fn samples_for(&self, share: f32) -> u32 {
        ((self.samples as f32 * share).ceil() as u32).clamp(1, self.samples.max(1))
    }

    /// Noise of the light straight from lamps and sun, relative to sixteen shadow rays; at least 1.
    ///
    /// A threshold that separates signal from noise at that sample count is multiplied by this.
    pub(crate) fn noise(&self) -> f32 {
        self.relative_noise().max(1.0)
    }

    /// Noise of the light straight from lamps and sun, relative to sixteen shadow rays: below one
    /// with more.
    pub(crate) fn relative_noise(&self) -> f32 {
        (16.0 / self.samples.max(1) as f32).sqrt()
    }
}

impl Default for TraceSettings {
    fn default() -> Self {
        Self { samples: 16, bounces: 0, seed: 0 }
    }
}

/// Number of rays traced, by purpose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct RayCounts {
    /// Rays from the eye.
    pub primary: u64,
    /// Rays towards lights.
    pub shadow: u64,
    /// Rays that a mirror reflects or glass refracts.
    pub secondary: u64,
    /// Rays of diffuse bounces.
    pub indirect: u64,
    /// Shadow rays so short that the irradiance of their light was bounded; counted in `shadow`
    /// too.
    pub clamped: u64,
    /// Paths that ended at the bound on their length ([`MAX_PATH`](super::MAX_PATH)); not rays.
    pub bounded: u64,
}

impl RayCounts {
    /// The sum over all purposes.
    pub fn total(&self) -> u64 {
        self.primary + self.shadow + self.secondary + self.indirect
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.primary += other.primary;
        self.shadow += other.shadow;
        self.secondary += other.secondary;
        self.indirect += other.indirect;
        self.clamped += other.clamped;
        self.bounded += other.bounded;
    }
}
