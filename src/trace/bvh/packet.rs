//! Four triangles tested at once, watertight.
//!
//! Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2013. The ray is sheared to the +z axis
//! of a permuted space; two triangles that share an edge compute that edge's sign from the same numbers, so a ray
//! cannot pass between them. Where a sign is exactly zero it is decided in f64, as in the paper. We differ: the
//! corners are tested four triangles at a time, and winding is not swapped with the axes (both sides are hit).

use super::Hit;
use crate::math::Ray;
use glam::Vec3;
use wide::f32x4;

/// Corners of up to four triangles, transposed: `corners[corner][axis][lane]`.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug)]
pub(super) struct TrianglePacket {
    corners: [[[f32; 4]; 3]; 3],
    triangles: [u32; 4],
}

const _: () = assert!(size_of::<TrianglePacket>() == 160);

/// A ray prepared once for all triangles it will meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShearedRay {
    origin: [f32x4; 3],
    /// The permuted axes; the last is the direction's largest.
    axes: [usize; 3],
    shear: [f32x4; 3],
}

impl ShearedRay {
    pub(super) fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let z = largest_axis(d);
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let inverse = 1.0 / d[z];
        Self {
            origin: ray.origin.to_array().map(f32x4::splat),
            axes: [x, y, z],
            shear: [d[x] * inverse, d[y] * inverse, inverse].map(f32x4::splat),
        }
    }
}

/// The axis along which a direction is largest.
#[inline(always)]
pub(super) fn largest_axis(d: [f32; 3]) -> usize {
    let magnitude = d.map(f32::abs);
    if magnitude[0] > magnitude[1] {
        if magnitude[0] > magnitude[2] { 0 } else { 2 }
    } else if magnitude[1] > magnitude[2] {
        1
    } else {
        2
    }
}

/// What the test of a packet leaves: which lanes are hit, and where.
pub(super) struct PacketHits {
    /// Bit per lane.
    pub(super) mask: u32,
    t: [f32; 4],
    b1: [f32; 4],
    b2: [f32; 4],
}

impl PacketHits {
    pub(super) fn hit(&self, lane: usize, packet: &TrianglePacket) -> Hit {
        Hit { t: self.t[lane], triangle: packet.triangles[lane], b1: self.b1[lane], b2: self.b2[lane] }
    }
}

/// Where a ray meets one triangle, by the arithmetic of the hierarchy: the same bits.
pub(crate) fn intersect_triangle(ray: &Ray, triangle: u32, corners: [Vec3; 3]) -> Option<Hit> {
    let mut packet = TrianglePacket::EMPTY;
    packet.set(0, triangle, corners);
    let hits = packet.intersect(&ShearedRay::new(ray), ray.t_max);
    (hits.mask & 1 != 0).then(|| hits.hit(0, &packet))
}

impl TrianglePacket {
    /// Lanes of NaN corners are never hit.
    pub(super) const EMPTY: Self = Self { corners: [[[f32::NAN; 4]; 3]; 3], triangles: [u32::MAX; 4] };

    pub(super) fn set(&mut self, lane: usize, triangle: u32, corners: [Vec3; 3]) {
        self.triangles[lane] = triangle;
        for (corner, position) in corners.iter().enumerate() {
            for axis in 0..3 {
                self.corners[corner][axis][lane] = position[axis];
            }
        }
    }

    /// `[corner][axis][lane]`; of absent triangles not a number.
    pub(super) fn corners(&self) -> &[[[f32; 4]; 3]; 3] {
        &self.corners
    }

    /// Which triangle a lane holds.
    pub(super) fn triangle(&self, lane: usize) -> u32 {
        self.triangles[lane]
    }

    /// Tests all four against a ray, hits beyond `t_max` left out (one at `t_max` is kept, for ties).
    #[inline(always)]
    pub(super) fn intersect(&self, ray: &ShearedRay, t_max: f32) -> PacketHits {
        let [kx, ky, kz] = ray.axes;
        let [sx, sy, sz] = ray.shear;
        let sheared = |corner: usize| {
            let c = &self.corners[corner];
            let z = f32x4::new(c[kz]) - ray.origin[kz];
            let x = f32x4::new(c[kx]) - ray.origin[kx] - sx * z;
            let y = f32x4::new(c[ky]) - ray.origin[ky] - sy * z;
            (x, y, z)
        };
        let (ax, ay, az) = sheared(0);
        let (bx, by, bz) = sheared(1);
        let (cx, cy, cz) = sheared(2);
        let mut u = cx * by - cy * bx;
        let mut v = ax * cy - ay * cx;
        let mut w = bx * ay - by * ax;
        let zero = f32x4::ZERO;
        let undecided = (u.simd_eq(zero) | v.simd_eq(zero) | w.simd_eq(zero)).to_bitmask();
        if undecided != 0 {
            u = decide_in_f64(u, [cx, by, cy, bx]);
            v = decide_in_f64(v, [ax, cy, ay, cx]);
            w = decide_in_f64(w, [bx, ay, by, ax]);
        }
        let negative = u.simd_lt(zero) | v.simd_lt(zero) | w.simd_lt(zero);
        let positive = u.simd_gt(zero) | v.simd_gt(zero) | w.simd_gt(zero);
        let det = u + v + w;
        let inside = !(negative & positive) & det.simd_ne(zero);
        if inside.to_bitmask() == 0 {
            return PacketHits { mask: 0, t: [0.0; 4], b1: [0.0; 4], b2: [0.0; 4] };
        }
        let inverse = f32x4::ONE / det;
        let t = (u * az + v * bz + w * cz) * sz * inverse;
        let ahead = t.simd_gt(zero) & t.simd_le(f32x4::splat(t_max));
        // A NaN (an empty lane, a broken ray) passes `inside` but not `ahead`.
        let valid = inside & ahead;
        PacketHits {
            mask: valid.to_bitmask(),
            t: t.to_array(),
            b1: (v * inverse).to_array(),
            b2: (w * inverse).to_array(),
        }
    }
}

/// `a * b - c * d` where the f32 result is zero: the products are exact in f64, so the sign is right. Other lanes keep
/// theirs, so that a result never depends on which triangles share a packet.
#[cold]
fn decide_in_f64(rounded: f32x4, factors: [f32x4; 4]) -> f32x4 {
    let rounded = rounded.to_array();
    let [a, b, c, d] = factors.map(f32x4::to_array);
    let exact = |i: usize| (f64::from(a[i]) * f64::from(b[i]) - f64::from(c[i]) * f64::from(d[i])) as f32;
    f32x4::new(std::array::from_fn(|i| if rounded[i] == 0.0 { exact(i) } else { rounded[i] }))
}
