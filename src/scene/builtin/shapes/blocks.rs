//! Boxes in a local frame, and shapes composed of them.

use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec2, DVec3, Vec2};

/// A right-handed local frame: the position of an object and its rotation about the vertical axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local {
    /// World position of the origin.
    pub(crate) origin: DVec3,
    /// World direction of the x axis. The y axis points up and the z axis is `x cross y`.
    pub(crate) x: DVec3,
}

impl Local {
    /// The world frame.
    pub(crate) const WORLD: Self = Self { origin: DVec3::ZERO, x: DVec3::X };

    /// Returns a frame at `origin` with the axes of the world.
    pub(crate) fn at(origin: DVec3) -> Self {
        Self { origin, x: DVec3::X }
    }

    /// Returns a frame turned about the vertical axis, counter-clockwise seen from above.
    pub(crate) fn turned(origin: DVec3, degrees: f64) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self { origin, x: DVec3::new(cos, 0.0, -sin) }
    }

    /// Transforms a direction to the world.
    pub(crate) fn direction(&self, d: DVec3) -> DVec3 {
        self.x * d.x + DVec3::Y * d.y + self.x.cross(DVec3::Y) * d.z
    }

    /// Transforms a point to the world.
    pub(crate) fn point(&self, p: DVec3) -> DVec3 {
        self.origin + self.direction(p)
    }

    /// Returns the frame moved to one of its points.
    pub(crate) fn moved(&self, p: DVec3) -> Self {
        Self { origin: self.point(p), x: self.x }
    }
}

/// The faces of a box that exist. Faces that lie on another object are left out, because of two
/// faces in one plane rounding would choose pixel by pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Faces(u8);

impl Faces {
    pub(crate) const ALL: Self = Self(0x3f);
    pub(crate) const LEFT: Self = Self(1);
    pub(crate) const RIGHT: Self = Self(2);
    pub(crate) const BOTTOM: Self = Self(4);
    pub(crate) const TOP: Self = Self(8);
    pub(crate) const BACK: Self = Self(16);

    /// Returns these faces except `other`.
    pub(crate) const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }
}

/// Corners of each face of the unit box, counter-clockwise seen from outside, beginning with a
/// horizontal edge.
const FACES: [[[u8; 3]; 4]; 6] = [
    [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
    [[1, 0, 1], [1, 0, 0], [1, 1, 0], [1, 1, 1]],
    [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
    [[0, 1, 1], [1, 1, 1], [1, 1, 0], [0, 1, 0]],
    [[1, 0, 0], [0, 0, 0], [0, 1, 0], [1, 1, 0]],
    [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
];

/// Adds a box from corner `low` to corner `high` of a frame. Texture coordinates are in metres.
pub(crate) fn block(
    b: &mut SceneBuilder,
    frame: &Local,
    [low, high]: [DVec3; 2],
    faces: Faces,
    material: MaterialId,
) {
    for (_, face) in FACES.iter().enumerate().filter(|(i, _)| faces.0 >> i & 1 == 1) {
        let corners = face.map(|c| {
            let pick = |axis: usize| if c[axis] == 1 { high[axis] } else { low[axis] };
            frame.point(DVec3::new(pick(0), pick(1), pick(2)))
        });
        let size = DVec2::new(corners[0].distance(corners[1]), corners[1].distance(corners[2]));
        b.add_quad(corners, size.as_vec2(), material);
    }
}

/// Adds a horizontal rectangle at height `y` that faces up.
pub(crate) fn floor(b: &mut SceneBuilder, [x0, x1, z0, z1]: [f64; 4], y: f64, material: MaterialId) {
    let corner = |x, z| DVec3::new(x, y, z);
    let corners = [corner(x0, z1), corner(x1, z1), corner(x1, z0), corner(x0, z0)];
    b.add_quad(corners, Vec2::new((x1 - x0) as f32, (z1 - z0) as f32), material);
}

/// Adds a horizontal rectangle at height `y` that faces down.
pub(crate) fn ceiling(b: &mut SceneBuilder, [x0, x1, z0, z1]: [f64; 4], y: f64, material: MaterialId) {
    let corner = |x, z| DVec3::new(x, y, z);
    let corners = [corner(x0, z0), corner(x1, z0), corner(x1, z1), corner(x0, z1)];
    b.add_quad(corners, Vec2::new((x1 - x0) as f32, (z1 - z0) as f32), material);
}

/// Adds stairs that climb along -z of the frame to a landing. The last of the `risers` is the edge
/// of the landing.
pub(crate) fn stairs(
    b: &mut SceneBuilder,
    frame: &Local,
    width: f64,
    [riser, tread]: [f64; 2],
    risers: u32,
    material: MaterialId,
) {
    for step in 1..risers {
        let depth = f64::from(risers - step) * tread;
        let low = DVec3::new(0.0, f64::from(step - 1) * riser, 0.0);
        let high = DVec3::new(width, f64::from(step) * riser, depth);
        let hidden = Faces::ALL.without(Faces::BOTTOM).without(Faces::BACK).without(Faces::TOP);
        block(b, frame, [low, high], hidden, material);
        // Only the part of the tread in front of the next riser is visible.
        let tread_low = DVec3::new(0.0, high.y, depth - tread);
        let corners =
            [DVec3::new(0.0, high.y, depth), high, DVec3::new(width, high.y, depth - tread), tread_low];
        let uv = Vec2::new(width as f32, tread as f32);
        b.add_quad(corners.map(|p| frame.point(p)), uv, material);
    }
}
