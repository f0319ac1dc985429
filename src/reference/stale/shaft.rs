//! Shafts: what lies between two boxes.
//!
//! Source: Haines and Wallace, "Shaft Culling for Efficient Ray-Traced Radiosity", 1991. We differ:
//! every line through corners of both boxes of the same kind gives two planes, in each of the three
//! projections along an axis, and each plane is moved outwards until it has both boxes on one side.
//! So the shaft contains the hull of the boxes whichever lines are its silhouette, and rounding can
//! only make it wider.

use glam::Vec3;

/// Relative rounding error of a distance from a plane: a few units in the last place.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// An axis-aligned box: lower and upper corner.
pub(super) type Bounds = [Vec3; 2];

/// A convex region that contains two boxes and all that is between them.
#[derive(Debug)]
pub(super) struct Shaft {
    bounds: Bounds,
    /// Normals, and the largest products with a point of the shaft.
    planes: Vec<(Vec3, f32)>,
}

/// The smallest box around some points; inside out without any.
pub(super) fn bounds_of(points: impl IntoIterator<Item = Vec3>) -> Bounds {
    let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    points.into_iter().fold(nothing, |[low, high], point| [low.min(point), high.max(point)])
}

/// The largest product of a vector with a point of a box, and the smallest.
fn extent(bounds: Bounds, normal: Vec3) -> [f32; 2] {
    let [low, high] = bounds.map(|corner| corner * normal);
    [low.max(high).element_sum(), low.min(high).element_sum()]
}

impl Shaft {
    /// The shaft between two boxes.
    pub(super) fn new(a: Bounds, b: Bounds) -> Self {
        let mut planes = Vec::new();
        for axis in 0..3 {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            for kind in 0..4 {
                let corner = |of: Bounds| [of[kind & 1][i], of[kind >> 1][j]];
                let (p, q) = (corner(a), corner(b));
                let mut normal = Vec3::ZERO;
                (normal[i], normal[j]) = (q[1] - p[1], p[0] - q[0]);
                for normal in [normal, -normal] {
                    if normal != Vec3::ZERO {
                        planes.push((normal, extent(a, normal)[0].max(extent(b, normal)[0])));
                    }
                }
            }
        }
        Self { bounds: bounds_of(a.into_iter().chain(b)), planes }
    }

    /// False only where nothing of a box lies in the shaft.
    pub(super) fn meets(&self, other: Bounds) -> bool {
        let [low, high] = self.bounds;
        let overlaps = low.cmple(other[1]).all() && high.cmpge(other[0]).all();
        overlaps
            && self.planes.iter().all(|&(normal, most)| {
                let largest = bounds_of(other.into_iter().chain(self.bounds).map(Vec3::abs))[1];
                let slack = ROUNDING * normal.abs().dot(largest);
                extent(other, normal)[1] <= most + slack
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::key::Key;

    fn random_box(key: Key, size: f32) -> Bounds {
        let [a, b] = key.pair();
        let [c, d] = key.with(1).pair();
        let [e, f] = key.with(2).pair();
        let low = Vec3::new(a, b, c) * 10.0;
        [low, low + Vec3::new(d, e, f) * size]
    }

    fn point_in([low, high]: Bounds, key: Key) -> Vec3 {
        let [a, b] = key.pair();
        low + (high - low) * Vec3::new(a, b, key.with(1).pair()[0])
    }

    #[test]
    fn a_shaft_meets_every_box_on_a_line_between_its_ends_and_misses_most_others() {
        let (mut met, mut missed) = (0, 0);
        for i in 0..2000 {
            let key = Key::of_pixel(3, i);
            let [a, b, c] = [1, 2, 3].map(|k| random_box(key.with(10 * k), 1.0));
            let shaft = Shaft::new(a, b);
            let is_between = (0..400).any(|k| {
                let [from, to] = [(a, 4), (b, 5)].map(|(of, salt)| point_in(of, key.with(salt).with(k)));
                (0..=40u8).any(|step| {
                    let at = from.lerp(to, f32::from(step) / 40.0);
                    at.cmpge(c[0]).all() && at.cmple(c[1]).all()
                })
            });
            assert!(!is_between || shaft.meets(c), "{i}");
            met += usize::from(shaft.meets(c));
            missed += usize::from(shaft.meets(c) && !is_between);
        }
        assert!(met >= 20 && missed * 3 < met, "{missed} of {met} for nothing");
    }
}
