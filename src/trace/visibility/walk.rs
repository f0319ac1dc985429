//! Finds the candidates of a bin: traverses the hierarchy for its frustum, nearest nodes first.

use super::bin::{Bin, CHECKED, NEEDS_RAY};
use super::facet::{Bounds, facets};
use super::lens::{BIN_PIXELS, BinView, Reach};
use crate::math::Ray;
use crate::trace::bvh::{
    Bits, Bvh, Child, FARTHER, Hit, Node, STACK, intersect_triangle, nearest_first, safe_component,
};
use arrayvec::ArrayVec;
use fearless_simd::{Simd, SimdBase, SimdMask, dispatch, f32x8};
use glam::Vec3;

/// Number of packets after which a bin is left to single rays.
const MAX_PACKETS: usize = 4 * BIN_PIXELS;

/// Fills a bin with the triangles of a hierarchy for which `is_seen` holds, and writes the slot of
/// each of its pixels.
pub(super) fn find(
    bvh: &Bvh,
    view: &BinView,
    bin: &mut Bin,
    is_seen: impl Fn(u32) -> bool,
    slots: &mut [u32],
) {
    bin.clear();
    dispatch!(bvh.level, simd => walk(simd, bvh, view, bin, is_seen, slots));
}

/// Traverses the hierarchy.
#[inline(always)]
fn walk<S: Simd>(
    simd: S,
    bvh: &Bvh,
    view: &BinView,
    bin: &mut Bin,
    is_seen: impl Fn(u32) -> bool,
    slots: &mut [u32],
) {
    let origin = view.eye.to_array().map(|o| f32x8::splat(simd, o));
    let sides = view.sides.map(|normal| Side::new(simd, normal));
    let (mut farthest, mut packets) = (f32::INFINITY, 0);
    let mut stack = ArrayVec::<(Child, f32), STACK>::new();
    if bvh.root != Child::NONE {
        stack.push((bvh.root, 0.0));
    }
    while let Some((mut child, near)) = stack.pop() {
        // Skip a node that begins behind all candidates of the bin.
        if near > farthest {
            continue;
        }
        loop {
            // Enter the triangles of a leaf.
            if let Some(packet) = child.packet() {
                packets += 1;
                enter(simd, bvh, packet, view, bin, &is_seen);
                bin.update_farthest(simd, &mut farthest);
                break;
            }
            let node = &bvh.nodes[child.0 as usize];
            // Find the children that begin before the farthest candidate.
            let near = nearest(simd, node, &origin, &view.reaches);
            let mut met = near.simd_le(f32x8::splat(simd, farthest));
            // Clip their boxes against the sides of the bin.
            for side in &sides {
                met &= side.extent(simd, node, &origin).simd_ge(f32x8::splat(simd, 0.0));
            }
            // Descend to the nearest and stack the others.
            let mask = met.to_bitmask() as u32;
            if mask == 0 {
                break;
            }
            child = nearest_first(node, mask, near.to_array(), &mut stack);
        }
        if packets > MAX_PACKETS {
            slots.fill(NEEDS_RAY);
            return;
        }
    }
    bin.finish(simd, slots, |pixel, slots| nearer(simd, bvh, &view.ray(pixel), slots));
}

/// Enters the triangles of a packet.
#[inline(always)]
fn enter<S: Simd>(
    simd: S,
    bvh: &Bvh,
    packet: usize,
    view: &BinView,
    bin: &mut Bin,
    is_seen: &impl Fn(u32) -> bool,
) {
    let triangles = &bvh.packets[packet];
    // Drop triangles between the centres of pixels, and those behind what their tiles show.
    let bounds = Bounds::new(simd, view, triangles);
    let mut seen = 0;
    for lane in Bits(bounds.seen) {
        let is_hidden = bin.hides(bounds.pixels(lane), bounds.nearest[lane]);
        seen |= u32::from(!is_hidden && is_seen(triangles.triangle(lane))) << lane;
    }
    if seen == 0 {
        return;
    }
    let facets = facets(simd, view, &bounds);
    for lane in Bits(seen) {
        let (facet, pixels, slot) = (facets.facet(lane), bounds.pixels(lane), (4 * packet + lane) as u32);
        if facets.certain >> lane & 1 == 1 {
            let slot = if facets.checked >> lane & 1 == 1 { slot | CHECKED } else { slot };
            bin.fill::<S, true>(simd, &facet, pixels, slot);
        } else {
            bin.fill::<S, false>(simd, &facet, pixels, slot);
        }
    }
}

/// Returns the slot of the triangle that a ray meets first, of two that it meets before anything
/// else. `None` where the order in which the hierarchy is traversed may decide.
#[inline(always)]
fn nearer<S: Simd>(simd: S, bvh: &Bvh, ray: &Ray, slots: [u32; 2]) -> Option<u32> {
    let [a, b] = [hit_in_slot(simd, bvh, ray, slots[0])?, hit_in_slot(simd, bvh, ray, slots[1])?];
    let (hit, slot) = if (a.t, a.triangle) < (b.t, b.triangle) { (a, slots[0]) } else { (b, slots[1]) };
    // A single ray skips boxes that it enters behind its nearest hit.
    let (packet, lane) = bvh.triangle_in_slot(slot & !CHECKED);
    (entry(ray, packet.triangle_corners(lane)) <= hit.t * FARTHER).then_some(slot)
}

/// The hit of a ray with the triangle in a slot.
#[inline(always)]
fn hit_in_slot<S: Simd>(simd: S, bvh: &Bvh, ray: &Ray, slot: u32) -> Option<Hit> {
    let (packet, lane) = bvh.triangle_in_slot(slot & !CHECKED);
    intersect_triangle(simd, ray, packet.triangle(lane), packet.triangle_corners(lane))
}

/// Distance at which a ray enters the box around a triangle, as `bvh::slab` computes it.
fn entry(ray: &Ray, [a, b, c]: [Vec3; 3]) -> f32 {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let mut enter = 0.0f32;
    for axis in 0..3 {
        let inverse = 1.0 / safe_component(ray.direction[axis]);
        let bound = if inverse < 0.0 { high } else { low };
        enter = enter.max((bound[axis] - ray.origin[axis]) * inverse);
    }
    enter
}

/// Lower bounds of the distances at which any ray of the bin meets the boxes of a node's children.
#[inline(always)]
fn nearest<S: Simd>(simd: S, node: &Node, origin: &[f32x8<S>; 3], reaches: &[Reach]) -> f32x8<S> {
    let mut near = f32x8::splat(simd, f32::INFINITY);
    for reach in reaches {
        let bound = &node.bounds[2 * reach.axis + usize::from(reach.scale < 0.0)];
        let along = f32x8::load_array_ref(simd, bound) - origin[reach.axis];
        near = near.min(along * f32x8::splat(simd, reach.scale));
    }
    near
}

/// A plane through the eye.
struct Side<S: Simd> {
    normal: [f32x8<S>; 3],
    /// By axis, the index into [`Node::bounds`] of the plane of a box that lies farthest along the
    /// normal.
    outermost: [usize; 3],
}

impl<S: Simd> Side<S> {
    #[inline(always)]
    fn new(simd: S, normal: Vec3) -> Self {
        let n = normal.to_array();
        Self {
            normal: n.map(|x| f32x8::splat(simd, x)),
            outermost: std::array::from_fn(|axis| 2 * axis + usize::from(n[axis] > 0.0)),
        }
    }

    /// How far each child's box reaches inwards.
    #[inline(always)]
    fn extent(&self, simd: S, node: &Node, origin: &[f32x8<S>; 3]) -> f32x8<S> {
        let x = f32x8::load_array_ref(simd, &node.bounds[self.outermost[0]]) - origin[0];
        let y = f32x8::load_array_ref(simd, &node.bounds[self.outermost[1]]) - origin[1];
        let z = f32x8::load_array_ref(simd, &node.bounds[self.outermost[2]]) - origin[2];
        x * self.normal[0] + y * self.normal[1] + z * self.normal[2]
    }
}
