//! Walls with thickness and openings, and without faces inside them.

use super::Local;
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec2};

/// A rectangular opening through a wall, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Opening {
    /// Start and end along the wall.
    pub(crate) along: [f64; 2],
    /// Heights of the lower and the upper edge.
    pub(crate) height: [f64; 2],
}

/// A straight wall along the x axis of its frame. Its front faces +z.
#[derive(Clone, Debug)]
pub(crate) struct Wall {
    /// Frame in which the wall begins at x = 0 and its middle plane is z = 0.
    pub(crate) frame: Local,
    /// Length along x in metres.
    pub(crate) length: f64,
    /// Heights of the lower and the upper edge.
    pub(crate) height: [f64; 2],
    /// Thickness along z in metres.
    pub(crate) thickness: f64,
    /// Openings in ascending order. They must not touch each other.
    pub(crate) openings: Vec<Opening>,
    /// Materials of the front and of the back.
    pub(crate) sides: [MaterialId; 2],
    /// Material of the insides of the openings.
    pub(crate) reveal: MaterialId,
}

impl Wall {
    /// Adds both sides and the reveals. Ends, top and bottom are left out because they lie on other
    /// objects.
    pub(crate) fn add_to(&self, b: &mut SceneBuilder) {
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

    /// Returns the face of the wall without its openings, as rectangles `[x0, x1, y0, y1]`.
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
