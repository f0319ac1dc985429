//! Finds the block of a reference that is at fault where a pixel looks wrong.
//!
//! A single wrong pixel proves little: at the edge of a shadow the light between two samples is a
//! guess, and the reference may be right. So pixels of the block are traced again from the
//! reference's pose, and the block is at fault where those are off.

use super::{audited::Audited, statistics::looks_wrong};
use crate::camera::{PixelWarp, View};
use crate::reference::{CachedReference, ReferenceCache, ReferenceFrame, ReferenceId};
use crate::trace::{ArrivingLight, PixelTrace, RayCounts, TraceSettings, Tracer};
use glam::Vec3;
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
        right: &[PixelTrace; 2],
        trace: &TraceSettings,
    ) -> Vec<Block> {
        let mut at_fault = Vec::new();
        for (entry, block) in differing_blocks(audited, cache, pixel, right) {
            if self.cleared.contains(&block) || !self.is_accused_enough(block) {
                continue;
            }
            if is_at_fault(audited.tracer, &entry.frame, block.corner, trace) {
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
    let mut sums = RetracedSums::default();
    for &pixel in lit.iter().step_by(step).take(RETRACED) {
        let right = tracer.reference_pixel(&reference.view, pixel, trace, &mut RayCounts::default()).light;
        sums.add(reference.light(pixel), &right);
    }
    sums.is_off(f64::from(reference.settings.samples) * lit.len() as f64)
}

/// Sums over the pixels of a block that were traced again, channels added up.
#[derive(Default)]
struct RetracedSums {
    count: f64,
    /// Light of the pixels as they should be.
    all: f64,
    /// Stored light less what it should be, and its square.
    off: f64,
    off_squared: f64,
    /// Variance of the smooth light of one path.
    path_variance: f64,
}

impl RetracedSums {
    fn add(&mut self, stored: Vec3, right: &ArrivingLight) {
        let off = f64::from((stored - right.total()).element_sum());
        self.count += 1.0;
        self.all += f64::from(right.total().element_sum());
        self.off += off;
        self.off_squared += off * off;
        self.path_variance += right.path_variance();
    }

    /// True where the stored light, which shares `paths` paths, is wrong beyond its noise.
    fn is_off(&self, paths: f64) -> bool {
        self.count >= RETRACED as f64 / 2.0
            && self.off.abs() > MIN_OFF * self.all
            && self.off.abs() > MIN_SIGMAS * self.standard_error(paths)
    }

    /// Standard error of the sum of differences, where the stored light shares `paths` paths.
    ///
    /// Two independent parts: what differs from pixel to pixel, noise of both sides, and the noise
    /// that all pixels have in common because they share their light with their neighbours. The
    /// mean over a block of light that is shared has at least the variance of a path over the
    /// number of paths of the block.
    fn standard_error(&self, paths: f64) -> f64 {
        let spread = (self.off_squared - self.off * self.off / self.count).max(0.0);
        let own = spread * self.count / (self.count - 1.0);
        let shared = self.count * self.path_variance / paths.max(1.0);
        (own + shared).sqrt()
    }
}

/// The blocks whose light for the point that a pixel shows is visibly off.
fn differing_blocks<'a>(
    audited: &Audited<'_>,
    cache: &'a ReferenceCache,
    pixel: u32,
    right: &[PixelTrace; 2],
) -> Vec<(&'a CachedReference, Block)> {
    let Audited { tracer, frame, .. } = *audited;
    let Some(hit) = right[0].hit else { return Vec::new() };
    let light = right.map(|traced| traced.light.total());
    let shown_share = audited.exposure() * tracer.albedo(&hit, frame.view.direction_of_pixel(pixel));
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
        let stored = shown_share * reference.light(sample);
        if looks_wrong(stored, light.map(|light| shown_share * light)) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::key::Key;

    /// Pixels whose right light is one, from 64 paths of variance `variance` each, and whose stored
    /// light is `stored`.
    fn block(stored: f32, variance: f32) -> RetracedSums {
        let mut sums = RetracedSums::default();
        for pixel in 0..RETRACED as u32 {
            // The mean of 32 paths has a 32nd of the variance; a uniform number a twelfth.
            let width = (12.0 * variance / 32.0).sqrt();
            let means = Key::of_pixel(9, pixel).pair().map(|u| 1.0 + (u - 0.5) * width);
            let smooth_sums = means.map(|mean| Vec3::new(32.0 * mean, 0.0, 0.0));
            let right = ArrivingLight { smooth_sums, paths: 64, ..ArrivingLight::default() };
            sums.add(Vec3::new(stored, 0.0, 0.0), &right);
        }
        sums
    }

    #[test]
    fn light_that_a_block_shares_is_at_fault_only_beyond_the_noise_of_its_paths() {
        // Off by a fifth in every pixel alike. A path has a variance of one: with 256 pixels of one
        // path each, that is 3 standard errors; with 64 times the paths it is more than 6.
        let sums = block(1.2, 1.0);
        assert!(sums.path_variance / sums.count > 0.5 && sums.path_variance / sums.count < 2.0);
        assert!(!sums.is_off(256.0));
        assert!(sums.is_off(64.0 * 256.0));
        // Light without noise, as light straight from lamps, needs no paths to be wrong.
        assert!(block(1.2, 0.0).is_off(256.0));
        assert!(!block(1.05, 0.0).is_off(256.0));
    }
}
