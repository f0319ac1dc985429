//! Traversal along one ray: nearest hit and any hit.

use super::bits::Bits;
use super::hit::{Hit, NO_TRIANGLE};
use super::node::{Child, MAX_DEPTH, Node, WIDTH};
use super::packet::{ShearedRay, TrianglePacket, intersect_triangle};
use super::{slab::SlabRay, tree::Bvh};
use crate::math::Ray;
use arrayvec::ArrayVec;
use fearless_simd::{Simd, dispatch};
use glam::Vec3;

/// Size of the traversal stack: at every level all children of a node but one, and the root.
pub(in crate::trace) const STACK: usize = (WIDTH - 1) * MAX_DEPTH + 1;

/// A box is skipped only where it begins beyond the nearest hit by this factor, far more than the
/// rounding of either distance. Without it the shape of the tree would decide which of two
/// triangles at one distance is found.
pub(in crate::trace) const FARTHER: f32 = 1.0 + 1e-5;

/// The packet of triangles that blocked the last of several similar rays.
#[derive(Clone, Copy, Debug, Default)]
pub struct Occluder(Option<u32>);

// Traversals are compiled once for every SIMD level, and everything they call must be inlined into
// them: a function left outside would be compiled for the baseline processor, and passing vectors
// to it costs more than its work.
impl Bvh {
    /// Returns the nearest hit along the ray for which `accept(hit)` holds.
    ///
    /// Among hits at one distance the triangle with the lowest index wins, so the result does not
    /// depend on the shape of the tree.
    #[inline]
    pub fn closest(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> Option<Hit> {
        dispatch!(self.level, simd => self.walk_closest(simd, ray, accept))
    }

    /// True where a hit for which `accept(hit)` holds lies before the ray's end.
    pub fn any(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> bool {
        self.any_near(ray, &mut Occluder::default(), accept)
    }

    /// [`Self::any`] for one of several similar rays: the packet that blocked the last one is
    /// tested first, and `occluder` is updated. The result does not depend on it.
    #[inline]
    pub fn any_near(&self, ray: &Ray, occluder: &mut Occluder, accept: impl FnMut(&Hit) -> bool) -> bool {
        dispatch!(self.level, simd => self.walk_any(simd, ray, occluder, accept))
    }

    /// Returns the hit of a ray with one triangle, whatever else the ray meets, with the bits of
    /// [`Self::closest`].
    pub fn on_triangle(&self, ray: &Ray, triangle: u32, corners: [Vec3; 3]) -> Option<Hit> {
        dispatch!(self.level, simd => intersect_triangle(simd, ray, triangle, corners))
    }

    /// [`Self::on_triangle`] for the triangle in a slot.
    pub(in crate::trace) fn hit_in_slot(&self, ray: &Ray, slot: u32) -> Option<Hit> {
        let (packet, lane) = self.triangle_in_slot(slot);
        self.on_triangle(ray, packet.triangle(lane), packet.triangle_corners(lane))
    }

    /// [`Self::closest`] for one SIMD level.
    #[inline(always)]
    fn walk_closest<S: Simd>(&self, simd: S, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> Option<Hit> {
        if !is_sound(ray) {
            return None;
        }
        let (slab, sheared) = (SlabRay::new(simd, ray), ShearedRay::new(simd, ray));
        let mut best = Hit { t: ray.t_max, triangle: NO_TRIANGLE, b1: 0.0, b2: 0.0 };
        let mut stack = ArrayVec::<(Child, f32), STACK>::new();
        let mut next = self.root;
        while next != Child::NONE {
            // Test the triangles of a leaf, or descend to the nearest child of a node.
            if let Some(packet) = next.packet() {
                closest_in_packet(&self.packets[packet], &sheared, &mut best, &accept);
            } else {
                let node = &self.nodes[next.0 as usize];
                let (mask, enter) = slab.children(node, best.t * FARTHER);
                if mask != 0 {
                    next = nearest_first(node, mask, enter, &mut stack);
                    continue;
                }
            }
            // Resume with the last stacked child that begins before the nearest hit.
            next = Child::NONE;
            while let Some((child, enter)) = stack.pop() {
                if enter <= best.t * FARTHER {
                    next = child;
                    break;
                }
            }
        }
        (best.triangle != NO_TRIANGLE).then_some(best)
    }

    /// [`Self::any_near`] for one SIMD level.
    ///
    /// Children are visited in memory order: two rays of three are not blocked and visit all of
    /// them, and no order by area, or by area per triangle, saved even 1 % of the nodes.
    #[inline(always)]
    pub(super) fn walk_any<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        occluder: &mut Occluder,
        mut accept: impl FnMut(&Hit) -> bool,
    ) -> bool {
        if !is_sound(ray) {
            return false;
        }
        // Test the packet that blocked the last ray.
        let sheared = ShearedRay::new(simd, ray);
        let last = occluder.0.take();
        if let Some(packet) = last
            && any_in_packet(&self.packets[packet as usize], &sheared, ray.t_max, &mut accept)
        {
            occluder.0 = last;
            return true;
        }
        // Visit all nodes that the ray meets until a triangle blocks it.
        let slab = SlabRay::new(simd, ray);
        let mut stack = ArrayVec::<Child, STACK>::new();
        if self.root != Child::NONE {
            stack.push(self.root);
        }
        while let Some(child) = stack.pop() {
            if let Some(packet) = child.packet() {
                // Do not test the first packet twice: `accept` may count what it lets pass.
                if last == Some(packet as u32) {
                    continue;
                }
                if any_in_packet(&self.packets[packet], &sheared, ray.t_max, &mut accept) {
                    occluder.0 = Some(packet as u32);
                    return true;
                }
                continue;
            }
            let node = &self.nodes[child.0 as usize];
            for lane in Bits(slab.children(node, ray.t_max).0) {
                stack.push(node.children[lane]);
            }
        }
        false
    }
}

/// False where a number of the ray is NaN or infinite. Such a ray hits nothing, but passes every
/// box test: it took 65 times as long as another.
#[inline(always)]
fn is_sound(ray: &Ray) -> bool {
    ray.origin.is_finite() && ray.direction.is_finite() && !ray.t_max.is_nan()
}

/// True where a triangle of the packet for which `accept(hit)` holds lies before `t_max`.
#[inline(always)]
pub(super) fn any_in_packet(
    packet: &TrianglePacket,
    ray: &ShearedRay<impl Simd>,
    t_max: f32,
    accept: &mut impl FnMut(&Hit) -> bool,
) -> bool {
    let hits = packet.intersect(ray, t_max);
    for lane in Bits(hits.mask) {
        let hit = hits.hit(lane, packet);
        if hit.t < t_max && accept(&hit) {
            return true;
        }
    }
    false
}

/// Replaces `best` by the nearest accepted hit with the triangles of a packet, where one is nearer.
#[inline(always)]
fn closest_in_packet(
    packet: &TrianglePacket,
    ray: &ShearedRay<impl Simd>,
    best: &mut Hit,
    accept: &impl Fn(&Hit) -> bool,
) {
    let hits = packet.intersect(ray, best.t);
    for lane in Bits(hits.mask) {
        let hit = hits.hit(lane, packet);
        let nearer = hit.t < best.t || (hit.t == best.t && hit.triangle < best.triangle);
        // The ray's end is no hit: `best` has no triangle until a hit before the end is found.
        let at_end = best.triangle == NO_TRIANGLE && hit.t == best.t;
        if nearer && !at_end && accept(&hit) {
            *best = hit;
        }
    }
}

/// Returns the child that is entered first and pushes the others, the nearest on top.
#[inline(always)]
pub(in crate::trace) fn nearest_first(
    node: &Node,
    mask: u32,
    enter: [f32; WIDTH],
    stack: &mut ArrayVec<(Child, f32), STACK>,
) -> Child {
    let first = mask.trailing_zeros() as usize;
    let mut nearest = (node.children[first], enter[first]);
    let base = stack.len();
    for lane in Bits(mask & (mask - 1)) {
        let mut other = (node.children[lane], enter[lane]);
        if other.1 < nearest.1 {
            std::mem::swap(&mut nearest, &mut other);
        }
        stack.push(other);
        let mut at = stack.len() - 1;
        while at > base && stack[at - 1].1 < other.1 {
            stack.swap(at - 1, at);
            at -= 1;
        }
    }
    nearest.0
}
