//! Rays, and the offset with which a ray leaves a surface without hitting it again.

use glam::Vec3;

/// A half-line in scene space. `direction` need not have unit length; `t` counts in units of its
/// length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin, scene units.
    pub origin: Vec3,
    /// Direction, scene units per unit of `t`.
    pub direction: Vec3,
    /// Hits at this `t` or beyond are ignored.
    pub t_max: f32,
}

impl Ray {
    /// Creates a ray of infinite length.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_max: f32::INFINITY }
    }

    /// Creates the segment from `origin` to just before `target`, with `t` in 0..1.
    ///
    /// The segment is shortened by 2^-12 of its length, so that the surface at the target does not
    /// shadow it. That is 4096 times the rounding step of `t`, and 2 mm on a shadow ray of 8 m.
    pub fn segment(origin: Vec3, target: Vec3) -> Self {
        const END: f32 = 1.0 - 1.0 / 4096.0;
        Self { origin, direction: target - origin, t_max: END }
    }
}

/// Moves a surface point along `normal`, far enough that a ray from there cannot hit the same
/// surface.
///
/// Source: Waechter and Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray
/// Tracing Gems, chapter 6. The step is counted in units in the last place (ulps) of the position,
/// so that it scales with the coordinates. We differ: their fixed step near the origin is relative
/// to `magnitude`, the largest coordinate of the triangle that the point lies on, instead of a
/// length in metres. No absolute epsilon remains.
pub fn offset_from_surface(point: Vec3, normal: Vec3, magnitude: f32) -> Vec3 {
    const ULPS: f32 = 256.0;
    // Below 1/32 of the triangle's largest coordinate the point's own ulp no longer measures its
    // error.
    let near_zero = magnitude * (1.0 / 32.0);
    let step = near_zero * (ULPS * f32::EPSILON);
    let axis = |p: f32, n: f32| {
        if p.abs() < near_zero {
            return p + step * n;
        }
        let ulps = (ULPS * n) as i32;
        f32::from_bits((p.to_bits() as i32 + if p < 0.0 { -ulps } else { ulps }) as u32)
    };
    Vec3::new(axis(point.x, normal.x), axis(point.y, normal.y), axis(point.z, normal.z))
}
