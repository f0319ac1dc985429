//! Walls with real thickness and openings, without any face inside them.

use super::Local;
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec2};

/// A rectangular hole through a wall, in the wall's own metres: along it and up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::scene::builtin) struct Opening {
    /// Where it begins and ends along the wall.
    pub(in crate::scene::builtin) along: [f64; 2],
    /// Sill and head.
    pub(in crate::scene::builtin) height: [f64; 2],
}

/// A straight wall. Along the frame's x, up its y; its front faces +z.
#[derive(Clone, Debug)]
pub(in crate::scene::builtin) struct Wall {
    /// Frame: x = 0 is the wall's beginning, z = 0 its middle plane.
    pub(in crate::scene::builtin) frame: Local,
    /// Metres along x.
    pub(in crate::scene::builtin) length: f64,
    /// Lower and upper edge.
    pub(in crate::scene::builtin) height: [f64; 2],
    /// Metres along z, half of it on either side.
    pub(in crate::scene::builtin) thickness: f64,
    /// In ascending order, not touching each other.
    pub(in crate::scene::builtin) openings: Vec<Opening>,
    /// Of the front and of the back.
    pub(in crate::scene::builtin) sides: [MaterialId; 2],
    /// Of the insides of the openings.
    pub(in crate::scene::builtin) reveal: MaterialId,
}

impl Wall {
    /// Adds both sides and the reveals. Ends, top and bottom are left out: they lie on other bodies.
    pub(in crate::scene::builtin) fn add_to(&self, b: &mut SceneBuilder) {
        for [x0, x1, y0, y1] in self.pieces() {
            let z = self.thickness / 2.0;
            let uv = Vec2::new((x1 - x0) as f32, (y1 - y0) as f32);
            let front = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| self.at(x, y, z));
            let back = [[x1, y0], [x0, y0], [x0, y1], [x1, y1]].map(|[x, y]| self.at(x, y, -z));
            b.add_quad(front, uv, self.sides[0]);
            b.add_quad(back, uv, self.sides[1]);
        }
        for opening in &self.openings {
            self.add_reveal(b, opening);
        }
    }

    fn at(&self, x: f64, y: f64, z: f64) -> DVec3 {
        self.frame.point(DVec3::new(x, y, z))
    }

    /// The wall's face without its openings, as rectangles `[x0, x1, y0, y1]`.
    fn pieces(&self) -> Vec<[f64; 4]> {
        let [bottom, top] = self.height;
        let mut pieces = Vec::new();
        let mut from = 0.0;
        for o in &self.openings {
            pieces.push([from, o.along[0], bottom, top]);
            pieces.push([o.along[0], o.along[1], bottom, o.height[0]]);
            pieces.push([o.along[0], o.along[1], o.height[1], top]);
            from = o.along[1];
        }
        pieces.push([from, self.length, bottom, top]);
        pieces.retain(|[x0, x1, y0, y1]| x1 > x0 && y1 > y0);
        pieces
    }

    fn add_reveal(&self, b: &mut SceneBuilder, o: &Opening) {
        let z = self.thickness / 2.0;
        let ([x0, x1], [y0, y1]) = (o.along, o.height);
        let quads = [
            [[x0, y0, z], [x0, y0, -z], [x0, y1, -z], [x0, y1, z]],
            [[x1, y0, -z], [x1, y0, z], [x1, y1, z], [x1, y1, -z]],
            [[x0, y0, z], [x1, y0, z], [x1, y0, -z], [x0, y0, -z]],
            [[x0, y1, -z], [x1, y1, -z], [x1, y1, z], [x0, y1, z]],
        ];
        for q in quads {
            let corners = q.map(|[x, y, z]| self.at(x, y, z));
            let uv =
                Vec2::new(corners[0].distance(corners[1]) as f32, corners[1].distance(corners[2]) as f32);
            b.add_quad(corners, uv, self.reveal);
        }
    }
}
