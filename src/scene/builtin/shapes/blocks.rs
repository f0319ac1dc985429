//! Boxes in a frame of their own, and what is made of boxes.

use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec2, DVec3, Vec2};

/// A right-handed frame in the world: where something stands and how it is turned.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene::builtin) struct Local {
    /// World position of the frame's zero.
    pub(in crate::scene::builtin) origin: DVec3,
    /// World direction of the frame's x; y is up and z is `x cross up`.
    pub(in crate::scene::builtin) x: DVec3,
}

impl Local {
    /// The world itself.
    pub(in crate::scene::builtin) const WORLD: Self = Self { origin: DVec3::ZERO, x: DVec3::X };

    /// Standing at `origin`, unturned.
    pub(in crate::scene::builtin) fn at(origin: DVec3) -> Self {
        Self { origin, x: DVec3::X }
    }

    /// Turned about the vertical, counter-clockwise seen from above.
    pub(in crate::scene::builtin) fn turned(origin: DVec3, degrees: f64) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self { origin, x: DVec3::new(cos, 0.0, -sin) }
    }

    /// A direction of the frame in the world.
    pub(in crate::scene::builtin) fn direction(&self, d: DVec3) -> DVec3 {
        self.x * d.x + DVec3::Y * d.y + self.x.cross(DVec3::Y) * d.z
    }

    /// A point of the frame in the world.
    pub(in crate::scene::builtin) fn point(&self, p: DVec3) -> DVec3 {
        self.origin + self.direction(p)
    }

    /// The same frame standing at one of its points.
    pub(in crate::scene::builtin) fn moved(&self, p: DVec3) -> Self {
        Self { origin: self.point(p), x: self.x }
    }
}

/// Which faces of a box are there. A face that lies on another body is left out: two faces in one plane would fight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene::builtin) struct Faces(u8);

impl Faces {
    pub(in crate::scene::builtin) const ALL: Self = Self(0x3f);
    pub(in crate::scene::builtin) const LEFT: Self = Self(1);
    pub(in crate::scene::builtin) const RIGHT: Self = Self(2);
    pub(in crate::scene::builtin) const BOTTOM: Self = Self(4);
    pub(in crate::scene::builtin) const TOP: Self = Self(8);
    pub(in crate::scene::builtin) const BACK: Self = Self(16);

    /// All these except `other`.
    pub(in crate::scene::builtin) const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }
}

/// Corners of each face of the unit box, counter-clockwise from outside, the first edge horizontal.
const FACES: [[[u8; 3]; 4]; 6] = [
    [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
    [[1, 0, 1], [1, 0, 0], [1, 1, 0], [1, 1, 1]],
    [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
    [[0, 1, 1], [1, 1, 1], [1, 1, 0], [0, 1, 0]],
    [[1, 0, 0], [0, 0, 0], [0, 1, 0], [1, 1, 0]],
    [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
];

/// A box from corner `low` to corner `high` of a frame; texture coordinates are metres.
pub(in crate::scene::builtin) fn block(
    b: &mut SceneBuilder,
    frame: &Local,
    [low, high]: [DVec3; 2],
    faces: Faces,
    material: MaterialId,
) {
    for (_, face) in FACES.iter().enumerate().filter(|(i, _)| faces.0 & (1 << i) != 0) {
        let corners = face.map(|c| {
            let pick = |axis: usize| if c[axis] == 1 { high[axis] } else { low[axis] };
            frame.point(DVec3::new(pick(0), pick(1), pick(2)))
        });
        let size = DVec2::new(corners[0].distance(corners[1]), corners[1].distance(corners[2]));
        b.add_quad(corners, size.as_vec2(), material);
    }
}

/// A horizontal rectangle at height `y` that faces up.
pub(in crate::scene::builtin) fn floor(
    b: &mut SceneBuilder,
    [x0, x1, z0, z1]: [f64; 4],
    y: f64,
    material: MaterialId,
) {
    let corner = |x, z| DVec3::new(x, y, z);
    let corners = [corner(x0, z1), corner(x1, z1), corner(x1, z0), corner(x0, z0)];
    b.add_quad(corners, Vec2::new((x1 - x0) as f32, (z1 - z0) as f32), material);
}

/// A horizontal rectangle at height `y` that faces down.
pub(in crate::scene::builtin) fn ceiling(
    b: &mut SceneBuilder,
    [x0, x1, z0, z1]: [f64; 4],
    y: f64,
    material: MaterialId,
) {
    let corner = |x, z| DVec3::new(x, y, z);
    let corners = [corner(x0, z0), corner(x1, z0), corner(x1, z1), corner(x0, z1)];
    b.add_quad(corners, Vec2::new((x1 - x0) as f32, (z1 - z0) as f32), material);
}

/// A flight that climbs along the frame's -z against a landing: `risers` of them, the last one the landing's own.
pub(in crate::scene::builtin) fn stairs(
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
        // Only the tread in front of the next riser shows.
        let tread_low = DVec3::new(0.0, high.y, depth - tread);
        let corners =
            [DVec3::new(0.0, high.y, depth), high, DVec3::new(width, high.y, depth - tread), tread_low];
        let uv = Vec2::new(width as f32, tread as f32);
        b.add_quad(corners.map(|p| frame.point(p)), uv, material);
    }
}
