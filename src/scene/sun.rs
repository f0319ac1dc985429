//! The sun as a distant disk.

use glam::{DVec3, Vec3};

/// A sun: a disk at infinity that emits evenly. Directions are those of world and scene space,
/// which have the same axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Unit direction towards the centre of the disk.
    pub direction: Vec3,
    /// Angle between the centre and the rim of the disk, in radians, 0 to pi / 2. With 0, shadows
    /// are sharp.
    pub angular_radius: f32,
    /// Irradiance on a surface that faces the sun, linear Rec. 709.
    pub irradiance: Vec3,
}

impl Sun {
    /// Angular radius of the sun seen from the earth, in radians: 0.27 degrees.
    pub const ANGULAR_RADIUS: f32 = 0.27f32.to_radians();

    /// The sun of a clear day, used where a file does not describe its own: 55 degrees above the
    /// horizon in the south-south-east, with north along -Z.
    pub fn clear_day() -> Self {
        Self {
            direction: DVec3::new(0.35, 1.0, 0.6).normalize_or(DVec3::Y).as_vec3(),
            angular_radius: Self::ANGULAR_RADIUS,
            irradiance: Vec3::new(10.0, 9.4, 8.4),
        }
    }
}
