//! The sky as a gradient over the elevation angle.

use glam::Vec3;

/// A clear sky. It is the background of rays that leave the scene, and it lights surfaces.
/// Radiances are linear Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Radiance from straight above.
    pub zenith: Vec3,
    /// Radiance from the horizon.
    pub horizon: Vec3,
    /// Radiance from below the horizon.
    pub ground: Vec3,
}

impl Sky {
    /// The sky of a clear day, used where a file does not describe its own. Its irradiance is
    /// roughly a tenth of that of [`Sun::clear_day`](super::Sun::clear_day).
    pub const CLEAR_DAY: Self = Self {
        zenith: Vec3::new(0.35, 0.55, 1.0),
        horizon: Vec3::new(0.9, 0.95, 1.0),
        ground: Vec3::new(0.25, 0.23, 0.2),
    };

    /// Returns the radiance that arrives from a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        /// Sine of the angle below the horizon over which the ground blends into the horizon: 4.6
        /// degrees. A hard edge would alias.
        const BLEND_SINE: f32 = 0.08;
        let up = direction.y.clamp(-1.0, 1.0);
        if up >= 0.0 {
            self.horizon.lerp(self.zenith, up.sqrt())
        } else {
            self.horizon.lerp(self.ground, (-up / BLEND_SINE).min(1.0))
        }
    }
}
