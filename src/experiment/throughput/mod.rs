//! The speed of the parts: rays by kind, the warp against what memory allows, shading.
//!
//! Rays are gathered first and timed alone, so that the figures are those of the hierarchy and can be set beside
//! another library's on the very same rays ([`RayDump`]). Every figure is the median of [`ROUNDS`] after one round
//! that is not counted.

pub mod feature_speed;
pub mod stage_speed;
pub mod warp_speed;

use crate::camera::{Camera, View};
use crate::experiment::run::report::{Block, Section, Table};
use crate::experiment::run::{
    Cell, CellOutcome, Effort, Experiment, ExperimentContext, ExperimentError, ExperimentSettings, Identity,
    Report, RunRecord,
};
use crate::experiment::statistics::median;
use crate::experiment::throughput::feature_speed::{FeatureSpeed, feature_speed};
use crate::experiment::throughput::stage_speed::{Floors, StageSpeed, stage_speed};
use crate::experiment::throughput::warp_speed::{WarpSpeed, warp_speed};
use crate::math::Ray;
use crate::math::key::Key;
use crate::math::sampling::{cosine_hemisphere, frame_around};
use crate::trace::parallel::{NEVER, Stop, tile_order, trace_pixels};
use crate::trace::{
    Bvh, RayBundle, RayCounts, SurfacePoint, TILE_SIDE, TileHits, TraceSettings, Tracer, primary_tile,
};
use rayon::prelude::*;
use serde::Serialize;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// Rounds timed of each figure.
pub const ROUNDS: usize = 5;

/// Rays of a kind at most; more would time the same at the price of memory.
const MAX_RAYS: usize = 8_000_000;

/// Rays a thread takes at a time.
const CHUNK: usize = 4096;

/// As a run folder: one cell, one line of figures.
pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "throughput",
    about: "the speed of the parts, each against its floor",
    settings: |effort| match effort {
        Effort::Quick => {
            ExperimentSettings { effort, size: [320, 180], samples: 4, ..ExperimentSettings::default() }
        }
        Effort::Usual => ExperimentSettings { effort, size: [1280, 720], ..ExperimentSettings::default() },
    },
    cells: |_| vec![Cell(RunRecord::default().with("part", "all"))],
    run_cell,
    report,
};

fn run_cell(context: &ExperimentContext<'_>, _: &RunRecord) -> CellOutcome {
    let none = || ExperimentError::Unsuitable("the walk has no key frames; it needs at least one".to_owned());
    let camera = context.walk.camera(0, 2).ok_or_else(none)?;
    let settings =
        ThroughputSettings { camera, size: context.settings.size, trace: context.settings.trace() };
    let measured = measure_throughput(context.tracer, &settings, context.stop, |_| ());
    Ok(measured.map(|(figures, _)| vec![RunRecord::default().with_fields(&figures)]))
}

/// The figures as they are; the summary has them under the names of the one-line answer.
fn report(identity: &Identity, records: &[RunRecord]) -> Report {
    let Some(figures) = records.first() else { return Report::default() };
    let mut summary = figures.0.clone();
    summary.remove("part");
    for name in ["size", "samples", "seed"] {
        summary.insert(name.to_owned(), identity.settings.0.get(name).cloned().unwrap_or_default());
    }
    let rows = figures.0.iter().filter(|(name, _)| *name != "part");
    let table = Table {
        title: "All figures; units are in the names".to_owned(),
        columns: vec!["figure".to_owned(), "value".to_owned()],
        rows: rows.map(|(name, value)| vec![name.clone().into(), value.clone()]).collect(),
    };
    let number = |name: &str| figures.number(name).unwrap_or(f64::NAN);
    let headline = format!(
        "{:.1} million primary and {:.1} million shadow rays a second on {} threads; the warp takes {:.1} times its memory \
         floor.",
        number("primary_mrays_per_sec"),
        number("shadow_mrays_per_sec"),
        number("threads"),
        number("warp_over_memory_floor"),
    );
    let section = Section { title: "The parts".to_owned(), blocks: vec![Block::Table(table)] };
    Report { headline: vec![headline], summary, sections: vec![section], ..Report::default() }
}

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThroughputSettings {
    /// The view.
    pub camera: Camera,
    /// Of the view.
    pub size: [u32; 2],
    /// Samples, bounces, seed of shading and of the shadow rays.
    pub trace: TraceSettings,
}

/// The speed of the parts. Rates count all threads together.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(missing_docs, reason = "the names say it; units are in them")]
pub struct Throughput {
    pub triangles: usize,
    pub threads: usize,
    pub primary_mrays_per_sec: f64,
    /// The same rays in tiles of eight by eight, as the modes that look up trace them.
    pub primary_tile_mrays_per_sec: f64,
    pub shadow_mrays_per_sec: f64,
    /// The same rays in bundles of one light, as shading traces them.
    pub shadow_bundle_mrays_per_sec: f64,
    pub diffuse_mrays_per_sec: f64,
    /// Steps 1 and 2 of the paper.
    #[serde(flatten)]
    pub warp: WarpSpeed,
    /// The stages of a frame that is looked up.
    #[serde(flatten)]
    pub stages: StageSpeed,
    /// What the scene does not need, forced on.
    #[serde(flatten)]
    #[serde(rename = "needs")]
    pub features: FeatureSpeed,
    /// All of a first hit's diffuse light, shadow rays included; divide by the threads for one thread's.
    pub shade_us_per_pixel: f64,
    pub build_secs: f64,
    pub bvh_bytes: usize,
    pub primary_rays: usize,
    pub shadow_rays: usize,
    pub diffuse_rays: usize,
}

/// The rays that were timed, in scene space.
#[derive(Clone, Debug, Default)]
pub struct RayDump {
    /// Nearest hit asked: primary, then diffuse.
    pub closest: Vec<Ray>,
    /// Any hit asked: shadow.
    pub any: Vec<Ray>,
}

/// The rays that [`measure_throughput`] times, without timing them.
pub fn gather_rays(tracer: &Tracer, settings: &ThroughputSettings) -> RayDump {
    let (primary, points) = first_hits(tracer, settings);
    let diffuse = diffuse_rays(&points, settings.trace.seed);
    let bundles = shadow_bundles(tracer, &points, &settings.trace);
    RayDump { closest: primary.into_iter().chain(diffuse).collect(), any: rays_of(&bundles) }
}

/// Primary rays in the order of tiles, and the surface points they meet.
fn first_hits(tracer: &Tracer, settings: &ThroughputSettings) -> (Vec<Ray>, Vec<(u32, SurfacePoint)>) {
    let view = View::new(&settings.camera, &tracer.scene().frame, settings.size);
    let order = tile_order(settings.size);
    let primary: Vec<Ray> = order.iter().map(|&p| Tracer::primary_ray(&view, p)).collect();
    let points = first_points(tracer, &order, &primary);
    (primary, points)
}

/// Times the parts on a view; `on_part` is told what is timed next. `None` after a stop.
pub fn measure_throughput(
    tracer: &Tracer,
    settings: &ThroughputSettings,
    stop: Stop<'_>,
    mut on_part: impl FnMut(&'static str),
) -> Option<(Throughput, RayDump)> {
    let view = View::new(&settings.camera, &tracer.scene().frame, settings.size);
    on_part("gathering rays");
    let (primary, points) = first_hits(tracer, settings);
    let diffuse = diffuse_rays(&points, settings.trace.seed);
    let bundles = shadow_bundles(tracer, &points, &settings.trace);
    let shadow = rays_of(&bundles);
    let bvh = tracer.bvh();
    let mut go_on = |part| {
        on_part(part);
        !stop()
    };
    let mut result = Throughput {
        triangles: tracer.scene().triangles.len(),
        threads: rayon::current_num_threads(),
        bvh_bytes: bvh.bytes(),
        primary_rays: primary.len(),
        shadow_rays: shadow.len(),
        diffuse_rays: diffuse.len(),
        ..Throughput::default()
    };
    go_on("primary rays").then(|| result.primary_mrays_per_sec = closest_rate(bvh, &primary))?;
    go_on("tiles of primary rays").then(|| result.primary_tile_mrays_per_sec = tile_rate(tracer, &view))?;
    go_on("shadow rays").then(|| result.shadow_mrays_per_sec = any_rate(bvh, &shadow))?;
    go_on("bundles of shadow rays")
        .then(|| result.shadow_bundle_mrays_per_sec = bundle_rate(bvh, &bundles, shadow.len()))?;
    go_on("diffuse rays").then(|| result.diffuse_mrays_per_sec = closest_rate(bvh, &diffuse))?;
    go_on("shading").then(|| result.shade_us_per_pixel = shade_us(tracer, &points, &settings.trace))?;
    go_on("the warp").then(|| result.warp = warp_speed(tracer, settings))?;
    let floors = Floors {
        primary_mrays_per_sec: result.primary_mrays_per_sec,
        primary_tile_mrays_per_sec: result.primary_tile_mrays_per_sec,
        memory_gb_per_sec: result.warp.memory_gb_per_sec,
    };
    go_on("the stages of a frame").then(|| result.stages = stage_speed(tracer, settings, &floors))?;
    result.features =
        go_on("the frame with every feature forced on").then(|| feature_speed(tracer, settings, stop))??;
    go_on("building").then(|| result.build_secs = build_secs(tracer))?;
    let closest = primary.into_iter().chain(diffuse).collect();
    Some((result, RayDump { closest, any: shadow }))
}

impl RayDump {
    /// The triangles and the rays in a form other programs read, little-endian: `RAYS0001`, the number of triangles
    /// as u64, their corners as f32; then twice (nearest hit, any hit) the number of rays as u64 and eight f32 each:
    /// origin, smallest t, direction, largest t.
    pub fn to_bytes(&self, tracer: &Tracer) -> Vec<u8> {
        let scene = tracer.scene();
        let count = scene.triangles.len();
        let mut bytes = b"RAYS0001".to_vec();
        bytes.reserve(24 + count * 36 + (self.closest.len() + self.any.len()) * 32);
        bytes.extend_from_slice(&(count as u64).to_le_bytes());
        let corners = (0..count as u32).flat_map(|t| scene.corners(t)).flat_map(|c| c.to_array());
        corners.for_each(|c| bytes.extend_from_slice(&c.to_le_bytes()));
        for rays in [&self.closest, &self.any] {
            bytes.extend_from_slice(&(rays.len() as u64).to_le_bytes());
            for ray in rays {
                let (o, d) = (ray.origin, ray.direction);
                let numbers = [o.x, o.y, o.z, 0.0, d.x, d.y, d.z, ray.t_max];
                numbers.iter().for_each(|n| bytes.extend_from_slice(&n.to_le_bytes()));
            }
        }
        bytes
    }
}

/// The median seconds of a task, after a round that is not counted.
pub(crate) fn median_secs(task: impl FnMut()) -> f64 {
    median_secs_after(|| (), task)
}

/// The same, with something done before each round that is not timed.
pub(crate) fn median_secs_after(mut before: impl FnMut(), mut task: impl FnMut()) -> f64 {
    task();
    let timed = (0..ROUNDS).map(|_| {
        before();
        let start = Instant::now();
        task();
        start.elapsed().as_secs_f64()
    });
    median(timed).unwrap_or(f64::NAN)
}

fn rate_of(rays: &[Ray], count_hits: impl Fn(&Ray) -> bool + Sync) -> f64 {
    if rays.is_empty() {
        return 0.0;
    }
    let secs = median_secs(|| {
        let hits = |chunk: &[Ray]| chunk.iter().filter(|r| count_hits(r)).count();
        black_box(rays.par_chunks(CHUNK).map(hits).sum::<usize>());
    });
    rays.len() as f64 / secs / 1e6
}

/// Cut-out texels and glass count as surfaces: other libraries do the same, and the rays stay comparable.
fn closest_rate(bvh: &Bvh, rays: &[Ray]) -> f64 {
    rate_of(rays, |ray| bvh.closest(ray, |_| true).is_some())
}

fn any_rate(bvh: &Bvh, rays: &[Ray]) -> f64 {
    rate_of(rays, |ray| bvh.any(ray, |_| true))
}

fn bundle_rate(bvh: &Bvh, bundles: &[RayBundle], rays: usize) -> f64 {
    let secs = median_secs(|| {
        let blocked = |chunk: &[RayBundle]| {
            chunk.iter().map(|bundle| bvh.any_at_all_in_bundle(bundle).count_ones()).sum::<u32>()
        };
        black_box(bundles.par_chunks(CHUNK / 16).map(blocked).sum::<u32>());
    });
    if rays == 0 { 0.0 } else { rays as f64 / secs / 1e6 }
}

/// Rays in tiles, cut-out texels tested; those beyond the picture's edge are not counted.
fn tile_rate(tracer: &Tracer, view: &View) -> f64 {
    let side = TILE_SIDE as u32;
    let [columns, rows] = view.size.map(|s| s.div_ceil(side));
    let secs = median_secs(|| {
        let hits = |row: u32| {
            let (mut rays, mut hits) = (primary_tile(view, [0, 0]), TileHits::NONE);
            (0..columns)
                .filter(|column| {
                    tracer.closest_in_tile(view, [column * side, row * side], &mut rays, &mut hits);
                    hits.hit(0).is_some()
                })
                .count()
        };
        black_box((0..rows).into_par_iter().map(hits).sum::<usize>());
    });
    view.pixel_count() as f64 / secs / 1e6
}

/// The surface points that primary rays meet, with their pixels.
fn first_points(tracer: &Tracer, order: &[u32], primary: &[Ray]) -> Vec<(u32, SurfacePoint)> {
    let point =
        |(&pixel, ray): (&u32, &Ray)| tracer.closest(ray).map(|hit| (pixel, tracer.surface(ray, &hit)));
    order.par_iter().zip(primary).filter_map(point).collect()
}

fn diffuse_rays(points: &[(u32, SurfacePoint)], seed: u64) -> Vec<Ray> {
    let ray = |(pixel, point): &(u32, SurfacePoint)| {
        let direction = cosine_hemisphere(Key::of_pixel(seed, *pixel).with(u32::MAX).pair());
        Ray::new(point.origin_in_front(), frame_around(point.geometric_normal) * direction)
    };
    points.iter().map(ray).collect()
}

/// The shadow rays that shading the points traces, of evenly spread points where there are too many.
fn shadow_bundles(tracer: &Tracer, points: &[(u32, SurfacePoint)], trace: &TraceSettings) -> Vec<RayBundle> {
    let of_point = |bundles: &mut Vec<RayBundle>, (pixel, point): &(u32, SurfacePoint)| {
        tracer.shadow_bundles(point, trace.samples, Key::of_pixel(trace.seed, *pixel), bundles);
    };
    let mut probe = Vec::new();
    points.iter().step_by(997).for_each(|p| of_point(&mut probe, p));
    let rays: usize = probe.iter().map(RayBundle::len).sum();
    let step = (rays * 997).div_ceil(MAX_RAYS).max(1);
    let mut bundles = Vec::new();
    points.iter().step_by(step).for_each(|p| of_point(&mut bundles, p));
    bundles
}

fn rays_of(bundles: &[RayBundle]) -> Vec<Ray> {
    bundles.iter().flat_map(RayBundle::rays).collect()
}

fn shade_us(tracer: &Tracer, points: &[(u32, SurfacePoint)], trace: &TraceSettings) -> f64 {
    let indices: Vec<u32> = (0..points.len() as u32).collect();
    let mut shaded = Vec::new();
    let secs = median_secs(|| {
        trace_pixels(&indices, &mut shaded, NEVER, |i, rays: &mut RayCounts| {
            let (pixel, point) = &points[i as usize];
            tracer.diffuse_radiance(point, 1.0, trace, Key::of_pixel(trace.seed, *pixel), rays)
        });
        black_box(&shaded);
    });
    secs * 1e6 / points.len().max(1) as f64
}

fn build_secs(tracer: &Tracer) -> f64 {
    let scene = tracer.scene();
    let builds = (0..ROUNDS).map(|_| Tracer::new(Arc::clone(scene)).build_secs());
    median(builds).unwrap_or(f64::NAN)
}
