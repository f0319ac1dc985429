//! Convergence at rest: while the camera stands still its picture is traced in full, then anti-aliased.
//!
//! Pass k traces every pixel as the ordinary tracer does, through one point of the pixel and with a seed of its own, and
//! a pixel shows the mean of its passes so far. The first point is the pixel's centre and the first seed that of the
//! settings, so after one pass the picture is the one of mode `full`. Each pixel sums its passes in their order, so the
//! bits depend neither on threads nor on when the work was interrupted.

use super::FrameRequest;
use super::frame::{Frame, NO_SUPPLIER};
use super::renderer::DISPERSED;
use crate::camera::{Camera, View};
use crate::raster::fill::fill_unknown;
use crate::raster::pixel_types::{PixelType, TypeCounts};
use crate::trace::NO_TRIANGLE;
use crate::trace::parallel::Stop;
use crate::trace::{PixelTrace, RayCounts, SceneEpoch, TILE_RAYS, TILE_SIDE, TraceSettings, Tracer};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Passes until a picture counts as converged: sixteen points show an edge in sixteen steps.
pub const PASSES: u32 = 16;

/// How far a picture has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RefineState {
    /// Passes that every pixel has had.
    pub pass: u32,
    /// Passes in all; 0 where the picture is not refined.
    pub of: u32,
    /// Nothing is left to do.
    pub is_complete: bool,
}

/// The picture of one pose on its way to convergence. Takes 20 bytes a pixel.
#[derive(Debug)]
pub(super) struct Refinement {
    camera: Camera,
    view: View,
    epoch: SceneEpoch,
    trace: TraceSettings,
    passes: u32,
    /// The pass in the making; `passes` when there is none left.
    pass: u32,
    /// Neighbours in the list lie apart in the picture, so that a pass shows evenly while it is made.
    tiles: Vec<Tile>,
    rays: RayCounts,
}

/// A square of pixels and what they have gathered.
#[derive(Clone, Debug)]
struct Tile {
    corner: [u32; 2],
    /// Bit per pixel that has had the pass in the making.
    done: u64,
    sums: [Vec3; TILE_RAYS],
    /// Of the first pass, through the pixels' centres.
    disparity: [f32; TILE_RAYS],
    triangle: [u32; TILE_RAYS],
}

impl Refinement {
    pub(super) fn new(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        trace: &TraceSettings,
        passes: u32,
    ) -> Self {
        Self {
            camera: *camera,
            view: View::new(camera, &tracer.scene().frame, size),
            epoch: tracer.epoch(),
            trace: *trace,
            passes,
            pass: 0,
            tiles: tiles(size),
            rays: RayCounts::default(),
        }
    }

    /// True where this is the picture of a pose.
    pub(super) fn is_of(
        &self,
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        trace: &TraceSettings,
    ) -> bool {
        let same_scene = self.epoch == tracer.epoch();
        same_scene && self.camera == *camera && self.view.size == size && self.trace == *trace
    }

    pub(super) fn state(&self) -> RefineState {
        RefineState { pass: self.pass, of: self.passes, is_complete: self.pass >= self.passes }
    }

    /// Takes a complete frame of mode `full` for the first pass, which is what it would be.
    pub(super) fn take_first_pass(&mut self, full: &Frame) {
        for tile in &mut self.tiles {
            for (i, pixel) in pixels_of_tile(tile.corner, full.view.size) {
                tile.sums[i] = full.radiance[pixel];
                tile.disparity[i] = full.disparity[pixel];
                tile.triangle[i] = full.triangle[pixel];
            }
        }
        self.pass = 1;
    }

    /// Goes on until all passes are done or `stop` says so; what is done then is kept.
    pub(super) fn run(&mut self, tracer: &Tracer, stop: Stop<'_>) {
        while self.pass < self.passes && self.run_pass(tracer, stop) {
            self.pass += 1;
            self.tiles.iter_mut().for_each(|tile| tile.done = 0);
        }
    }

    /// False after a stop.
    fn run_pass(&mut self, tracer: &Tracer, stop: Stop<'_>) -> bool {
        let view = self.view.shifted(offset_of_pass(self.pass, self.passes));
        let trace = TraceSettings { seed: seed_of_pass(self.trace.seed, self.pass), ..self.trace };
        let stopped = AtomicBool::new(false);
        let must_stop = || {
            let stops = stopped.load(Ordering::Relaxed) || stop();
            stops.then(|| stopped.store(true, Ordering::Relaxed)).is_some()
        };
        let work = |tile: &mut Tile| tile.trace(tracer, &view, &trace, self.pass == 0, &must_stop);
        let rays = self.tiles.par_iter_mut().map(work).reduce(RayCounts::default, |mut a, b| {
            a += b;
            a
        });
        self.rays += rays;
        !stopped.into_inner()
    }

    /// Shows in a frame of the same size what is done; pixels that have had no pass are left as they are.
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

    /// The pixels that have had a pass.
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

impl Tile {
    /// Traces the pixels that have not had this pass.
    fn trace(
        &mut self,
        tracer: &Tracer,
        view: &View,
        trace: &TraceSettings,
        is_first: bool,
        must_stop: &impl Fn() -> bool,
    ) -> RayCounts {
        let mut rays = RayCounts::default();
        for (i, pixel) in pixels_of_tile(self.corner, view.size) {
            if self.done >> i & 1 == 1 {
                continue;
            }
            if must_stop() {
                break;
            }
            let traced = tracer.pixel(view, pixel as u32, trace, &mut rays);
            self.take(i, &traced, is_first);
        }
        rays
    }

    fn take(&mut self, i: usize, traced: &PixelTrace, is_first: bool) {
        if is_first {
            self.disparity[i] = traced.hit.map_or(0.0, |hit| 1.0 / hit.t);
            self.triangle[i] = traced.hit.map_or(NO_TRIANGLE, |hit| hit.triangle);
        }
        self.sums[i] += traced.radiance;
        self.done |= 1 << i;
    }
}

/// All tiles of a picture, by Bayer's dispersed order of squares of four by four tiles.
fn tiles([width, height]: [u32; 2]) -> Vec<Tile> {
    let side = TILE_SIDE as u32;
    let mut corners: Vec<[u32; 2]> = (0..height.div_ceil(side))
        .flat_map(|row| (0..width.div_ceil(side)).map(move |column| [column, row]))
        .collect();
    corners.sort_by_key(|[column, row]| DISPERSED[(4 * (row % 4) + column % 4) as usize]);
    let empty = |corner: [u32; 2]| Tile {
        corner: corner.map(|c| c * side),
        done: 0,
        sums: [Vec3::ZERO; TILE_RAYS],
        disparity: [0.0; TILE_RAYS],
        triangle: [NO_TRIANGLE; TILE_RAYS],
    };
    corners.into_iter().map(empty).collect()
}

/// Place in the tile and row-major index of each pixel of a tile that lies in the picture.
pub(super) fn pixels_of_tile(
    [x0, y0]: [u32; 2],
    [width, height]: [u32; 2],
) -> impl Iterator<Item = (usize, usize)> {
    (0..TILE_RAYS).filter_map(move |i| {
        let (x, y) = (x0 + (i % TILE_SIDE) as u32, y0 + (i / TILE_SIDE) as u32);
        (x < width && y < height).then(|| (i, y as usize * width as usize + x as usize))
    })
}

/// Where in a pixel a pass of so many looks, in pixels from its centre: a lattice around the centre, so that the picture
/// does not shift, in an order whose beginnings are spread as well.
///
/// Source: the steps are multiples of the powers of the plastic number (Roberts 2018, the "R2" sequence). We differ: they
/// are rounded to whole parts of a pixel, because the mean of sixteen points of R2 lies a tenth of a pixel off.
pub(super) fn offset_of_pass(pass: u32, passes: u32) -> [f64; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let count = passes.max(1);
    STEPS.map(|step| {
        // Without a common factor every column and every row of the lattice is visited once.
        let is_apart = |step: &u32| greatest_common_divisor(*step, count) == 1;
        let off = |whole: u32| (f64::from(whole) - step * f64::from(count)).abs();
        let whole = (1..=count).filter(is_apart).min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(1);
        let part = (u64::from(pass) * u64::from(whole) % u64::from(count)) as f64 / f64::from(count);
        if part < 0.5 { part } else { part - 1.0 }
    })
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// The first pass has the settings' own seed. References count upwards from bit 32, passes from bit 48.
pub(super) fn seed_of_pass(seed: u64, pass: u32) -> u64 {
    seed.wrapping_add(u64::from(pass) << 48)
}

/// Renders a picture in full with so many rays through different points of each pixel: what a picture at rest becomes
/// after as many passes, bit for bit. With one pass it is the picture of mode `full`. Pixels that a stop left undone
/// show those around them, and the frame says that it is not complete.
pub fn render_antialiased(request: &FrameRequest<'_>, passes: u32) -> Frame {
    let FrameRequest { tracer, camera, size, settings, stop, .. } = *request;
    let start = Instant::now();
    let mut refinement = Refinement::new(tracer, camera, size, &settings.trace, passes.max(1));
    refinement.run(tracer, stop);
    let mut frame = Frame::empty();
    frame.reset(camera, &refinement.view);
    frame.types.fill(PixelType::Unseen);
    frame.supplier.fill(NO_SUPPLIER);
    refinement.write_to(&mut frame);
    if refinement.pass == 0 {
        let known = refinement.known_pixels();
        fill_unknown(&mut frame.radiance, &known, size[0] as usize, &mut Vec::new());
    }
    frame.stats.types = TypeCounts::of(&frame.types);
    frame.stats.rays = refinement.rays;
    frame.stats.is_complete = refinement.state().is_complete;
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
            // On a square grid they are one over the root of their number apart.
            assert!(least >= 0.5 / count.sqrt(), "{passes} passes: {least}");
        }
    }
}
