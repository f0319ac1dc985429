//! Walks the tree along a ray.
//!
//! Source of the box test: Ize, "Robust BVH Ray Traversal", JCGT 2013: the far distance is widened by the rounding
//! error of its own computation, so that no box is missed whose content is hit.

use super::build::MAX_DEPTH;
use super::packet::{ShearedRay, TrianglePacket};
use super::{Bvh, Child, Hit, Node};
use crate::math::Ray;
use arrayvec::ArrayVec;
use wide::f32x4;

/// Three siblings a level, and the root.
pub(super) const STACK: usize = 3 * MAX_DEPTH + 1;

/// 1 + 2 gamma(3), the bound on the relative error of `(bound - origin) * inverse`.
const FAR_SLACK: f32 = 1.000_000_4;

/// A ray prepared for box tests.
struct SlabRay {
    origin: [f32x4; 3],
    inverse: [f32x4; 3],
    /// Index into [`Node::bounds`] of the plane met first, per axis; the other is `^ 1`.
    near: [usize; 3],
}

impl SlabRay {
    fn new(ray: &Ray) -> Self {
        // A zero component would make 0 * inf = NaN for an origin in the plane; 2^-80 has a finite inverse and
        // bends the ray by less than any rounding.
        const TINY: f32 = f32::from_bits((127 - 80) << 23);
        let safe = |d: f32| if d.abs() < TINY { TINY.copysign(d) } else { d };
        let inverse = ray.direction.to_array().map(|d| 1.0 / safe(d));
        Self {
            origin: ray.origin.to_array().map(f32x4::splat),
            inverse: inverse.map(f32x4::splat),
            near: std::array::from_fn(|axis| 2 * axis + usize::from(inverse[axis] < 0.0)),
        }
    }

    /// Which children the ray meets before `t_max`, and where it enters them.
    #[inline(always)]
    fn children(&self, node: &Node, t_max: f32) -> (u32, f32x4) {
        let plane = |axis: usize, which: usize| {
            (f32x4::new(node.bounds[which]) - self.origin[axis]) * self.inverse[axis]
        };
        let [nx, ny, nz] = self.near;
        let enter = plane(0, nx).fast_max(plane(1, ny)).fast_max(plane(2, nz)).fast_max(f32x4::ZERO);
        let leave = plane(0, nx ^ 1).fast_min(plane(1, ny ^ 1)).fast_min(plane(2, nz ^ 1));
        let leave = (leave * f32x4::splat(FAR_SLACK)).fast_min(f32x4::splat(t_max));
        (enter.simd_le(leave).to_bitmask(), enter)
    }
}

impl Bvh {
    /// The nearest triangle along the ray for which `accept(hit)` holds.
    ///
    /// Of several at the very same distance the one with the lowest index wins, so the answer does not depend on the
    /// shape of the tree.
    #[inline]
    pub fn closest(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let (slab, sheared) = (SlabRay::new(ray), ShearedRay::new(ray));
        let mut best = Hit { t: ray.t_max, triangle: u32::MAX, b1: 0.0, b2: 0.0 };
        let mut stack = ArrayVec::<(Child, f32), STACK>::new();
        let mut next = self.root;
        while next != Child::NONE {
            if let Some(packet) = next.packet() {
                closest_in_packet(&self.packets[packet], &sheared, &mut best, &accept);
            } else {
                let node = &self.nodes[next.0 as usize];
                let (mask, enter) = slab.children(node, best.t);
                if mask != 0 {
                    next = nearest_first(node, mask, enter.to_array(), &mut stack);
                    continue;
                }
            }
            next = Child::NONE;
            while let Some((child, enter)) = stack.pop() {
                if enter <= best.t {
                    next = child;
                    break;
                }
            }
        }
        (best.triangle != u32::MAX).then_some(best)
    }

    /// True where some triangle for which `accept(hit)` holds lies before the ray's end.
    pub fn any(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> bool {
        self.any_near(ray, &mut Occluder::default(), accept)
    }

    /// The same for one of a bundle of rays: what blocked the last one is tested first, and `occluder` is kept up to
    /// date. The answer does not depend on it.
    #[inline]
    pub fn any_near(&self, ray: &Ray, occluder: &mut Occluder, mut accept: impl FnMut(&Hit) -> bool) -> bool {
        let sheared = ShearedRay::new(ray);
        let last = occluder.0.take();
        if let Some(packet) = last
            && any_in_packet(&self.packets[packet as usize], &sheared, ray.t_max, &mut accept)
        {
            occluder.0 = last;
            return true;
        }
        let slab = SlabRay::new(ray);
        let mut stack = ArrayVec::<Child, STACK>::new();
        if self.root != Child::NONE {
            stack.push(self.root);
        }
        while let Some(child) = stack.pop() {
            if let Some(packet) = child.packet() {
                // What was tested before the walk must not be asked again: `accept` may count what it lets pass.
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
            let (mut mask, _) = slab.children(node, ray.t_max);
            while mask != 0 {
                stack.push(node.children[mask.trailing_zeros() as usize]);
                mask &= mask - 1;
            }
        }
        false
    }
}

/// The packet that blocked the last ray of a bundle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Occluder(Option<u32>);

#[inline(always)]
fn any_in_packet(
    packet: &TrianglePacket,
    ray: &ShearedRay,
    t_max: f32,
    accept: &mut impl FnMut(&Hit) -> bool,
) -> bool {
    let hits = packet.intersect(ray, t_max);
    let mut mask = hits.mask;
    while mask != 0 {
        let hit = hits.hit(mask.trailing_zeros() as usize, packet);
        if hit.t < t_max && accept(&hit) {
            return true;
        }
        mask &= mask - 1;
    }
    false
}

#[inline(always)]
fn closest_in_packet(
    packet: &TrianglePacket,
    ray: &ShearedRay,
    best: &mut Hit,
    accept: &impl Fn(&Hit) -> bool,
) {
    let hits = packet.intersect(ray, best.t);
    let mut mask = hits.mask;
    while mask != 0 {
        let hit = hits.hit(mask.trailing_zeros() as usize, packet);
        let nearer = hit.t < best.t || (hit.t == best.t && hit.triangle < best.triangle);
        // An end of the ray is no hit: `best.triangle` is MAX until something nearer than the end is found.
        let at_end = best.triangle == u32::MAX && hit.t == best.t;
        if nearer && !at_end && accept(&hit) {
            *best = hit;
        }
        mask &= mask - 1;
    }
}

/// Returns the child entered first and stacks the others, the nearest on top.
#[inline(always)]
pub(super) fn nearest_first(
    node: &Node,
    mut mask: u32,
    enter: [f32; 4],
    stack: &mut ArrayVec<(Child, f32), STACK>,
) -> Child {
    let first = mask.trailing_zeros() as usize;
    mask &= mask - 1;
    let mut nearest = (node.children[first], enter[first]);
    let base = stack.len();
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask - 1;
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
