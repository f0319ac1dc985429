//! Bounds of the rays of a bundle: a box of directions against nodes, a pyramid against triangles.

use super::node::Node;
use super::ray_bundle::{RayBundle, lane_values};
use super::rays::{LANES, Shear8};
use super::slab::{FAR_SLACK, TINY};
use super::vectors::{cross, dot, sub};
use fearless_simd::{Simd, SimdBase, SimdMask, f32x4, f32x8, mask32x8, prelude::*};

/// Largest width of a bundle that is traced together: the side of the box of directions over the
/// largest component of any direction. Rays then diverge by less than about 45 degrees. Not tuned.
const WIDEST: f32 = 1.0;

/// Error of the cross product of two vectors, relative to the product of their lengths, with a
/// margin.
const ROUNDING: f32 = 64.0 * f32::EPSILON;

/// The rays of a bundle in two vectors of eight.
#[derive(Clone, Copy)]
pub(super) struct Lanes<S: Simd> {
    /// Directions by half and axis, with components that may be divided by
    /// ([`super::slab::safe_component`]).
    pub(super) safe_directions: [[f32x8<S>; 3]; 2],
    /// Ends of the rays, by half.
    pub(super) t_max: [f32x8<S>; 2],
    /// For each axis, a bit per ray whose direction is largest along it. Rays with a NaN or an
    /// infinity, which hit nothing, have no bit.
    pub(super) along: [u32; 3],
}

impl<S: Simd> Lanes<S> {
    /// Loads the rays of a bundle.
    #[inline(always)]
    pub(super) fn new(simd: S, bundle: &RayBundle) -> Self {
        let mut lanes = Self {
            safe_directions: [safe_directions(simd, bundle, 0), safe_directions(simd, bundle, 1)],
            t_max: [lane_values(simd, &bundle.t_max, 0), lane_values(simd, &bundle.t_max, 1)],
            along: [0; 3],
        };
        if bundle.origin.is_finite() {
            lanes.sort(simd, 0, bundle);
            lanes.sort(simd, 1, bundle);
        }
        lanes
    }

    /// Computes [`super::packet::largest_axis`] and [`super::traverse::is_sound`] for eight rays.
    #[inline(always)]
    fn sort(&mut self, simd: S, half: usize, bundle: &RayBundle) {
        let [x, y, z] = &bundle.directions;
        let x = lane_values(simd, x, half).abs();
        let y = lane_values(simd, y, half).abs();
        let z = lane_values(simd, z, half).abs();
        let infinite = f32x8::splat(simd, f32::INFINITY);
        let is_sound = x.simd_lt(infinite)
            & y.simd_lt(infinite)
            & z.simd_lt(infinite)
            & self.t_max[half].simd_eq(self.t_max[half]);
        let along_x = x.simd_gt(y.max(z));
        let along_y = !along_x & y.simd_gt(z);
        let is_there = ((1u32 << bundle.len) - 1) >> (half * LANES) & 0xff;
        let bits = |mask: u64| (mask as u32 & is_there) << (half * LANES);
        self.along[0] |= bits((is_sound & along_x).to_bitmask());
        self.along[1] |= bits((is_sound & along_y).to_bitmask());
        self.along[2] |= bits((is_sound & !along_x & !along_y).to_bitmask());
    }
}

/// The box of directions of a bundle, prepared for box tests.
#[derive(Clone, Copy)]
pub(super) struct Cone {
    /// By plane of a box, as in [`Node::bounds`]: one over the largest direction for lower planes,
    /// over the smallest for upper ones.
    inverse: [f32; 6],
    /// Per axis, the index into [`Node::bounds`] of the plane met first; that of the other is `^
    /// 1`.
    near: [usize; 3],
    /// Per axis, whether directions of both signs occur, so that each plane is met first by some
    /// ray.
    is_mixed: [bool; 3],
    /// The farthest end of any ray.
    t_max: f32,
    /// True where the rays diverge too much for a common traversal to pay off.
    pub(super) is_wide: bool,
}

impl Cone {
    /// Bounds the rays `rays` (a bit each), whose largest axis is `along`.
    #[inline(always)]
    pub(super) fn new<S: Simd>(simd: S, lanes: &Lanes<S>, along: usize, rays: u32) -> Self {
        let (mut least, mut most) = ([0.0; 3], [0.0; 3]);
        let (mut widest, mut longest) = (0.0f32, 0.0f32);
        for axis in 0..3 {
            let values = [lanes.safe_directions[0][axis], lanes.safe_directions[1][axis]];
            [least[axis], most[axis]] = range(simd, values, rays);
            widest = widest.max(most[axis] - least[axis]);
            longest = longest.max(most[axis].max(-least[axis]));
        }
        Self {
            inverse: std::array::from_fn(|plane| {
                1.0 / if plane % 2 == 0 { most[plane / 2] } else { least[plane / 2] }
            }),
            near: std::array::from_fn(|axis| 2 * axis + usize::from(most[axis] < 0.0)),
            is_mixed: std::array::from_fn(|axis| least[axis] < 0.0 && most[axis] > 0.0),
            t_max: range(simd, lanes.t_max, rays)[1],
            // No pyramid bounds rays that run both ways along their largest axis.
            is_wide: widest > WIDEST * longest || least[along] < 0.0 && most[along] > 0.0,
        }
    }

    /// Returns a bit per child of a node whose box some direction may meet.
    #[inline(always)]
    pub(super) fn meets<S: Simd>(&self, simd: S, node: &Node, origin: &[f32x8<S>; 3]) -> u32 {
        let mut enter = f32x8::splat(simd, 0.0);
        let mut leave = f32x8::splat(simd, f32::INFINITY);
        // Intersect the intervals in which the rays may be between the planes of each axis.
        for axis in 0..3 {
            let near = self.near[axis];
            let first = plane(simd, node, near, origin) * f32x8::splat(simd, self.inverse[near]);
            let last = plane(simd, node, near ^ 1, origin) * f32x8::splat(simd, self.inverse[near ^ 1]);
            enter = enter.max(first);
            if self.is_mixed[axis] {
                enter = enter.max(last);
            } else {
                leave = leave.min(last);
            }
        }
        let leave = (leave * f32x8::splat(simd, FAR_SLACK)).min(f32x8::splat(simd, self.t_max));
        enter.simd_le(leave).to_bitmask() as u32
    }
}

/// A pyramid around rays of one largest axis: their directions, scaled so that the component along
/// that axis is one or minus one.
#[derive(Clone, Copy)]
pub(super) struct Beam {
    /// The permuted axes; the last is the largest.
    axes: [usize; 3],
    /// Smallest components, in permuted axes.
    low: [f32; 3],
    /// Largest components, in permuted axes.
    high: [f32; 3],
}

impl Beam {
    /// Bounds rays that run one way along the axis.
    #[inline(always)]
    pub(super) fn new<S: Simd>(simd: S, shear: &[Shear8<S>; 2], axis: usize, rays: u32) -> Self {
        let axes = [(axis + 1) % 3, (axis + 2) % 3, axis];
        let [_, most] = range(simd, [shear[0].z, shear[1].z], rays);
        let x = range(simd, [shear[0].x, shear[1].x], rays);
        let y = range(simd, [shear[0].y, shear[1].y], rays);
        if most < 0.0 {
            Self { axes, low: [-x[1], -y[1], -1.0], high: [-x[0], -y[0], -1.0] }
        } else {
            Self { axes, low: [x[0], y[0], 1.0], high: [x[1], y[1], 1.0] }
        }
    }

    /// Returns a bit per triangle, corners relative to the origin, that the rays may meet: no plane
    /// through the origin and one of its edges separates it from them.
    #[inline(always)]
    pub(super) fn meets_triangles<S: Simd>(&self, simd: S, corners: &[[f32x4<S>; 3]; 3]) -> u32 {
        let [a, b, c] = corners;
        let edges = [sub(b, a), sub(c, b), sub(a, c)];
        // Bound the rounding error of a plane, and of the edge functions of single rays.
        let longest = extent(&edges[0]).max(extent(&edges[1])).max(extent(&edges[2]));
        let slack = longest * extent(a).max(extent(b)).max(extent(c)) * f32x4::splat(simd, ROUNDING);
        // Find the side of the planes on which the triangles lie.
        let planes = [cross(a, &edges[0]), cross(b, &edges[1]), cross(c, &edges[2])];
        let facing = dot(&planes[0], c);
        let unsure = slack * extent(c);
        let (front, back) = (facing.simd_gt(unsure), facing.simd_lt(-unsure));
        // Cull unused lanes (NaN); where numbers overflow, nothing is culled.
        let mut outside = a[0].simd_ne(a[0]);
        // Cull a triangle where a plane has all rays on its other side.
        for plane in &planes {
            let [least, most] = self.range_along(simd, plane);
            outside |= (front & most.simd_lt(-slack)) | (back & least.simd_gt(slack));
        }
        !outside.to_bitmask() as u32 & 0xf
    }

    /// Returns the smallest and the largest component of the directions along four normals.
    #[inline(always)]
    fn range_along<S: Simd>(&self, simd: S, normal: &[f32x4<S>; 3]) -> [f32x4<S>; 2] {
        let mut range = [f32x4::splat(simd, 0.0); 2];
        for k in 0..3 {
            let low = normal[self.axes[k]] * f32x4::splat(simd, self.low[k]);
            let high = normal[self.axes[k]] * f32x4::splat(simd, self.high[k]);
            range = [range[0] + low.min(high), range[1] + low.max(high)];
        }
        range
    }
}

/// Returns the sum of the components' magnitudes, a bound on the length.
#[inline(always)]
fn extent<S: Simd>(v: &[f32x4<S>; 3]) -> f32x4<S> {
    v[0].abs() + v[1].abs() + v[2].abs()
}

#[inline(always)]
fn safe_directions<S: Simd>(simd: S, bundle: &RayBundle, which: usize) -> [f32x8<S>; 3] {
    let [x, y, z] = &bundle.directions;
    [
        safe_components(simd, lane_values(simd, x, which)),
        safe_components(simd, lane_values(simd, y, which)),
        safe_components(simd, lane_values(simd, z, which)),
    ]
}

/// Computes [`super::slab::safe_component`] for eight numbers.
#[inline(always)]
fn safe_components<S: Simd>(simd: S, d: f32x8<S>) -> f32x8<S> {
    let tiny = f32x8::splat(simd, TINY);
    d.abs().simd_lt(tiny).select(tiny.copysign(d), d)
}

/// Returns the smallest and the largest value of some rays (a bit each), NaN left out.
#[inline(always)]
fn range<S: Simd>(simd: S, [first, second]: [f32x8<S>; 2], rays: u32) -> [f32; 2] {
    let (low, high) = (f32x8::splat(simd, f32::INFINITY), f32x8::splat(simd, f32::NEG_INFINITY));
    let in_first = mask32x8::from_bitmask(simd, u64::from(rays & 0xff)) & first.simd_eq(first);
    let in_second = mask32x8::from_bitmask(simd, u64::from(rays >> LANES & 0xff)) & second.simd_eq(second);
    let least = in_first.select(first, low).min(in_second.select(second, low)).to_array();
    let most = in_first.select(first, high).max(in_second.select(second, high)).to_array();
    [least.into_iter().fold(f32::INFINITY, f32::min), most.into_iter().fold(f32::NEG_INFINITY, f32::max)]
}

/// Returns one plane of each of a node's boxes, relative to an origin.
#[inline(always)]
fn plane<S: Simd>(simd: S, node: &Node, which: usize, origin: &[f32x8<S>; 3]) -> f32x8<S> {
    f32x8::load_array_ref(simd, &node.bounds[which]) - origin[which / 2]
}
