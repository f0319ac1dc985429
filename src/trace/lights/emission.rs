//! The directions in which lamps emit: an axis, the angle of the lamps' own axes to it, and the
//! angle to these at which each lamp's light ends.

use crate::scene::Light;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// Directions in which some lamps emit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Emission {
    /// Unit vector.
    axis: Vec3,
    /// Largest angle between the axis and that of a lamp, radians, with its cosine and sine.
    angle: f32,
    cos: f32,
    sin: f32,
    /// Cosine of the angle from a lamp's axis at which its light ends.
    cos_reach: f32,
    /// True where the opposite of each direction counts as well.
    has_two_sides: bool,
}

impl Emission {
    fn new(axis: Vec3, angle: f32, cos_reach: f32, has_two_sides: bool) -> Self {
        let most = if has_two_sides { FRAC_PI_2 } else { PI };
        if angle >= most || axis == Vec3::ZERO {
            return Self { axis: Vec3::Y, angle: PI, cos: -1.0, sin: 0.0, cos_reach, has_two_sides: false };
        }
        Self { axis, angle, cos: angle.cos(), sin: angle.sin(), cos_reach, has_two_sides }
    }

    fn everywhere(cos_reach: f32) -> Self {
        Self::new(Vec3::ZERO, PI, cos_reach, false)
    }

    /// Directions of one light.
    pub(super) fn of(light: &Light) -> Self {
        match light {
            Light::Quad { edge_u, edge_v, has_one_side, .. } => {
                Self::new(edge_u.cross(*edge_v).normalize_or_zero(), 0.0, 0.0, !has_one_side)
            }
            Light::Triangles { corners, picture, has_one_side, .. } => {
                let normal = |[a, b, c]: &[Vec3; 3]| (*b - *a).cross(*c - *a).normalize_or_zero();
                let triangles = Light::outline(corners, picture).iter().map(normal);
                let emissions = triangles.map(|axis| Self::new(axis, 0.0, 0.0, !has_one_side));
                emissions.reduce(|all, one| all.with(&one)).unwrap_or_else(|| Self::everywhere(0.0))
            }
            Light::Point { beam: Some(beam), .. } => {
                let [inner, outer] = [beam.cos_inner, beam.cos_outer].map(|cos| cos.clamp(-1.0, 1.0).acos());
                Self::new(beam.direction, inner, (outer - inner).max(0.0).cos(), false)
            }
            Light::Point { profile: Some(profile), .. } => {
                let reach = profile.cos_reach().clamp(-1.0, 1.0).acos();
                Self::new(profile.axes()[0], reach, 1.0, false)
            }
            _ => Self::everywhere(-1.0),
        }
    }

    /// Directions of these lamps and of others.
    pub(super) fn with(&self, other: &Self) -> Self {
        let cos_reach = self.cos_reach.min(other.cos_reach);
        let has_two_sides = self.has_two_sides;
        if self.angle >= PI || other.angle >= PI || has_two_sides != other.has_two_sides {
            return Self::everywhere(cos_reach);
        }
        let (wide, narrow) = if self.angle >= other.angle { (self, other) } else { (other, self) };
        let sign = if has_two_sides && wide.axis.dot(narrow.axis) < 0.0 { -1.0 } else { 1.0 };
        let cos = (wide.axis.dot(narrow.axis) * sign).clamp(-1.0, 1.0);
        let between = cos.acos();
        if between + narrow.angle <= wide.angle {
            return Self { cos_reach, ..*wide };
        }
        // The smallest cone around both: turn the wider one's axis towards the other.
        let angle = (wide.angle + between + narrow.angle) / 2.0;
        let across = (narrow.axis * sign - wide.axis * cos).normalize_or_zero();
        let turn = angle - wide.angle;
        let axis = (wide.axis * turn.cos() + across * turn.sin()).normalize_or_zero();
        Self::new(axis, angle, cos_reach, has_two_sides)
    }

    /// Unit vector in the middle of the lamps' axes.
    pub(super) fn axis(&self) -> Vec3 {
        self.axis
    }

    /// True where the opposite of each direction counts as well.
    pub(super) fn has_two_sides(&self) -> bool {
        self.has_two_sides
    }

    /// True where all axes are the same but for rounding.
    pub(super) fn is_flat(&self) -> bool {
        self.cos > 1.0 - 1.0 / 256.0
    }

    /// Relative size of the directions, 1..3, in the cost of a node.
    pub(super) fn spread(&self) -> f32 {
        2.0 - self.cos
    }

    /// The largest cosine between a lamp's axis and a direction, where the direction may be off by
    /// an angle whose cosine and sine are given.
    pub(super) fn cos_towards(&self, direction: Vec3, [cos, sin]: [f32; 2]) -> f32 {
        let along = self.axis.dot(direction);
        let along = if self.has_two_sides { along.abs() } else { along };
        turned_back(turned_back(along, self.cos, self.sin), cos, sin)
    }

    /// True where lamps emit at a cosine to their axis, with some slack.
    pub(super) fn reaches(&self, cos: f32, slack: f32) -> bool {
        cos >= self.cos_reach - slack
    }
}

/// The cosine of an angle made smaller by another one, whose cosine and sine are given, but not
/// below zero.
pub(super) fn turned_back(cos_angle: f32, cos: f32, sin: f32) -> f32 {
    if cos_angle >= cos {
        return 1.0;
    }
    cos_angle * cos + (1.0 - cos_angle * cos_angle).max(0.0).sqrt() * sin
}
