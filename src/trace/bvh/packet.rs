//! Intersects a ray with four triangles at once, watertight.
//!
//! Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2013. The ray is
//! sheared to the +z axis of a permuted space. Two triangles that share an edge compute the sign of
//! that edge from the same numbers, so a ray cannot pass between them. A sign that is exactly zero
//! is decided in f64, as in the paper. We differ: four triangles are tested at a time, and winding
//! is not swapped with the axes, because both sides are hit.

use super::hit::{Hit, NO_TRIANGLE};
use crate::math::Ray;
use fearless_simd::{f32x4, prelude::*};
use glam::Vec3;

/// Up to four triangles, with their corners transposed.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct TrianglePacket {
    /// `[corner][axis][lane]`, scene space; NaN in unused lanes.
    corners: [[[f32; 4]; 3]; 3],
    /// Triangle index of each lane.
    triangles: [u32; 4],
}

const _: () = assert!(size_of::<TrianglePacket>() == 160);

/// A ray, prepared once for all triangles it will meet.
#[derive(Clone, Copy)]
pub(super) struct ShearedRay<S: Simd> {
    origin: [f32x4<S>; 3],
    /// The permuted axes; the last is the largest of the direction.
    axes: [usize; 3],
    /// Factors that shear the direction to +z, and one over its largest component.
    shear: [f32x4<S>; 3],
}

impl<S: Simd> ShearedRay<S> {
    /// Prepares a ray.
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let axis = largest_axis(d);
        let [x, y, z] = axes(axis);
        let inverse = 1.0 / d[z];
        Self::from_shear(simd, ray.origin.to_array(), axis, [d[x] * inverse, d[y] * inverse, inverse])
    }

    /// A ray given by its origin, its largest axis, and the shear along that axis.
    #[inline(always)]
    pub(super) fn from_shear(simd: S, origin: [f32; 3], axis: usize, shear: [f32; 3]) -> Self {
        Self { origin: splat3(simd, origin), axes: axes(axis), shear: splat3(simd, shear) }
    }
}

/// Returns the axes in cyclic order, the largest last. Written out, so that the compiler sees that
/// no index is out of bounds.
#[inline(always)]
fn axes(largest: usize) -> [usize; 3] {
    match largest {
        0 => [1, 2, 0],
        1 => [2, 0, 1],
        _ => [0, 1, 2],
    }
}

/// Returns the axis along which a direction has its largest component.
#[inline(always)]
pub(super) fn largest_axis(d: [f32; 3]) -> usize {
    let magnitude = d.map(f32::abs);
    if magnitude[0] > magnitude[1].max(magnitude[2]) {
        0
    } else if magnitude[1] > magnitude[2] {
        1
    } else {
        2
    }
}

#[inline(always)]
fn splat3<S: Simd>(simd: S, [x, y, z]: [f32; 3]) -> [f32x4<S>; 3] {
    [f32x4::splat(simd, x), f32x4::splat(simd, y), f32x4::splat(simd, z)]
}

/// The hits of a ray with the triangles of a packet.
pub(super) struct PacketHits {
    /// Bit per lane that is hit.
    pub(super) mask: u32,
    t: [f32; 4],
    b1: [f32; 4],
    b2: [f32; 4],
}

impl PacketHits {
    /// The hit of one lane.
    pub(super) fn hit(&self, lane: usize, packet: &TrianglePacket) -> Hit {
        Hit { t: self.t[lane], triangle: packet.triangles[lane], b1: self.b1[lane], b2: self.b2[lane] }
    }
}

/// Intersects a ray with one triangle by the arithmetic of the hierarchy, with the same bits.
#[inline(always)]
pub(in crate::trace) fn intersect_triangle(
    simd: impl Simd,
    ray: &Ray,
    triangle: u32,
    corners: [Vec3; 3],
) -> Option<Hit> {
    let mut packet = TrianglePacket::EMPTY;
    packet.set(0, triangle, corners);
    let hits = packet.intersect(&ShearedRay::new(simd, ray), ray.t_max);
    (hits.mask & 1 != 0).then(|| hits.hit(0, &packet))
}

impl TrianglePacket {
    /// A packet without triangles: lanes with NaN corners are never hit.
    pub(super) const EMPTY: Self = Self { corners: [[[f32::NAN; 4]; 3]; 3], triangles: [NO_TRIANGLE; 4] };

    /// Writes the triangle of a lane.
    pub(super) fn set(&mut self, lane: usize, triangle: u32, corners: [Vec3; 3]) {
        self.triangles[lane] = triangle;
        for (corner, position) in corners.iter().enumerate() {
            for axis in 0..3 {
                self.corners[corner][axis][lane] = position[axis];
            }
        }
    }

    /// The corners as `[corner][axis][lane]`; NaN in unused lanes.
    pub(in crate::trace) fn corners(&self) -> &[[[f32; 4]; 3]; 3] {
        &self.corners
    }

    /// The corners of the triangle of a lane.
    #[inline(always)]
    pub(in crate::trace) fn triangle_corners(&self, lane: usize) -> [Vec3; 3] {
        let [a, b, c] = &self.corners;
        [
            Vec3::new(a[0][lane], a[1][lane], a[2][lane]),
            Vec3::new(b[0][lane], b[1][lane], b[2][lane]),
            Vec3::new(c[0][lane], c[1][lane], c[2][lane]),
        ]
    }

    /// Triangle index of a lane.
    pub(in crate::trace) fn triangle(&self, lane: usize) -> u32 {
        self.triangles[lane]
    }

    /// A corner relative to the ray's origin, in the permuted and sheared space.
    #[inline(always)]
    fn sheared<S: Simd>(&self, corner: usize, ray: &ShearedRay<S>) -> [f32x4<S>; 3] {
        let [x, y, z] = ray.axes;
        let z = self.relative(corner, z, ray);
        [
            self.relative(corner, x, ray) - ray.shear[0] * z,
            self.relative(corner, y, ray) - ray.shear[1] * z,
            z,
        ]
    }

    /// One coordinate of a corner relative to the ray's origin.
    #[inline(always)]
    fn relative<S: Simd>(&self, corner: usize, axis: usize, ray: &ShearedRay<S>) -> f32x4<S> {
        let origin = ray.origin[axis];
        f32x4::load_array_ref(origin.simd, &self.corners[corner][axis]) - origin
    }

    /// Intersects a ray with all four triangles. Hits beyond `t_max` are left out; one at `t_max`
    /// is kept, for ties.
    #[inline(always)]
    pub(super) fn intersect<S: Simd>(&self, ray: &ShearedRay<S>, t_max: f32) -> PacketHits {
        let simd = ray.origin[0].simd;
        // Compute the edge functions in the sheared space.
        let [ax, ay, az] = self.sheared(0, ray);
        let [bx, by, bz] = self.sheared(1, ray);
        let [cx, cy, cz] = self.sheared(2, ray);
        let mut u = cx * by - cy * bx;
        let mut v = ax * cy - ay * cx;
        let mut w = bx * ay - by * ax;
        let zero = f32x4::splat(simd, 0.0);
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        // Accept edge functions of one sign; NaN (an unused lane, a broken ray) compares false.
        let mut inside = least.simd_ge(zero) | most.simd_le(zero);
        if inside.to_bitmask() == 0 {
            return PacketHits { mask: 0, t: [0.0; 4], b1: [0.0; 4], b2: [0.0; 4] };
        }
        // Decide in f64 where an edge function is zero.
        let undecided = least.simd_eq(zero) | most.simd_eq(zero);
        if undecided.to_bitmask() != 0 {
            u = decide_in_f64(u, [cx, by, cy, bx]);
            v = decide_in_f64(v, [ax, cy, ay, cx]);
            w = decide_in_f64(w, [bx, ay, by, ax]);
            let (least, most) = (u.min(v).min(w), u.max(v).max(w));
            inside = least.simd_ge(zero) | most.simd_le(zero);
        }
        // Compute the distance and the barycentrics.
        let det = u + v + w;
        let inverse = f32x4::splat(simd, 1.0) / det;
        let t = (u * az + v * bz + w * cz) * ray.shear[2] * inverse;
        let ahead = t.simd_gt(zero) & t.simd_le(f32x4::splat(simd, t_max));
        let valid = inside & ahead & !det.simd_eq(zero);
        PacketHits {
            mask: valid.to_bitmask() as u32,
            t: t.into(),
            b1: (v * inverse).into(),
            b2: (w * inverse).into(),
        }
    }
}

/// Computes `a * b - c * d` in f64 in lanes whose f32 result is zero. The products are exact in
/// f64, so the sign is right. Other lanes keep their result, which so never depends on the
/// triangles that share the packet.
#[cold]
fn decide_in_f64<S: Simd>(rounded: f32x4<S>, [a, b, c, d]: [f32x4<S>; 4]) -> f32x4<S> {
    let exact = |i: usize| (f64::from(a[i]) * f64::from(b[i]) - f64::from(c[i]) * f64::from(d[i])) as f32;
    f32x4::from_fn(rounded.simd, |i| if rounded[i] == 0.0 { exact(i) } else { rounded[i] })
}
