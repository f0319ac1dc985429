//! Walks the tree along a ray.
//!
//! Source of the box test: Ize, "Robust BVH Ray Traversal", JCGT 2013: the far distance is widened by the rounding
//! error of its own computation, so that no box is missed whose content is hit.

use super::build::MAX_DEPTH;
use super::packet::{ShearedRay, TrianglePacket};
use super::{Bvh, Child, Hit, Node};
use crate::math::Ray;
use wide::f32x4;

/// Three siblings a level, and the root.
const STACK: usize = 3 * MAX_DEPTH + 1;

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
        let mut stack = [(Child::NONE, 0.0f32); STACK];
        let mut height = 0;
        let mut next = self.root;
        while next != Child::NONE {
            if let Some(packet) = next.packet() {
                closest_in_packet(&self.packets[packet], &sheared, &mut best, &accept);
            } else {
                let node = &self.nodes[next.0 as usize];
                let (mask, enter) = slab.children(node, best.t);
                if mask != 0 {
                    next = nearest_first(node, mask, enter.to_array(), &mut stack, &mut height);
                    continue;
                }
            }
            next = Child::NONE;
            while height > 0 {
                height -= 1;
                let (child, enter) = stack[height];
                if enter <= best.t {
                    next = child;
                    break;
                }
            }
        }
        (best.triangle != u32::MAX).then_some(best)
    }

    /// True where some triangle for which `accept(hit)` holds lies before the ray's end.
    #[inline]
    pub fn any(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> bool {
        let (slab, sheared) = (SlabRay::new(ray), ShearedRay::new(ray));
        let mut stack = [Child::NONE; STACK];
        let mut height = 1;
        stack[0] = self.root;
        while height > 0 {
            height -= 1;
            let child = stack[height];
            if child == Child::NONE {
                continue;
            }
            if let Some(packet) = child.packet() {
                let packet = &self.packets[packet];
                let hits = packet.intersect(&sheared, ray.t_max);
                let mut mask = hits.mask;
                while mask != 0 {
                    let hit = hits.hit(mask.trailing_zeros() as usize, packet);
                    if hit.t < ray.t_max && accept(&hit) {
                        return true;
                    }
                    mask &= mask - 1;
                }
                continue;
            }
            let node = &self.nodes[child.0 as usize];
            let (mut mask, _) = slab.children(node, ray.t_max);
            while mask != 0 {
                stack[height] = node.children[mask.trailing_zeros() as usize];
                height += 1;
                mask &= mask - 1;
            }
        }
        false
    }
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
fn nearest_first(
    node: &Node,
    mut mask: u32,
    enter: [f32; 4],
    stack: &mut [(Child, f32); STACK],
    height: &mut usize,
) -> Child {
    let first = mask.trailing_zeros() as usize;
    mask &= mask - 1;
    let mut nearest = (node.children[first], enter[first]);
    let base = *height;
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        let mut other = (node.children[lane], enter[lane]);
        if other.1 < nearest.1 {
            std::mem::swap(&mut nearest, &mut other);
        }
        let mut at = *height;
        while at > base && stack[at - 1].1 < other.1 {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = other;
        *height += 1;
    }
    nearest.0
}
