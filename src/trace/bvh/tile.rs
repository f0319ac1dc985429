//! Nearest hits of a tile of rays that share their origin: the primary rays of 8 x 8 pixels.
//!
//! The tree is traversed once for the tile's frustum instead of once for each ray; a triangle that
//! the frustum meets is tested against eight rays at a time. Hits have the bits of
//! [`Bvh::closest`], because each ray meets each triangle by the same arithmetic, and culling keeps
//! a margin of half a pixel.
//!
//! Source: frustum traversal as in Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm",
//! SIGGRAPH 2005. We differ: there is one level, and triangles are also culled by the planes
//! through the eye and their edges.

use super::bits::Bits;
use super::hit::{Hit, NO_TRIANGLE};
use super::node::{Child, Node};
use super::packet::{TrianglePacket, largest_axis};
use super::rays::{LANES, SeenTriangle, Shear8};
use super::traverse::{STACK, nearest_first};
use super::tree::Bvh;
use super::vectors::{cross, dot, sub};
use crate::math::Ray;
use arrayvec::ArrayVec;
use fearless_simd::{Simd, SimdBase, SimdMask, dispatch, f32x4, f32x8, prelude::*, u32x8};
use glam::Vec3;

/// Side of a tile in pixels.
pub const TILE_SIDE: usize = 8;

/// Number of rays of a tile.
pub const TILE_RAYS: usize = TILE_SIDE * TILE_SIDE;

/// Factor of a box's depth before it is compared with the farthest hit; see
/// [`super::traverse::FARTHER`].
const DEPTH_SLACK: f32 = 1.0 - 1e-5;

/// Rays from one eye through a square of pixels, row by row. Scene space.
#[derive(Clone, Debug)]
pub struct RayTile {
    /// Origin of all rays.
    pub origin: Vec3,
    /// Unit viewing axis. Distances along the rays are depths along it.
    pub forward: Vec3,
    /// Directions by axis; their component along `forward` is one.
    pub directions: [[f32; TILE_RAYS]; 3],
    /// Directions through the four corners of the tile, in order around it. All rays lie between
    /// them, by a margin of half a pixel.
    pub corners: [Vec3; 4],
}

impl RayTile {
    /// One of the rays.
    pub fn ray(&self, ray: usize) -> Ray {
        Ray::new(self.origin, Vec3::from(self.directions.each_ref().map(|of_axis| of_axis[ray])))
    }
}

/// The nearest hits of the rays of a tile.
#[derive(Clone, Debug)]
pub struct TileHits {
    /// Distance along each ray; infinite without a hit.
    pub t: [f32; TILE_RAYS],
    /// Triangle of each hit, or [`NO_TRIANGLE`].
    pub triangle: [u32; TILE_RAYS],
    /// Barycentric weights of the second corner.
    pub b1: [f32; TILE_RAYS],
    /// Barycentric weights of the third corner.
    pub b2: [f32; TILE_RAYS],
}

impl TileHits {
    /// No ray hits anything.
    pub const NONE: Self = Self {
        t: [f32::INFINITY; TILE_RAYS],
        triangle: [NO_TRIANGLE; TILE_RAYS],
        b1: [0.0; TILE_RAYS],
        b2: [0.0; TILE_RAYS],
    };

    /// The hit of one ray.
    pub fn hit(&self, ray: usize) -> Option<Hit> {
        let triangle = self.triangle[ray];
        (triangle != NO_TRIANGLE).then(|| Hit {
            t: self.t[ray],
            triangle,
            b1: self.b1[ray],
            b2: self.b2[ray],
        })
    }

    /// Replaces the hit of one ray.
    pub(in crate::trace) fn set(&mut self, ray: usize, hit: Option<Hit>) {
        let Hit { t, triangle, b1, b2 } =
            hit.unwrap_or(Hit { t: f32::INFINITY, triangle: NO_TRIANGLE, b1: 0.0, b2: 0.0 });
        (self.t[ray], self.triangle[ray], self.b1[ray], self.b2[ray]) = (t, triangle, b1, b2);
    }
}

impl Bvh {
    /// Writes the nearest hit along each ray of a tile for which `accept(ray, hit)` holds.
    /// `accepts_all` promises that it always holds: it is then not called.
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

    /// Traverses once for each largest axis that occurs, because rays are sheared along theirs.
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
                // Take rays of other axes out: no hit is nearer than a negative distance.
                // Two plain loops: a shared closure is not vectorised.
                for ray in 0..TILE_RAYS {
                    if shear.largest[ray] as usize != axis {
                        hits.t[ray] = -hits.t[ray];
                    }
                }
                // Traverse for the rays of this axis.
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

/// The shear of each ray (Woop).
struct TileShear {
    /// The axis along which each direction is largest.
    largest: [u8; TILE_RAYS],
    /// Shear of the next axis after the largest, cyclically.
    x: [f32; TILE_RAYS],
    /// Shear of the axis after that.
    y: [f32; TILE_RAYS],
    /// One over the largest component.
    z: [f32; TILE_RAYS],
}

impl TileShear {
    /// Returns the shear, and a bit for each largest axis that occurs.
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

/// A traversal for the rays of one largest axis.
struct Walk<'a, S: Simd> {
    simd: S,
    bvh: &'a Bvh,
    tile: &'a RayTile,
    shear: &'a TileShear,
    /// Largest axis of the directions.
    axis: usize,
    hits: &'a mut TileHits,
}

/// A plane through the eye. Only triangles that reach its positive side may be met.
#[derive(Clone, Copy)]
struct SidePlane<S: Simd> {
    /// Normal, for four triangles.
    normal: [f32x4<S>; 3],
    /// Normal, for eight boxes.
    wide_normal: [f32x8<S>; 3],
    /// By axis, the index into [`Node::bounds`] of the plane of a box that lies farthest along the
    /// normal.
    outermost: [usize; 3],
}

impl<S: Simd> Walk<'_, S> {
    /// Traverses the tree, nearest nodes first.
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
            // Skip a node that begins behind the farthest hit of the tile.
            if near > farthest {
                continue;
            }
            loop {
                // Test the triangles of a leaf.
                if let Some(packet) = child.packet() {
                    self.leaf::<ASKS>(&self.bvh.packets[packet], origin, &sides, accept, &mut farthest);
                    break;
                }
                let node = &self.bvh.nodes[child.0 as usize];
                // Find the children that begin before the farthest hit.
                let near = extent(simd, node, &wide_origin, &forward);
                let near = -near * f32x8::splat(simd, DEPTH_SLACK);
                let mut met = near.simd_le(f32x8::splat(simd, farthest));
                // Clip their boxes against the sides of the tile.
                for side in &sides {
                    met &= extent(simd, node, &wide_origin, side).simd_ge(f32x8::splat(simd, 0.0));
                }
                // Descend to the nearest and stack the others.
                let mask = met.to_bitmask() as u32;
                if mask == 0 {
                    break;
                }
                child = nearest_first(node, mask, near.to_array(), &mut stack);
            }
        }
    }

    /// Returns the planes through the eye and two neighbouring corners, facing inwards.
    #[inline(always)]
    fn side_planes(&self) -> [SidePlane<S>; 4] {
        let c = &self.tile.corners;
        let inside = c[0] + c[1] + c[2] + c[3];
        std::array::from_fn(|i| {
            let normal = c[i].cross(c[(i + 1) % 4]);
            side_plane(self.simd, if normal.dot(inside) < 0.0 { -normal } else { normal })
        })
    }

    /// Returns the distance of the farthest hit of the tile.
    #[inline(always)]
    fn farthest(&self) -> f32 {
        let mut most = f32x8::splat(self.simd, 0.0);
        for row in self.hits.t.as_chunks::<8>().0 {
            most = most.max(f32x8::load_array_ref(self.simd, row));
        }
        most.to_array().into_iter().fold(0.0, f32::max)
    }

    /// Tests the triangles of a leaf against all rays.
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
        // Cull triangles outside the tile, then test the others against eight rays at a time.
        for lane in Bits(self.may_be_met(&corners, sides)) {
            let corner = |k: usize| [0, 1, 2].map(|axis| corners[k][axis][lane]);
            let triangle = packet.triangle(lane);
            if self.triangle::<ASKS>([corner(0), corner(1), corner(2)], triangle, accept) {
                *farthest = self.farthest();
            }
        }
    }

    /// Returns a bit per triangle of a packet that no plane through the eye separates from the
    /// tile: neither a side of the tile nor a plane through an edge of the triangle.
    #[inline(always)]
    fn may_be_met(&self, corners: &[[f32x4<S>; 3]; 3], sides: &[SidePlane<S>; 4]) -> u32 {
        let simd = self.simd;
        let zero = f32x4::splat(simd, 0.0);
        let [a, b, c] = corners;
        // Compute the planes through the edges. A x (B - A) is A x B without its cancellation where
        // the edge is short.
        let planes = [cross(a, &sub(b, a)), cross(b, &sub(c, b)), cross(c, &sub(a, c))];
        let facing = dot(&planes[0], c);
        let mut outside = facing.simd_ne(facing);
        // Cull a triangle that lies outside a side of the tile.
        for side in sides {
            let n = &side.normal;
            outside |= dot(n, a).max(dot(n, b)).max(dot(n, c)).simd_lt(zero);
        }
        // Cull a triangle where the plane of an edge has the whole tile on its other side.
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

    /// Tests one triangle (corners relative to the eye) against all rays. True where it became the
    /// nearest hit of some ray.
    #[inline(always)]
    fn triangle<const ASKS: bool>(
        &mut self,
        corners: [[f32; 3]; 3],
        triangle: u32,
        accept: &impl Fn(usize, &Hit) -> bool,
    ) -> bool {
        let simd = self.simd;
        let seen = SeenTriangle::<f32x8<S>>::new(simd, corners, self.axis);
        let zero = f32x8::splat(simd, 0.0);
        let mut changed = false;
        for row in 0..TILE_RAYS / LANES {
            let at = row * LANES..(row + 1) * LANES;
            let load = |from: &[f32; TILE_RAYS]| f32x8::from_slice(simd, &from[at.clone()]);
            let shear = Shear8 { x: load(&self.shear.x), y: load(&self.shear.y), z: load(&self.shear.z) };
            // Intersect eight rays.
            let Some(met) = seen.intersect(simd, &shear) else { continue };
            // Keep hits nearer than the best; at one distance the lower index wins.
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
            // Ask whether each hit counts.
            if ASKS {
                let mut bits = 0u64;
                for lane in (0..LANES).filter(|&lane| wins.test(lane)) {
                    let hit = Hit { t: t[lane], triangle, b1: b1[lane], b2: b2[lane] };
                    bits |= u64::from(accept(row * LANES + lane, &hit)) << lane;
                }
                wins &= fearless_simd::mask32x8::from_bitmask(simd, bits);
            }
            // Store the hits.
            wins.select(t, best).store_slice(&mut self.hits.t[at.clone()]);
            wins.select(this, known).store_slice(&mut self.hits.triangle[at.clone()]);
            wins.select(b1, load(&self.hits.b1)).store_slice(&mut self.hits.b1[at.clone()]);
            wins.select(b2, load(&self.hits.b2)).store_slice(&mut self.hits.b2[at.clone()]);
            changed = true;
        }
        changed
    }
}

/// Prepares a plane through the eye for box and triangle tests.
#[inline(always)]
fn side_plane<S: Simd>(simd: S, normal: Vec3) -> SidePlane<S> {
    let n = normal.to_array();
    SidePlane {
        normal: n.map(|x| f32x4::splat(simd, x)),
        wide_normal: n.map(|x| f32x8::splat(simd, x)),
        outermost: std::array::from_fn(|axis| 2 * axis + usize::from(n[axis] > 0.0)),
    }
}

/// Returns how far each child's box reaches along a plane's normal, from the eye.
#[inline(always)]
fn extent<S: Simd>(simd: S, node: &Node, origin: &[f32x8<S>; 3], plane: &SidePlane<S>) -> f32x8<S> {
    let x = f32x8::load_array_ref(simd, &node.bounds[plane.outermost[0]]) - origin[0];
    let y = f32x8::load_array_ref(simd, &node.bounds[plane.outermost[1]]) - origin[1];
    let z = f32x8::load_array_ref(simd, &node.bounds[plane.outermost[2]]) - origin[2];
    x * plane.wide_normal[0] + y * plane.wide_normal[1] + z * plane.wide_normal[2]
}
