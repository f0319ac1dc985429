//! Finds the block of a reference that is at fault where a pixel looks wrong.
//!
//! A single wrong pixel proves little: at the edge of a shadow the light between two samples is a
//! guess, and the reference may be right. So pixels of the block are traced again from the
//! reference's pose, and the block is at fault where those are off.

use super::{audited::Audited, statistics::visibly_brighter};
use crate::camera::{PixelWarp, View};
use crate::reference::{CachedReference, ReferenceCache, ReferenceFrame, ReferenceId};
use crate::render::frame::Frame;
use crate::trace::{PixelTrace, RayCounts, TraceSettings, Tracer};
use std::collections::{BTreeMap, BTreeSet};

/// Side of the blocks of a reference that are judged as a whole, pixels.
pub(super) const BLOCK: u32 = 16;

/// A reference's sample belongs to a point where their depths differ by less than this share: the
/// tolerance with which measurements count pixels that show another surface than they should.
const SAME_DEPTH: f32 = 0.01;

/// Wrong pixels after which a block is examined.
const MIN_ACCUSATIONS: u32 = 2;

/// Pixels of an examined block that are traced again.
const RETRACED: usize = 32;

/// A block is at fault if its light is off by more than this share on average, and by
/// [`MIN_SIGMAS`] standard errors.
const MIN_OFF: f64 = 0.1;

/// Number of standard errors by which the average must be off. Noise alone never causes that.
const MIN_SIGMAS: f64 = 6.0;

/// Blocks remembered at most: those of one reference of 1280x720.
const MAX_REMEMBERED: usize = 3600;

/// A block of a reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Block {
    pub(super) reference: ReferenceId,
    /// Top left pixel.
    pub(super) corner: [u32; 2],
}

/// The blocks under suspicion, and those found to be right.
#[derive(Debug, Default)]
pub(super) struct Blame {
    accusations: BTreeMap<Block, u32>,
    cleared: BTreeSet<Block>,
}

impl Blame {
    /// Accuses the blocks whose light is off at a wrong pixel. Returns those that are at fault.
    /// `trace` holds the settings that pixels are traced again with.
    pub(super) fn accuse(
        &mut self,
        audited: &Audited<'_>,
        cache: &ReferenceCache,
        pixel: u32,
        right: &PixelTrace,
        trace: &TraceSettings,
    ) -> Vec<Block> {
        let Audited { tracer, frame, .. } = *audited;
        let mut at_fault = Vec::new();
        for (entry, block) in differing_blocks(tracer, frame, cache, pixel, right) {
            if self.cleared.contains(&block) || !self.is_accused_enough(block) {
                continue;
            }
            if is_at_fault(tracer, &entry.frame, block.corner, trace) {
                at_fault.push(block);
            } else {
                self.cleared.insert(block);
            }
        }
        at_fault
    }

    fn is_accused_enough(&mut self, block: Block) -> bool {
        if self.accusations.len() >= MAX_REMEMBERED || self.cleared.len() >= MAX_REMEMBERED {
            *self = Self::default();
        }
        let accusations = self.accusations.entry(block).or_default();
        *accusations += 1;
        let is_enough = *accusations >= MIN_ACCUSATIONS;
        if is_enough {
            self.accusations.remove(&block);
        }
        is_enough
    }
}

/// True where pixels of a block, traced again from the reference's pose, show that its light is
/// wrong.
fn is_at_fault(tracer: &Tracer, reference: &ReferenceFrame, corner: [u32; 2], trace: &TraceSettings) -> bool {
    let [width, height] = reference.view.size;
    let columns = corner[0]..(corner[0] + BLOCK).min(width);
    let rows = corner[1]..(corner[1] + BLOCK).min(height);
    let lit: Vec<u32> = rows
        .flat_map(|y| columns.clone().map(move |x| y * width + x))
        .filter(|&pixel| reference.has_light(pixel) && reference.disparity()[pixel as usize] > 0.0)
        .collect();
    let step = (lit.len() / RETRACED).max(1);
    let (mut off, mut off_squared, mut all) = (0.0, 0.0, 0.0);
    let mut count = 0.0;
    for &pixel in lit.iter().step_by(step).take(RETRACED) {
        let right =
            tracer.reference_pixel(&reference.view, pixel, trace, &mut RayCounts::default()).light.total();
        let difference = f64::from((reference.light(pixel) - right).element_sum());
        (off, off_squared) = (off + difference, off_squared + difference * difference);
        (all, count) = (all + f64::from(right.element_sum()), count + 1.0);
    }
    let spread = (off_squared - off * off / count).max(0.0);
    // Both sides are sums instead of means: `count` cancels.
    count >= RETRACED as f64 / 2.0
        && off.abs() > MIN_OFF * all
        && off.abs() > MIN_SIGMAS * (spread * count / (count - 1.0)).sqrt()
}

/// The blocks whose light for the point that a pixel shows is visibly off.
fn differing_blocks<'a>(
    tracer: &Tracer,
    frame: &Frame,
    cache: &'a ReferenceCache,
    pixel: u32,
    right: &PixelTrace,
) -> Vec<(&'a CachedReference, Block)> {
    let Some(hit) = right.hit else { return Vec::new() };
    let albedo = tracer.albedo(&hit);
    let (x, y) = (pixel % frame.view.size[0], pixel / frame.view.size[0]);
    let mut found = Vec::new();
    for entry in cache.entries().iter().filter(|e| e.frame.epoch == tracer.epoch()) {
        let reference = &entry.frame;
        let warp = PixelWarp::new(&frame.view, &reference.view);
        let Some((sx, sy, disparity)) = warp.target(x, y, 1.0 / hit.t) else { continue };
        let sample = sy * reference.view.size[0] + sx;
        let is_same_point = (reference.disparity()[sample as usize] / disparity - 1.0).abs() < SAME_DEPTH;
        if !is_same_point
            || !reference.has_light(sample)
            || !sees_same_side(tracer, hit.triangle, &frame.view, &reference.view)
        {
            continue;
        }
        if visibly_brighter(albedo * reference.light(sample), albedo * right.light.total()).is_some() {
            let corner = [sx / BLOCK * BLOCK, sy / BLOCK * BLOCK];
            found.push((entry, Block { reference: entry.id, corner }));
        }
    }
    found
}

/// True where two eyes are on the same side of a triangle.
fn sees_same_side(tracer: &Tracer, triangle: u32, a: &View, b: &View) -> bool {
    let [p, q, r] = tracer.scene().corners(triangle);
    let normal = (q - p).cross(r - p);
    (normal.dot(a.eye - p) > 0.0) == (normal.dot(b.eye - p) > 0.0)
}
