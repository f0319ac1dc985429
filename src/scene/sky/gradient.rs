//! The sky as a gradient over the elevation angle.

use glam::Vec3;

/// A clear sky without a sun of its own, cheap to evaluate. Radiances are linear Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gradient {
    /// Radiance from straight above.
    pub zenith: Vec3,
    /// Radiance from the horizon.
    pub horizon: Vec3,
    /// Radiance from below the horizon.
    pub ground: Vec3,
}

impl Gradient {
    /// The sky of a clear day, used where a file does not describe its own. Its irradiance is
    /// roughly a tenth of that of [`Sun::clear_day`](super::super::Sun::clear_day).
    pub const CLEAR_DAY: Self = Self {
        zenith: Vec3::new(0.35, 0.55, 1.0),
        horizon: Vec3::new(0.9, 0.95, 1.0),
        ground: Vec3::new(0.25, 0.23, 0.2),
    };

    /// Returns the radiance that arrives from a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let up = direction.y.clamp(-1.0, 1.0);
        if up >= 0.0 {
            self.horizon.lerp(self.zenith, up.sqrt())
        } else {
            below_horizon(self.horizon, self.ground, up)
        }
    }
}

/// Returns the radiance below the horizon, where `up` is the sine of the elevation and negative.
/// The ground blends into the horizon over 4.6 degrees, because a hard edge would alias.
pub(super) fn below_horizon(horizon: Vec3, ground: Vec3, up: f32) -> Vec3 {
    const BLEND_SINE: f32 = 0.08;
    horizon.lerp(ground, (-up / BLEND_SINE).min(1.0))
}
