//! Prepares the triangles of a packet for filling: where they may be seen in a bin, their edge
//! functions, and their disparity.

use super::lens::{BIN_SIDE, BinView, UNIT};
use crate::trace::bvh::{TrianglePacket, cross, dot, sub};
use fearless_simd::{Simd, SimdBase, SimdMask, f32x4, mask32x4, prelude::*};
use glam::Vec3;

/// Relative error of the disparity above which a triangle settles nothing.
const MAX_DEPTH_ERROR: f32 = 1.0 / 16.0;

/// Relative error of the disparity below which a hit certainly lies on its triangle: less than the
/// slack of that check, a thousandth, with the rounding of the check itself.
const MAX_UNCHECKED_ERROR: f32 = 1.0 / 1200.0;

/// Error of a projected corner, in pixels, from which on a triangle may cover the whole bin.
const MAX_PIXEL_ERROR: f32 = 0.25;

/// Least bound of an edge function's error, in scene units squared, and least volume, in scene
/// units cubed, for which errors are relative: products are then so far above the least normal
/// number that what underflow loses is below their rounding error.
const LEAST_EDGE_ERROR: f32 = f32::MIN_POSITIVE * 1e12;
const LEAST_VOLUME: f32 = f32::MIN_POSITIVE * 1e18;

/// A vector in all lanes.
type Wide<S> = [f32x4<S>; 3];

/// A triangle prepared for filling a bin. Functions of the picture are given by their value in the
/// middle of the bin and their change by pixel: three edge functions, less their error bound, and
/// an upper bound of the disparity.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub(super) middle: [f32; 4],
    pub(super) dx: [f32; 4],
    pub(super) dy: [f32; 4],
    /// A ray may meet the triangle where no edge function is below this number.
    pub(super) lowest: f32,
    /// Lower bound of the disparity, as a share of the upper bound.
    pub(super) surely: f32,
}

/// The triangles of a packet, prepared.
pub(super) struct Facets {
    /// Bit per triangle whose edge functions and disparity have useful bounds.
    pub(super) certain: u32,
    /// Bit per triangle whose hits must be checked where the scene has needles.
    pub(super) checked: u32,
    middle: [[f32; 4]; 4],
    dx: [[f32; 4]; 4],
    dy: [[f32; 4]; 4],
    lowest: [f32; 4],
    surely: [f32; 4],
}

impl Facets {
    /// One of the triangles.
    #[inline(always)]
    pub(super) fn facet(&self, lane: usize) -> Facet {
        let pick = |of: &[[f32; 4]; 4]| [of[0][lane], of[1][lane], of[2][lane], of[3][lane]];
        Facet {
            middle: pick(&self.middle),
            dx: pick(&self.dx),
            dy: pick(&self.dy),
            lowest: self.lowest[lane],
            surely: self.surely[lane],
        }
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, x: f32) -> f32x4<S> {
    f32x4::splat(simd, x)
}

#[inline(always)]
fn splat3<S: Simd>(simd: S, v: Vec3) -> Wide<S> {
    [splat(simd, v.x), splat(simd, v.y), splat(simd, v.z)]
}

/// Largest magnitude of all components of three vectors.
#[inline(always)]
fn max_norm<S: Simd>(v: [&Wide<S>; 3]) -> f32x4<S> {
    let x = v[0][0].abs().max(v[1][0].abs()).max(v[2][0].abs());
    let y = v[0][1].abs().max(v[1][1].abs()).max(v[2][1].abs());
    let z = v[0][2].abs().max(v[1][2].abs()).max(v[2][2].abs());
    x.max(y).max(z)
}

#[inline(always)]
fn min3<S: Simd>(v: [f32x4<S>; 3]) -> f32x4<S> {
    v[0].min(v[1]).min(v[2])
}

#[inline(always)]
fn max3<S: Simd>(v: [f32x4<S>; 3]) -> f32x4<S> {
    v[0].max(v[1]).max(v[2])
}

/// A corner of each triangle, relative to the eye.
#[inline(always)]
fn relative<S: Simd>(simd: S, packet: &TrianglePacket, corner: usize, eye: &Wide<S>) -> Wide<S> {
    let [x, y, z] = &packet.corners()[corner];
    [
        f32x4::load_array_ref(simd, x) - eye[0],
        f32x4::load_array_ref(simd, y) - eye[1],
        f32x4::load_array_ref(simd, z) - eye[2],
    ]
}

/// The pixels that triangles may cover, by axis of the picture: first and last.
struct Extent<S: Simd> {
    first: [f32x4<S>; 2],
    last: [f32x4<S>; 2],
    /// Triangles that contain the centre of a pixel of the bin within their bounds.
    seen: mask32x4<S>,
}

/// Bounds the pixels that triangles of corners `corners` may cover.
#[inline(always)]
fn extent<S: Simd>(simd: S, view: &BinView, corners: &[Wide<S>; 3], magnitude: f32x4<S>) -> Extent<S> {
    let (zero, half) = (splat(simd, 0.0), splat(simd, 0.5));
    let end = splat(simd, (BIN_SIDE - 1) as f32);
    let [x, y, z] = view.rows;
    // Project the corners.
    let depth = along(simd, z, corners);
    let one = splat(simd, 1.0);
    let inverse = [one / depth[0], one / depth[1], one / depth[2]];
    let error = magnitude * max3(inverse) * splat(simd, view.pixel_error);
    // A triangle that reaches behind the eye may cover the whole bin.
    let is_ahead = min3(depth).simd_gt(zero) & error.simd_lt(splat(simd, MAX_PIXEL_ERROR));
    let [left, right] = range(along(simd, x, corners), inverse);
    let [top, bottom] = range(along(simd, y, corners), inverse);
    let (before, after) = (error + half, error - half);
    let first = [
        is_ahead.select((left - before).ceil().max(zero), zero),
        is_ahead.select((top - before).ceil().max(zero), zero),
    ];
    let last = [
        is_ahead.select((right + after).floor().min(end), end),
        is_ahead.select((bottom + after).floor().min(end), end),
    ];
    Extent { first, last, seen: first[0].simd_le(last[0]) & first[1].simd_le(last[1]) }
}

/// The products of a vector with the corners.
#[inline(always)]
fn along<S: Simd>(simd: S, row: Vec3, corners: &[Wide<S>; 3]) -> [f32x4<S>; 3] {
    let row = splat3(simd, row);
    [dot(&row, &corners[0]), dot(&row, &corners[1]), dot(&row, &corners[2])]
}

/// The least and the largest of three quotients, given by numerators and inverse denominators.
#[inline(always)]
fn range<S: Simd>(a: [f32x4<S>; 3], inverse: [f32x4<S>; 3]) -> [f32x4<S>; 2] {
    let at = [a[0] * inverse[0], a[1] * inverse[1], a[2] * inverse[2]];
    [min3(at), max3(at)]
}

/// The edge functions and the disparity of triangles.
struct Functions<S: Simd> {
    planes: [Wide<S>; 3],
    /// One or minus one, so that the edge functions are positive inside; zero without a bound.
    sign: f32x4<S>,
    normal: Wide<S>,
    /// Factor from the product with the normal to the upper bound of the disparity.
    scale: f32x4<S>,
    certain: mask32x4<S>,
}

impl<S: Simd> Functions<S> {
    /// Their values for a direction.
    #[inline(always)]
    fn along(&self, simd: S, direction: Vec3) -> [f32x4<S>; 4] {
        let d = splat3(simd, direction);
        let disparity = dot(&self.normal, &d) * self.scale;
        [
            dot(&self.planes[0], &d) * self.sign,
            dot(&self.planes[1], &d) * self.sign,
            dot(&self.planes[2], &d) * self.sign,
            self.certain.select(disparity, splat(simd, 0.0)),
        ]
    }
}

/// Where the triangles of a packet may be seen in a bin.
pub(super) struct Bounds<S: Simd> {
    /// Bit per triangle that contains the centre of a pixel within its bounds.
    pub(super) seen: u32,
    /// Upper bounds of the disparity at which any ray meets them.
    pub(super) nearest: [f32; 4],
    corners: [Wide<S>; 3],
    magnitude: f32x4<S>,
    columns: [[f32; 4]; 2],
    rows: [[f32; 4]; 2],
}

impl<S: Simd> Bounds<S> {
    /// Bounds the triangles of a packet.
    #[inline(always)]
    pub(super) fn new(simd: S, view: &BinView, packet: &TrianglePacket) -> Self {
        let eye = splat3(simd, view.eye);
        let a = relative(simd, packet, 0, &eye);
        let (b, c) = (relative(simd, packet, 1, &eye), relative(simd, packet, 2, &eye));
        let corners = [a, b, c];
        let magnitude = max_norm([&a, &b, &c]);
        let extent = extent(simd, view, &corners, magnitude);
        let is_there = a[0].simd_eq(a[0]);
        Self {
            seen: (extent.seen & is_there).to_bitmask() as u32,
            nearest: nearest(simd, view, &corners).to_array(),
            corners,
            magnitude,
            columns: [extent.first[0].to_array(), extent.last[0].to_array()],
            rows: [extent.first[1].to_array(), extent.last[1].to_array()],
        }
    }

    /// First and last column and row of a triangle.
    #[inline(always)]
    pub(super) fn pixels(&self, lane: usize) -> [[usize; 2]; 2] {
        let [columns, rows] = [&self.columns, &self.rows];
        [
            [columns[0][lane] as u32 as usize, columns[1][lane] as u32 as usize],
            [rows[0][lane] as u32 as usize, rows[1][lane] as u32 as usize],
        ]
    }
}

/// Prepares the triangles of a packet for a bin.
#[inline(always)]
pub(super) fn facets<S: Simd>(simd: S, view: &BinView, bounds: &Bounds<S>) -> Facets {
    let [a, b, c] = &bounds.corners;
    let magnitude = bounds.magnitude;
    // Compute the planes through the eye and the edges, the plane of the triangle, and the volume.
    let (ab, ac, bc) = (sub(b, a), sub(c, a), sub(c, b));
    let length = max_norm([&ab, &ac, &bc]);
    let planes = [cross(b, &bc), cross(&ac, a), cross(a, &ab)];
    let normal = cross(&ab, &ac);
    let volume = dot(&normal, a);
    // Bound the errors.
    let edge_error = magnitude * length * splat(simd, view.edge_error);
    let inverse = splat(simd, 1.0) / volume;
    let steepness = normal[0].abs() + normal[1].abs() + normal[2].abs();
    let products = length * length * length * splat(simd, 53.0 * UNIT);
    let depth_error = (magnitude * steepness * splat(simd, view.depth_error) + products) * inverse.abs()
        + splat(simd, 32.0 * UNIT);
    let size = volume.abs();
    let has_edges = length.simd_ge(magnitude * splat(simd, 400.0 * UNIT))
        & edge_error.simd_gt(splat(simd, LEAST_EDGE_ERROR))
        & (magnitude * edge_error).simd_lt(splat(simd, f32::MAX));
    let certain = has_edges
        & depth_error.simd_le(splat(simd, MAX_DEPTH_ERROR))
        & size.simd_ge(magnitude * edge_error * splat(simd, 8.0))
        & size.simd_gt(splat(simd, LEAST_VOLUME));
    // Evaluate them in the middle of the bin, and by pixel.
    let sign = splat(simd, 1.0).copysign(volume);
    let sign = has_edges.select(sign, splat(simd, 0.0));
    let above = depth_error + splat(simd, 1.0);
    let scale = inverse * above;
    let functions = Functions { planes, sign, normal, scale, certain };
    let (dx, dy) = (functions.along(simd, view.dx), functions.along(simd, view.dy));
    let [e0, e1, e2, disparity] = functions.along(simd, view.middle);
    let error = has_edges.select(edge_error, splat(simd, 0.0));
    let disparity = certain.select(disparity, f32x4::load_array(simd, bounds.nearest));
    Facets {
        certain: certain.to_bitmask() as u32,
        checked: depth_error.simd_gt(splat(simd, MAX_UNCHECKED_ERROR)).to_bitmask() as u32,
        middle: [
            (e0 - error).to_array(),
            (e1 - error).to_array(),
            (e2 - error).to_array(),
            disparity.to_array(),
        ],
        dx: [dx[0].to_array(), dx[1].to_array(), dx[2].to_array(), dx[3].to_array()],
        dy: [dy[0].to_array(), dy[1].to_array(), dy[2].to_array(), dy[3].to_array()],
        lowest: (error * splat(simd, -2.0)).to_array(),
        surely: (splat(simd, 1.0 - 8.0 * UNIT) - depth_error * splat(simd, 2.0)).to_array(),
    }
}

/// Upper bounds of the disparity at which any ray of the bin meets triangles.
#[inline(always)]
fn nearest<S: Simd>(simd: S, view: &BinView, corners: &[Wide<S>; 3]) -> f32x4<S> {
    let infinity = splat(simd, f32::INFINITY);
    let mut least = infinity;
    for reach in &view.reaches {
        let along = [corners[0][reach.axis], corners[1][reach.axis], corners[2][reach.axis]];
        let scale = splat(simd, reach.scale);
        least = least.min(min3([along[0] * scale, along[1] * scale, along[2] * scale]));
    }
    let disparity = splat(simd, 1.0 + 64.0 * UNIT) / least;
    least.simd_gt(splat(simd, 0.0)).select(disparity, infinity)
}
