//! The position of the sun in the sky, and directions towards it.

use glam::{DVec3, Vec3};

/// The position of the sun in the sky for an observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPosition {
    /// Azimuth in degrees, 0 to 360, from north over east.
    pub azimuth_deg: f64,
    /// Height above the horizon in degrees.
    pub height_deg: f64,
}

impl SunPosition {
    /// Returns the unit direction towards the sun, where +Y is up and north is turned by
    /// `north_deg` degrees from -Z towards +X.
    pub fn direction(&self, north_deg: f64) -> DVec3 {
        let (sin, cos) = (self.azimuth_deg + north_deg).to_radians().sin_cos();
        let (up, level) = self.height_deg.to_radians().sin_cos();
        DVec3::new(level * sin, up, -level * cos)
    }

    /// Returns the position that belongs to a direction towards the sun, with north along -Z.
    pub fn of_direction(direction: Vec3) -> Self {
        let d = direction.as_dvec3().normalize_or(DVec3::Y);
        Self {
            azimuth_deg: d.x.atan2(-d.z).to_degrees().rem_euclid(360.0),
            height_deg: d.y.clamp(-1.0, 1.0).asin().to_degrees(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_and_positions_are_inverse() {
        for (azimuth_deg, height_deg) in [(0.0, 10.0), (90.0, 45.0), (200.0, 80.0), (359.0, 1.0)] {
            let position = SunPosition { azimuth_deg, height_deg };
            let back = SunPosition::of_direction(position.direction(0.0).as_vec3());
            assert!(
                (back.azimuth_deg - azimuth_deg).abs() < 1e-3 && (back.height_deg - height_deg).abs() < 1e-3
            );
        }
        let north = SunPosition { azimuth_deg: 0.0, height_deg: 0.0 };
        assert!((north.direction(0.0) - DVec3::NEG_Z).length() < 1e-12);
        assert!((north.direction(90.0) - DVec3::X).length() < 1e-12);
    }
}
