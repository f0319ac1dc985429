//! Nearest hits of a tile of rays that share their origin: what eight by eight neighbouring pixels see.
//!
//! The tree is walked once for the tile's frustum instead of once for each ray; a triangle that the frustum meets is
//! tested against eight rays at a time. Hits are those of [`Bvh::closest`] bit for bit, because each ray meets each
//! triangle by the same arithmetic, and culling keeps a margin of half a pixel.
//!
//! Source: frustum traversal as in Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005. We
//! differ: one level, and triangles are culled by the planes through the eye and their edges as well.

use super::hit::{Hit, NO_TRIANGLE};
use super::node::{Child, Node};
use super::packet::{TrianglePacket, largest_axis};
use super::rays8::{LANES, SeenTriangle, Shear8};
use super::traverse::{STACK, nearest_first};
use super::tree::Bvh;
use super::vectors::{cross, dot, sub};
use crate::math::Ray;
use arrayvec::ArrayVec;
use fearless_simd::{Simd, SimdBase, SimdMask, dispatch, f32x4, f32x8, prelude::*, u32x8};
use glam::Vec3;

/// Side of a tile in pixels.
pub const TILE_SIDE: usize = 8;

/// Rays of a tile.
pub const TILE_RAYS: usize = TILE_SIDE * TILE_SIDE;

/// The same as [`super::traverse::FARTHER`], from the other side.
const DEPTH_SLACK: f32 = 1.0 - 1e-5;

/// Rays from one eye through a square of the picture, row by row.
#[derive(Clone, Debug)]
pub struct RayTile {
    /// Common origin, scene space.
    pub origin: Vec3,
    /// Unit viewing axis: distances along the rays are depths along it.
    pub forward: Vec3,
    /// Directions, by axis; their component along `forward` is one.
    pub directions: [[f32; TILE_RAYS]; 3],
    /// Directions through the four corners of the tile, in order around it. They lie outside all rays by a margin.
    pub corners: [Vec3; 4],
}

impl RayTile {
    /// One of the rays.
    pub fn ray(&self, ray: usize) -> Ray {
        Ray::new(self.origin, Vec3::from(self.directions.each_ref().map(|of_axis| of_axis[ray])))
    }
}

/// What the rays of a tile meet.
#[derive(Clone, Debug)]
pub struct TileHits {
    /// Distance along each ray; infinite where nothing is met.
    pub t: [f32; TILE_RAYS],
    /// Triangle met; `NO_TRIANGLE` for none.
    pub triangle: [u32; TILE_RAYS],
    /// Barycentric weights of the second corner.
    pub b1: [f32; TILE_RAYS],
    /// Barycentric weights of the third corner.
    pub b2: [f32; TILE_RAYS],
}

impl TileHits {
    /// Nothing met.
    pub const NONE: Self = Self {
        t: [f32::INFINITY; TILE_RAYS],
        triangle: [NO_TRIANGLE; TILE_RAYS],
        b1: [0.0; TILE_RAYS],
        b2: [0.0; TILE_RAYS],
    };

    /// What one of the rays meets.
    pub fn hit(&self, ray: usize) -> Option<Hit> {
        let triangle = self.triangle[ray];
        (triangle != NO_TRIANGLE).then(|| Hit {
            t: self.t[ray],
            triangle,
            b1: self.b1[ray],
            b2: self.b2[ray],
        })
    }
}

impl Bvh {
    /// The nearest triangle along each ray of a tile for which `accept(ray, hit)` holds; `accepts_all` says that it
    /// always does, and spares the asking.
    pub fn closest_in_tile(
        &self,
        tile: &RayTile,
        accepts_all: bool,
        accept: impl Fn(usize, &Hit) -> bool,
        hits: &mut TileHits,
    ) {
        *hits = TileHits::NONE;
        if self.root == Child::NONE {
            return;
        }
        if accepts_all {
            dispatch!(self.level, simd => self.tile_of_any_axes::<_, false>(simd, tile, &accept, hits));
        } else {
            dispatch!(self.level, simd => self.tile_of_any_axes::<_, true>(simd, tile, &accept, hits));
        }
    }

    /// Rays are sheared along their largest axis; where that is not the same for all, one walk serves each axis.
    #[inline(always)]
    fn tile_of_any_axes<S: Simd, const ASKS: bool>(
        &self,
        simd: S,
        tile: &RayTile,
        accept: &impl Fn(usize, &Hit) -> bool,
        hits: &mut TileHits,
    ) {
        let (shear, present) = TileShear::new(tile);
        for axis in 0..3 {
            if present & (1 << axis) != 0 {
                // A distance of -1 takes a ray out: no hit is nearer.
                for ray in 0..TILE_RAYS {
                    if shear.largest[ray] as usize != axis {
                        hits.t[ray] = -hits.t[ray];
                    }
                }
                let mut walk = Walk { simd, bvh: self, tile, shear: &shear, axis, hits };
                walk.run::<ASKS>(accept);
                for ray in 0..TILE_RAYS {
                    if shear.largest[ray] as usize != axis {
                        hits.t[ray] = -hits.t[ray];
                    }
                }
            }
        }
    }
}

/// Woop's shear of each ray.
struct TileShear {
    /// The axis along which each direction is largest.
    largest: [u8; TILE_RAYS],
    x: [f32; TILE_RAYS],
    y: [f32; TILE_RAYS],
    z: [f32; TILE_RAYS],
}

impl TileShear {
    /// With a bit for each largest axis that occurs.
    #[inline(always)]
    fn new(tile: &RayTile) -> (Self, u32) {
        let zero = [0.0; TILE_RAYS];
        let mut shear = Self { largest: [0; TILE_RAYS], x: zero, y: zero, z: zero };
        let mut present = 0;
        let [dx, dy, dz] = &tile.directions;
        for ray in 0..TILE_RAYS {
            let d = [dx[ray], dy[ray], dz[ray]];
            let axis = largest_axis(d);
            let inverse = 1.0 / d[axis];
            shear.largest[ray] = axis as u8;
            shear.x[ray] = d[(axis + 1) % 3] * inverse;
            shear.y[ray] = d[(axis + 2) % 3] * inverse;
            shear.z[ray] = inverse;
            present |= 1 << axis;
        }
        (shear, present)
    }
}

/// One walk down the tree for the rays of one largest axis.
struct Walk<'a, S: Simd> {
    simd: S,
    bvh: &'a Bvh,
    tile: &'a RayTile,
    shear: &'a TileShear,
    axis: usize,
    hits: &'a mut TileHits,
}

/// A plane through the eye; what lies on its positive side may be met.
#[derive(Clone, Copy)]
struct SidePlane<S: Simd> {
    normal: [f32x4<S>; 3],
    wide_normal: [f32x8<S>; 3],
    /// Index into [`Node::bounds`] of the box's outermost plane along the normal, by axis.
    outermost: [usize; 3],
}

impl<S: Simd> Walk<'_, S> {
    #[inline(always)]
    fn run<const ASKS: bool>(&mut self, accept: &impl Fn(usize, &Hit) -> bool) {
        let simd = self.simd;
        let origin = self.tile.origin.to_array().map(|o| f32x4::splat(simd, o));
        let wide_origin = self.tile.origin.to_array().map(|o| f32x8::splat(simd, o));
        let sides = self.side_planes();
        let forward = side_plane(simd, -self.tile.forward);
        let mut farthest = self.farthest();
        let mut stack = ArrayVec::<(Child, f32), STACK>::new();
        stack.push((self.bvh.root, 0.0));
        while let Some((mut child, near)) = stack.pop() {
            if near > farthest {
                continue;
            }
            loop {
                if let Some(packet) = child.packet() {
                    self.leaf::<ASKS>(&self.bvh.packets[packet], origin, &sides, accept, &mut farthest);
                    break;
                }
                let node = &self.bvh.nodes[child.0 as usize];
                let near = extent(simd, node, &wide_origin, &forward);
                let near = -near * f32x8::splat(simd, DEPTH_SLACK);
                let mut met = near.simd_le(f32x8::splat(simd, farthest));
                for side in &sides {
                    met &= extent(simd, node, &wide_origin, side).simd_ge(f32x8::splat(simd, 0.0));
                }
                let mask = met.to_bitmask() as u32;
                if mask == 0 {
                    break;
                }
                child = nearest_first(node, mask, near.to_array(), &mut stack);
            }
        }
    }

    /// The planes between neighbouring corners, facing inwards.
    #[inline(always)]
    fn side_planes(&self) -> [SidePlane<S>; 4] {
        let c = &self.tile.corners;
        let inside = c[0] + c[1] + c[2] + c[3];
        std::array::from_fn(|i| {
            let normal = c[i].cross(c[(i + 1) % 4]);
            side_plane(self.simd, if normal.dot(inside) < 0.0 { -normal } else { normal })
        })
    }

    #[inline(always)]
    fn farthest(&self) -> f32 {
        let mut most = f32x8::splat(self.simd, 0.0);
        for row in self.hits.t.as_chunks::<8>().0 {
            most = most.max(f32x8::load_array_ref(self.simd, row));
        }
        most.to_array().into_iter().fold(0.0, f32::max)
    }

    #[inline(always)]
    fn leaf<const ASKS: bool>(
        &mut self,
        packet: &TrianglePacket,
        origin: [f32x4<S>; 3],
        sides: &[SidePlane<S>; 4],
        accept: &impl Fn(usize, &Hit) -> bool,
        farthest: &mut f32,
    ) {
        let corners = packet.corners().map(|c| {
            let p: [f32x4<S>; 3] = std::array::from_fn(|axis| f32x4::load_array_ref(self.simd, &c[axis]));
            [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]]
        });
        let mut mask = self.may_be_met(&corners, sides);
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            let corner = |k: usize| [0, 1, 2].map(|axis| corners[k][axis][lane]);
            let triangle = packet.triangle(lane);
            if self.triangle::<ASKS>([corner(0), corner(1), corner(2)], triangle, accept) {
                *farthest = self.farthest();
            }
        }
    }

    /// Bit per triangle of a packet that no plane through the eye separates from the tile: none of the tile's sides and
    /// none of the triangle's edges.
    #[inline(always)]
    fn may_be_met(&self, corners: &[[f32x4<S>; 3]; 3], sides: &[SidePlane<S>; 4]) -> u32 {
        let simd = self.simd;
        let zero = f32x4::splat(simd, 0.0);
        let [a, b, c] = corners;
        // A x (B - A) is A x B without its cancellation where the edge is short.
        let planes = [cross(a, &sub(b, a)), cross(b, &sub(c, b)), cross(c, &sub(a, c))];
        let facing = dot(&planes[0], c);
        let mut outside = facing.simd_ne(facing);
        for side in sides {
            let n = &side.normal;
            outside |= dot(n, a).max(dot(n, b)).max(dot(n, c)).simd_lt(zero);
        }
        let corner = |k: usize| self.tile.corners[k].to_array().map(|x| f32x4::splat(simd, x));
        let tile = [corner(0), corner(1), corner(2), corner(3)];
        let (front, back) = (facing.simd_gt(zero), facing.simd_lt(zero));
        for plane in &planes {
            let d = [dot(plane, &tile[0]), dot(plane, &tile[1]), dot(plane, &tile[2]), dot(plane, &tile[3])];
            let most = d[0].max(d[1]).max(d[2].max(d[3]));
            let least = d[0].min(d[1]).min(d[2].min(d[3]));
            outside |= (front & most.simd_lt(zero)) | (back & least.simd_gt(zero));
        }
        !outside.to_bitmask() as u32 & 0xf
    }

    /// Tests one triangle (corners relative to the eye) against all rays; true where some ray met it first.
    #[inline(always)]
    fn triangle<const ASKS: bool>(
        &mut self,
        corners: [[f32; 3]; 3],
        triangle: u32,
        accept: &impl Fn(usize, &Hit) -> bool,
    ) -> bool {
        let simd = self.simd;
        let seen = SeenTriangle::new(simd, corners, self.axis);
        let zero = f32x8::splat(simd, 0.0);
        let mut changed = false;
        for row in 0..TILE_RAYS / LANES {
            let at = row * LANES..(row + 1) * LANES;
            let load = |from: &[f32; TILE_RAYS]| f32x8::from_slice(simd, &from[at.clone()]);
            let shear = Shear8 { x: load(&self.shear.x), y: load(&self.shear.y), z: load(&self.shear.z) };
            let Some(met) = seen.intersect(&shear) else { continue };
            let t = met.t;
            let best = load(&self.hits.t);
            let known = u32x8::from_slice(simd, &self.hits.triangle[at.clone()]);
            let this = u32x8::splat(simd, triangle);
            let nearer = t.simd_lt(best) | (t.simd_eq(best) & this.simd_lt(known));
            let mut wins =
                met.inside & t.simd_gt(zero) & nearer & t.simd_lt(f32x8::splat(simd, f32::INFINITY));
            if !wins.any_true() {
                continue;
            }
            let [b1, b2] = met.barycentrics();
            if ASKS {
                let mut bits = 0u64;
                for lane in (0..LANES).filter(|&lane| wins.test(lane)) {
                    let hit = Hit { t: t[lane], triangle, b1: b1[lane], b2: b2[lane] };
                    bits |= u64::from(accept(row * LANES + lane, &hit)) << lane;
                }
                wins &= fearless_simd::mask32x8::from_bitmask(simd, bits);
            }
            wins.select(t, best).store_slice(&mut self.hits.t[at.clone()]);
            wins.select(this, known).store_slice(&mut self.hits.triangle[at.clone()]);
            wins.select(b1, load(&self.hits.b1)).store_slice(&mut self.hits.b1[at.clone()]);
            wins.select(b2, load(&self.hits.b2)).store_slice(&mut self.hits.b2[at.clone()]);
            changed = true;
        }
        changed
    }
}

#[inline(always)]
fn side_plane<S: Simd>(simd: S, normal: Vec3) -> SidePlane<S> {
    let n = normal.to_array();
    SidePlane {
        normal: n.map(|x| f32x4::splat(simd, x)),
        wide_normal: n.map(|x| f32x8::splat(simd, x)),
        outermost: std::array::from_fn(|axis| 2 * axis + usize::from(n[axis] > 0.0)),
    }
}

/// How far each child's box reaches along a plane's normal.
#[inline(always)]
fn extent<S: Simd>(simd: S, node: &Node, origin: &[f32x8<S>; 3], plane: &SidePlane<S>) -> f32x8<S> {
    let x = f32x8::load_array_ref(simd, &node.bounds[plane.outermost[0]]) - origin[0];
    let y = f32x8::load_array_ref(simd, &node.bounds[plane.outermost[1]]) - origin[1];
    let z = f32x8::load_array_ref(simd, &node.bounds[plane.outermost[2]]) - origin[2];
    x * plane.wide_normal[0] + y * plane.wide_normal[1] + z * plane.wide_normal[2]
}
