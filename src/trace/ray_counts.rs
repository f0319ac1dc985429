//! Counts of traced rays.

use std::ops::AddAssign;

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
    }
}
