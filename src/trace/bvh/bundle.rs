//! Any-hit traversal for a bundle of shadow rays: one walk down the tree serves all of them.
//!
//! A box bounds the directions of a bundle. A node is entered where some direction of that box, at
//! some distance, lies in the node's box. For each axis this is the slab test of one ray, with the
//! largest direction against the lower plane and the smallest against the upper one. It costs what
//! one ray costs, and because rounding is monotone it passes wherever the test of any single ray
//! passes. Triangles are tested by the arithmetic of single rays, so the results are those of
//! [`Bvh::any`].
//!
//! Source: interval traversal as in Boulos, Wald, Shirley, "Geometric and Arithmetic Culling
//! Methods for Entire Ray Packets", University of Utah 2006. We differ: directions are not
//! normalized to a plane for the box test, so the end of a segment needs no bound of its own. At a
//! leaf, the rays that meet its box are found first. Where they are few, as on small triangles,
//! they are tested one by one. Where they are many, triangles are culled by the planes through the
//! origin and their edges, and tested against eight rays at a time. Testing each triangle that the
//! bundle may meet against all rays was slower than single rays.

use super::bits::Bits;
use super::cone::{Beam, Cone, Lanes};
use super::node::{Child, Node};
use super::packet::{ShearedRay, TrianglePacket};
use super::ray_bundle::{MIN_RAYS, RayBundle, lane_values};
use super::rays::{LANES, SeenTriangle, Shear8};
use super::traverse::{Occluder, STACK, any_in_packet};
use super::{hit::Hit, slab::FAR_SLACK, tree::Bvh};
use arrayvec::ArrayVec;
use fearless_simd::{Simd, SimdBase, SimdMask, dispatch, f32x4, f32x8};

/// Largest number of rays for which a leaf is tested one ray at a time: this takes one step for
/// four triangles, the other way two steps per triangle. Not tuned.
const FEW_RAYS: u32 = 4;

/// Number of visited nodes after which a walk also tests inner nodes against every single ray.
/// Sixteen rays leave gaps between them, and most of many small boxes lie in the gaps. On pictures
/// of the gallery 32 took 10 % less time than never to test, 0 and 16 took 5 % less.
const NODES_UNTESTED: u32 = 32;

/// Decides which hits of a bundle's rays count.
pub trait Judge {
    /// True where a ray's hit counts. Called at most once for each ray and triangle, and no more
    /// once the ray is blocked.
    fn accepts(&mut self, ray: usize, hit: &Hit) -> bool;

    /// Decides for several rays at once: true where no hit with this triangle counts. Bit i of
    /// `met` stands for ray `first + i`. Must do for these rays what [`Self::accepts`] would,
    /// which is then not called. Not asked where rays are tested one by one.
    #[inline(always)]
    fn lets_pass(&mut self, _triangle: u32, _first: usize, _met: u32) -> bool {
        false
    }
}

impl<F: FnMut(usize, &Hit) -> bool> Judge for F {
    #[inline(always)]
    fn accepts(&mut self, ray: usize, hit: &Hit) -> bool {
        self(ray, hit)
    }
}

impl Bvh {
    /// Returns a bit per ray that meets, before its end, a triangle whose hit `judge` accepts.
    pub fn any_in_bundle(&self, bundle: &RayBundle, judge: impl Judge) -> u32 {
        dispatch!(self.level, simd => self.bundle_of_any_axes::<_, true>(simd, bundle, judge))
    }

    /// [`Self::any_in_bundle`] with every hit accepted.
    pub fn any_at_all_in_bundle(&self, bundle: &RayBundle) -> u32 {
        dispatch!(self.level, simd => self.bundle_of_any_axes::<_, false>(simd, bundle, |_: usize, _: &Hit| true))
    }

    /// Traces the rays of each largest axis on their own, because they are sheared along it. `ASKS`
    /// is false where every hit is accepted.
    #[inline(always)]
    fn bundle_of_any_axes<S: Simd, const ASKS: bool>(
        &self,
        simd: S,
        bundle: &RayBundle,
        mut judge: impl Judge,
    ) -> u32 {
        let lanes = Lanes::new(simd, bundle);
        let mut blocked = 0;
        for axis in 0..3 {
            // Select the rays whose largest axis this is.
            let rays = lanes.along[axis];
            if rays == 0 || self.root == Child::NONE {
                continue;
            }
            // Trace few or diverging rays one by one, others together.
            let cone = Cone::new(simd, &lanes, axis, rays);
            if (rays.count_ones() as usize) < MIN_RAYS || cone.is_wide {
                blocked |= self.one_by_one::<_, ASKS>(simd, bundle, rays, &mut judge);
            } else {
                let mut walk = Walk::new(simd, self, bundle, &lanes, cone, (axis, rays));
                walk.run::<ASKS>(&mut judge);
                blocked |= rays & !walk.open;
            }
        }
        blocked
    }

    /// Traces some rays of a bundle one by one.
    #[inline(always)]
    fn one_by_one<S: Simd, const ASKS: bool>(
        &self,
        simd: S,
        bundle: &RayBundle,
        rays: u32,
        judge: &mut impl Judge,
    ) -> u32 {
        let (mut occluder, mut blocked) = (Occluder::default(), 0);
        for ray in Bits(rays) {
            let accept = |hit: &Hit| !ASKS || judge.accepts(ray, hit);
            blocked |= u32::from(self.walk_any(simd, &bundle.ray(ray), &mut occluder, accept)) << ray;
        }
        blocked
    }
}

/// A traversal for the rays of one largest axis.
struct Walk<'a, S: Simd> {
    simd: S,
    bvh: &'a Bvh,
    /// Largest axis of the directions.
    axis: usize,
    /// Bit per ray that nothing has blocked so far.
    open: u32,
    /// Shear of the rays, by half of the bundle.
    shear: [Shear8<S>; 2],
    /// One over the directions, by half and axis.
    inverse: [[f32x8<S>; 3]; 2],
    t_max: [f32x8<S>; 2],
    /// Bounds of the rays against boxes.
    cone: Cone,
    /// Bounds of the rays against triangles.
    beam: Beam,
    origin: [f32; 3],
}

impl<'a, S: Simd> Walk<'a, S> {
    /// Prepares the rays `rays` (a bit each), whose largest axis is `axis`.
    #[inline(always)]
    fn new(
        simd: S,
        bvh: &'a Bvh,
        bundle: &RayBundle,
        lanes: &Lanes<S>,
        cone: Cone,
        (axis, rays): (usize, u32),
    ) -> Self {
        let shear = [shear(simd, bundle, axis, 0), shear(simd, bundle, axis, 1)];
        Self {
            simd,
            bvh,
            axis,
            open: rays,
            inverse: [inverse(simd, lanes, 0), inverse(simd, lanes, 1)],
            t_max: lanes.t_max,
            cone,
            beam: Beam::new(simd, &shear, axis, rays),
            shear,
            origin: bundle.origin.to_array(),
        }
    }

    /// Traverses the tree until every ray is blocked. Children are visited in memory order, as for
    /// single rays.
    #[inline(always)]
    fn run<const ASKS: bool>(&mut self, judge: &mut impl Judge) {
        let mut stack = ArrayVec::<u32, STACK>::new();
        match self.bvh.root.packet() {
            Some(packet) => self.leaf::<ASKS>(&self.bvh.packets[packet], self.open, judge),
            None => stack.push(self.bvh.root.0),
        }
        let origin = [
            f32x8::splat(self.simd, self.origin[0]),
            f32x8::splat(self.simd, self.origin[1]),
            f32x8::splat(self.simd, self.origin[2]),
        ];
        let mut visited = 0;
        while let Some(inner) = stack.pop() {
            let node = &self.bvh.nodes[inner as usize];
            visited += 1;
            // Test the children's boxes against all rays at once.
            for lane in Bits(self.cone.meets(self.simd, node, &origin)) {
                let packet = node.children[lane].packet();
                // Test a leaf, or a node of a long walk, against each ray.
                let tests_rays = packet.is_some() || visited > NODES_UNTESTED;
                let rays = if tests_rays { self.rays_through(node, lane, &origin) } else { !0 };
                if rays & self.open == 0 {
                    continue;
                }
                // Stack an inner node, test the triangles of a leaf.
                let Some(packet) = packet else {
                    stack.push(node.children[lane].0);
                    continue;
                };
                self.leaf::<ASKS>(&self.bvh.packets[packet], rays & self.open, judge);
                if self.open == 0 {
                    return;
                }
            }
        }
    }

    /// Returns a bit per ray that meets the box of a child: the slab test with rays and boxes
    /// exchanged.
    #[inline(always)]
    fn rays_through(&self, node: &Node, lane: usize, origin: &[f32x8<S>; 3]) -> u32 {
        let simd = self.simd;
        let mut rays = 0;
        for half in 0..2 {
            let mut enter = f32x8::splat(simd, 0.0);
            let mut leave = f32x8::splat(simd, f32::INFINITY);
            for (axis, (&inverse, &origin)) in self.inverse[half].iter().zip(origin).enumerate() {
                let lower = (f32x8::splat(simd, node.bounds[2 * axis][lane]) - origin) * inverse;
                let upper = (f32x8::splat(simd, node.bounds[2 * axis + 1][lane]) - origin) * inverse;
                (enter, leave) = (enter.max(lower.min(upper)), leave.min(lower.max(upper)));
            }
            let leave = (leave * f32x8::splat(simd, FAR_SLACK)).min(self.t_max[half]);
            rays |= (enter.simd_le(leave).to_bitmask() as u32) << (half * LANES);
        }
        rays
    }

    /// Tests the triangles of a leaf against some rays.
    #[inline(always)]
    fn leaf<const ASKS: bool>(&mut self, packet: &TrianglePacket, rays: u32, judge: &mut impl Judge) {
        if rays.count_ones() <= FEW_RAYS {
            return self.packet::<ASKS>(packet, rays, judge);
        }
        // Cull triangles by the beam of the rays.
        let [a, b, c] = packet.corners();
        let corners = [self.relative(a), self.relative(b), self.relative(c)];
        // Test each remaining triangle against eight rays at a time.
        for lane in Bits(self.beam.meets_triangles(self.simd, &corners)) {
            let corner = |k: usize| [0, 1, 2].map(|axis| corners[k][axis][lane]);
            let corners = [corner(0), corner(1), corner(2)];
            self.triangle::<ASKS>(corners, packet.triangle(lane), rays, judge);
        }
    }

    /// Tests a packet of triangles against some rays, one ray at a time.
    #[inline(always)]
    fn packet<const ASKS: bool>(&mut self, packet: &TrianglePacket, rays: u32, judge: &mut impl Judge) {
        for ray in Bits(rays) {
            let (half, lane) = (ray / LANES, ray % LANES);
            let Shear8 { x, y, z } = &self.shear[half];
            let sheared =
                ShearedRay::from_shear(self.simd, self.origin, self.axis, [x[lane], y[lane], z[lane]]);
            let accept = &mut |hit: &Hit| !ASKS || judge.accepts(ray, hit);
            if any_in_packet(packet, &sheared, self.t_max[half][lane], accept) {
                self.open &= !(1 << ray);
            }
        }
    }

    /// A corner of four triangles relative to the rays' origin.
    #[inline(always)]
    fn relative(&self, corner: &[[f32; 4]; 3]) -> [f32x4<S>; 3] {
        let (simd, origin) = (self.simd, &self.origin);
        [
            f32x4::load_array_ref(simd, &corner[0]) - f32x4::splat(simd, origin[0]),
            f32x4::load_array_ref(simd, &corner[1]) - f32x4::splat(simd, origin[1]),
            f32x4::load_array_ref(simd, &corner[2]) - f32x4::splat(simd, origin[2]),
        ]
    }

    /// Tests one triangle, corners relative to the origin, against some rays. Rays that miss the
    /// leaf's box are left out, because a single ray would not be tested either.
    #[inline(always)]
    fn triangle<const ASKS: bool>(
        &mut self,
        corners: [[f32; 3]; 3],
        triangle: u32,
        rays: u32,
        judge: &mut impl Judge,
    ) {
        let seen = SeenTriangle::<f32x8<S>>::new(self.simd, corners, self.axis);
        let zero = f32x8::splat(self.simd, 0.0);
        for half in 0..2 {
            let open = (rays & self.open) >> (half * LANES) & 0xff;
            if open == 0 {
                continue;
            }
            // Find the open rays that the triangle lies in front of.
            let Some(hits) = seen.intersect(self.simd, &self.shear[half]) else { continue };
            let met = hits.inside & hits.t.simd_gt(zero) & hits.t.simd_lt(self.t_max[half]);
            let mut met = met.to_bitmask() as u32 & open;
            // Ask whether each hit counts.
            if ASKS && met != 0 {
                if judge.lets_pass(triangle, half * LANES, met) {
                    continue;
                }
                let [b1, b2] = hits.barycentrics();
                for lane in Bits(met) {
                    let hit = Hit { t: hits.t[lane], triangle, b1: b1[lane], b2: b2[lane] };
                    if !judge.accepts(half * LANES + lane, &hit) {
                        met &= !(1 << lane);
                    }
                }
            }
            self.open &= !(met << (half * LANES));
        }
    }
}

/// The shear of half a bundle along an axis.
#[inline(always)]
fn shear<S: Simd>(simd: S, bundle: &RayBundle, axis: usize, which: usize) -> Shear8<S> {
    let [x, y, z] = [(axis + 1) % 3, (axis + 2) % 3, axis];
    let inverse = f32x8::splat(simd, 1.0) / lane_values(simd, &bundle.directions[z], which);
    Shear8 {
        x: lane_values(simd, &bundle.directions[x], which) * inverse,
        y: lane_values(simd, &bundle.directions[y], which) * inverse,
        z: inverse,
    }
}

/// One over the directions of half a bundle.
#[inline(always)]
fn inverse<S: Simd>(simd: S, lanes: &Lanes<S>, which: usize) -> [f32x8<S>; 3] {
    let ([x, y, z], one) = (lanes.safe_directions[which], f32x8::splat(simd, 1.0));
    [one / x, one / y, one / z]
}
