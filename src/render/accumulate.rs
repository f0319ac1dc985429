//! Accumulation of passes: a picture that is refined while the camera is stationary, an
//! anti-aliased picture, and a picture rendered in bands are all means of N passes of the full
//! tracer.
//!
//! Pass k traces every pixel through one point of the pixel, with its own seed, and a pixel shows
//! the mean of its passes so far. The first point is the pixel's centre and the first seed that of
//! the settings, so after one pass the picture is that of mode `full`. Each pixel sums its passes
//! in order, so the bits depend neither on threads nor on when the work was interrupted.

use super::{
    frame::{Frame, RefineState},
    request::FrameRequest,
    worklist::dispersed_pass,
};
use crate::camera::{Camera, View};
use crate::lookup::pixels_of_tile;
use crate::raster::{fill::fill_unknown, pixel_types::TypeCounts};
use crate::trace::{
    NO_TRIANGLE, PixelTrace, RayCounts, SceneEpoch, TILE_RAYS, TILE_SIDE, TraceSettings, Tracer,
    parallel::Stop, section::Section,
};
use glam::Vec3;
use rayon::prelude::*;
use std::{
    ops::Range,
    sync::Arc,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

/// Passes until a picture counts as converged: sixteen points show an edge in sixteen steps.
pub const CONVERGED_PASSES: u32 = 16;

/// Passes after which a picture that is refined without end stops: the noise is 1/32 of that after
/// [`CONVERGED_PASSES`], and the seeds of passes, which have 16 bits, are still different ones.
const MAX_PASSES: u32 = 1 << 14;

/// What the sky contributes to a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// Its radiance.
    #[default]
    Shown,
    /// Nothing: radiance is that of the model alone, multiplied by its coverage.
    LeftOut,
}

/// One pass over a picture.
pub(super) struct Pass<'a> {
    tracer: &'a Tracer,
    view: View,
    trace: TraceSettings,
    is_first: bool,
    background: Background,
}

impl<'a> Pass<'a> {
    /// Pass `number` of `passes` over the picture of `view`.
    pub(super) fn new(
        tracer: &'a Tracer,
        view: &View,
        trace: &TraceSettings,
        (number, passes): (u32, u32),
        background: Background,
    ) -> Self {
        // References use the bits of the seed from 32 up, passes those from 48 up.
        let seed = trace.seed.wrapping_add(u64::from(number) << 48);
        let view = view.shifted(offset_of_pass(number, passes));
        Self { tracer, view, trace: TraceSettings { seed, ..*trace }, is_first: number == 0, background }
    }
}

/// A tile of pixels and the sums of their passes. Takes 28 bytes a pixel.
#[derive(Clone, Debug)]
pub(super) struct PassTile {
    /// Top left pixel.
    pub(super) corner: [u32; 2],
    /// One bit per pixel that has had the current pass.
    done: u64,
    pub(super) sums: [Vec3; TILE_RAYS],
    /// Sums of the squared radiance of the passes, over the channels.
    squares: [f32; TILE_RAYS],
    /// Passes in which each pixel showed a surface.
    pub(super) hits: [u32; TILE_RAYS],
    /// Disparity and triangle of the first pass, through the pixels' centres.
    pub(super) disparity: [f32; TILE_RAYS],
    pub(super) triangle: [u32; TILE_RAYS],
}

impl PassTile {
    pub(super) fn new(corner: [u32; 2]) -> Self {
        Self {
            corner,
            done: 0,
            sums: [Vec3::ZERO; TILE_RAYS],
            squares: [0.0; TILE_RAYS],
            hits: [0; TILE_RAYS],
            disparity: [0.0; TILE_RAYS],
            triangle: [NO_TRIANGLE; TILE_RAYS],
        }
    }

    /// Traces the pixels that have not had this pass.
    fn trace(&mut self, pass: &Pass<'_>, stop: Stop<'_>) -> RayCounts {
        let mut rays = RayCounts::default();
        for (i, pixel) in pixels_of_tile(self.corner, pass.view.size) {
            if self.done >> i & 1 == 1 {
                continue;
            }
            if stop() {
                break;
            }
            let traced = pass.tracer.pixel(&pass.view, pixel as u32, &pass.trace, &mut rays);
            self.add(i, &traced, pass);
        }
        rays
    }

    /// Traces all passes, one after the other.
    pub(super) fn trace_all(&mut self, passes: &[Pass<'_>], stop: Stop<'_>) -> RayCounts {
        let mut rays = RayCounts::default();
        for pass in passes {
            self.done = 0;
            rays += self.trace(pass, stop);
        }
        rays
    }

    fn add(&mut self, i: usize, traced: &PixelTrace, pass: &Pass<'_>) {
        if pass.is_first {
            self.disparity[i] = traced.disparity();
            self.triangle[i] = traced.hit.map_or(NO_TRIANGLE, |hit| hit.triangle);
        }
        let is_covered = traced.disparity() > 0.0;
        self.hits[i] += u32::from(is_covered);
        if is_covered || pass.background == Background::Shown {
            self.sums[i] += traced.radiance;
            self.squares[i] += traced.radiance.length_squared();
        }
        self.done |= 1 << i;
    }
}

/// A stop condition that stays true once it was. `is_set` stores whether it was.
pub(super) fn latched<'a>(stop: Stop<'a>, is_set: &'a AtomicBool) -> impl Fn() -> bool + Sync + 'a {
    move || {
        let stops = is_set.load(Ordering::Relaxed) || stop();
        if stops {
            is_set.store(true, Ordering::Relaxed);
        }
        stops
    }
}

/// Traces some tiles in parallel. Returns the rays of all.
pub(super) fn trace_tiles(
    tiles: &mut [PassTile],
    trace: impl Fn(&mut PassTile) -> RayCounts + Sync + Send,
) -> RayCounts {
    tiles.par_iter_mut().map(trace).reduce(RayCounts::default, |mut a, b| {
        a += b;
        a
    })
}

/// The picture of one pose on its way to convergence.
#[derive(Debug)]
pub(super) struct Accumulation {
    camera: Camera,
    view: View,
    epoch: SceneEpoch,
    section: Option<Arc<Section>>,
    trace: TraceSettings,
    /// Passes that sample all points of a pixel once. Later ones begin again with the first point.
    passes: u32,
    /// Passes after which nothing is left to do.
    goal: u32,
    /// Number of the current pass; `goal` where none is left.
    pass: u32,
    /// Neighbours in the list are apart in the picture, so that an unfinished pass is spread
    /// evenly.
    tiles: Vec<PassTile>,
    rays: RayCounts,
}

impl Accumulation {
    pub(super) fn new(request: &FrameRequest<'_>, passes: u32) -> Self {
        let FrameRequest { tracer, camera, size, settings, .. } = *request;
        Self {
            camera: *camera,
            view: View::new(camera, &tracer.scene().frame, size),
            epoch: tracer.epoch(),
            section: tracer.section().cloned(),
            trace: settings.trace,
            passes,
            goal: passes,
            pass: 0,
            tiles: dispersed_tiles(size),
            rays: RayCounts::default(),
        }
    }

    /// True where this is the picture of a request.
    pub(super) fn is_of(&self, request: &FrameRequest<'_>) -> bool {
        let FrameRequest { tracer, camera, size, settings, .. } = *request;
        let is_same_scene = self.epoch == tracer.epoch() && self.section.as_ref() == tracer.section();
        is_same_scene && self.camera == *camera && self.view.size == size && self.trace == settings.trace
    }

    /// Sets whether passes are added for as long as there is time, up to [`MAX_PASSES`].
    pub(super) fn set_endless(&mut self, is_endless: bool) {
        self.goal = if is_endless { self.passes.max(MAX_PASSES) } else { self.passes };
    }

    pub(super) fn state(&self) -> RefineState {
        let is_complete = self.pass >= self.goal;
        RefineState { pass: self.pass, of: self.passes, light_samples: 0, is_complete }
    }

    /// Passes that every pixel has had.
    pub(super) fn passes_done(&self) -> u32 {
        self.pass
    }

    /// The mean of each pixel's passes, and the variance of that mean, summed over the channels;
    /// `None` for pixels that have had fewer than two.
    pub(super) fn means(&self) -> Vec<Option<(Vec3, f32)>> {
        let mut means = vec![None; self.view.pixel_count()];
        for tile in &self.tiles {
            for (i, pixel) in pixels_of_tile(tile.corner, self.view.size) {
                let count = (self.pass + (tile.done >> i & 1) as u32) as f32;
                if count >= 2.0 {
                    let mean = tile.sums[i] / count;
                    let variance = (tile.squares[i] / count - mean.length_squared()).max(0.0);
                    means[pixel] = Some((mean, variance / (count - 1.0)));
                }
            }
        }
        means
    }

    /// Takes a complete frame of mode `full` as the first pass, which has the same bits.
    pub(super) fn take_first_pass(&mut self, full: &Frame) {
        for tile in &mut self.tiles {
            for (i, pixel) in pixels_of_tile(tile.corner, full.view.size) {
                tile.sums[i] = full.radiance[pixel];
                tile.squares[i] = full.radiance[pixel].length_squared();
                tile.disparity[i] = full.disparity[pixel];
                tile.triangle[i] = full.triangle[pixel];
            }
        }
        self.pass = 1;
    }

    /// Traces until all passes are done or `stop` is true. What is done then is kept.
    pub(super) fn run(&mut self, tracer: &Tracer, stop: Stop<'_>) {
        self.run_until(self.goal, tracer, stop);
    }

    /// Traces until this many passes are done or `stop` is true. What is done then is kept.
    pub(super) fn run_until(&mut self, passes: u32, tracer: &Tracer, stop: Stop<'_>) {
        let is_stopped = AtomicBool::new(false);
        let stop = latched(stop, &is_stopped);
        while self.pass < passes.min(self.goal) {
            let number = (self.pass, self.passes);
            let pass = Pass::new(tracer, &self.view, &self.trace, number, Background::Shown);
            self.rays += trace_tiles(&mut self.tiles, |tile| tile.trace(&pass, &stop));
            if is_stopped.load(Ordering::Relaxed) {
                return;
            }
            self.pass += 1;
            self.tiles.iter_mut().for_each(|tile| tile.done = 0);
        }
    }

    /// Shows in a frame of the same size what is done. Pixels that have had no pass are left alone.
    pub(super) fn write_to(&self, frame: &mut Frame) {
        for tile in &self.tiles {
            for (i, pixel) in pixels_of_tile(tile.corner, self.view.size) {
                let samples = self.pass + (tile.done >> i & 1) as u32;
                if samples > 0 {
                    frame.radiance[pixel] = tile.sums[i] / samples as f32;
                    (frame.disparity[pixel], frame.triangle[pixel]) = (tile.disparity[i], tile.triangle[i]);
                }
            }
        }
        frame.stats.refined = self.state();
    }

    /// For each pixel, whether it has had a pass.
    fn known_pixels(&self) -> Vec<bool> {
        let mut known = vec![self.pass > 0; self.view.pixel_count()];
        for tile in &self.tiles {
            for (i, pixel) in pixels_of_tile(tile.corner, self.view.size) {
                known[pixel] |= tile.done >> i & 1 == 1;
            }
        }
        known
    }
}

/// The top left pixels of all tiles of some rows of a picture.
pub(super) fn tile_corners(rows: Range<u32>, width: u32) -> impl Iterator<Item = [u32; 2]> {
    rows.step_by(TILE_SIDE).flat_map(move |y| (0..width).step_by(TILE_SIDE).map(move |x| [x, y]))
}

/// All tiles of a picture, in dispersed order.
fn dispersed_tiles([width, height]: [u32; 2]) -> Vec<PassTile> {
    let mut corners: Vec<[u32; 2]> = tile_corners(0..height, width).collect();
    corners.sort_by_key(|corner| {
        let [column, row] = corner.map(|c| c / TILE_SIDE as u32);
        dispersed_pass(column, row)
    });
    corners.into_iter().map(PassTile::new).collect()
}

/// The point of the pixel that a pass samples, in pixels from the centre: a lattice around the
/// centre, so that the picture does not shift, in an order whose beginnings are spread out as well.
///
/// Source: the steps are multiples of the powers of the plastic number (Roberts 2018, the "R2"
/// sequence). We differ: they are rounded to whole parts of a pixel, because the mean of sixteen
/// points of R2 is a tenth of a pixel off the centre.
pub(super) fn offset_of_pass(pass: u32, passes: u32) -> [f64; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let count = passes.max(1);
    STEPS.map(|step| {
        // Without a common factor every column and every row of the lattice is visited once.
        let is_coprime = |step: &u32| greatest_common_divisor(*step, count) == 1;
        let off = |whole: u32| (f64::from(whole) - step * f64::from(count)).abs();
        let whole = (1..=count).filter(is_coprime).min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(1);
        let part = (u64::from(pass) * u64::from(whole) % u64::from(count)) as f64 / f64::from(count);
        if part < 0.5 { part } else { part - 1.0 }
    })
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// Renders a picture with the full tracer, with `passes` rays through different points of each
/// pixel: the same bits as a picture refined for as many passes, and with one pass those of mode
/// `full`. References are ignored. Pixels that a stop left undone show those around them, and the
/// frame is not marked complete.
pub fn render_antialiased(request: &FrameRequest<'_>, passes: u32) -> Frame {
    let start = Instant::now();
    let mut accumulation = Accumulation::new(request, passes.max(1));
    accumulation.run(request.tracer, request.stop);
    let mut frame = Frame::default();
    frame.reset(request.camera, &accumulation.view);
    accumulation.write_to(&mut frame);
    if accumulation.pass == 0 {
        let known = accumulation.known_pixels();
        fill_unknown(&mut frame.radiance, &known, request.size[0] as usize, &mut Vec::new());
    }
    frame.stats.types = TypeCounts::of(&frame.types);
    frame.stats.rays = accumulation.rays;
    frame.stats.is_complete = accumulation.state().is_complete;
    frame.stats.secs.trace = start.elapsed().as_secs_f64();
    frame.stats.secs.frame = frame.stats.secs.trace;
    frame
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_begin_at_the_centre_and_are_spread_around_it() {
        for passes in [1, 2, 3, 4, 5, 8, 16, 17, 64, 100] {
            let points: Vec<[f64; 2]> = (0..passes).map(|pass| offset_of_pass(pass, passes)).collect();
            assert_eq!(points[0], [0.0; 2]);
            let count = f64::from(passes);
            for axis in 0..2 {
                assert!(points.iter().all(|p| (-0.5..0.5).contains(&p[axis])));
                let mean = points.iter().map(|p| p[axis]).sum::<f64>() / count;
                assert!(mean.abs() <= 0.5 / count + 1e-12, "{passes} passes: mean {mean}");
            }
            let apart = |a: f64, b: f64| (a - b).abs().min(1.0 - (a - b).abs());
            let distance = |p: &[f64; 2], q: &[f64; 2]| apart(p[0], q[0]).hypot(apart(p[1], q[1]));
            let pairs = (0..points.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            let least = pairs.map(|(i, j)| distance(&points[i], &points[j])).fold(1.0, f64::min);
            // On a square grid of as many points the distance is 1 / sqrt(count).
            assert!(least >= 0.5 / count.sqrt(), "{passes} passes: {least}");
        }
    }
}
