//! Measures the speed of every stage on one view.

use super::feature_speed::{FeatureSpeed, feature_speed};
use super::ray_speed::{any_rate, build_secs, bundle_rate, closest_rate, shade_us, tile_rate};
use super::rays::{RayDump, diffuse_rays, first_hits, rays_of, shadow_bundles};
use super::settings::ThroughputSettings;
use super::stage_speed::{Floors, StageSpeed, stage_speed};
use super::visibility_speed::{VisibilitySpeed, visibility_speed};
use super::warp_speed::{WarpSpeed, warp_speed};
use crate::camera::View;
use crate::experiment::run::{CellOutcome, ExperimentContext, RunRecord};
use crate::trace::{Tracer, parallel::Stop};
use serde::Serialize;

pub(crate) fn run_cell(context: &ExperimentContext<'_>, _: &RunRecord) -> CellOutcome {
    let camera = context.camera_on_walk(0.0)?;
    let settings =
        ThroughputSettings { camera, size: context.settings.size, trace: context.settings.trace() };
    let measured = measure_throughput(context.tracer, &settings, context.stop, |_| ());
    Ok(measured.map(|(figures, _)| vec![RunRecord::default().with_fields(&figures)]))
}

/// The speed of every stage. Rates count all threads together.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(missing_docs, reason = "the names say it; units are in them")]
pub struct Throughput {
    pub triangles: usize,
    pub threads: usize,
    pub primary_mrays_per_sec: f64,
    /// Primary rays in tiles of 8 x 8 pixels.
    pub primary_tile_mrays_per_sec: f64,
    /// First hits by rasterised candidates, as all modes find them.
    #[serde(flatten)]
    pub visibility: VisibilitySpeed,
    pub shadow_mrays_per_sec: f64,
    /// Shadow rays in bundles toward one light, as shading traces them.
    pub shadow_bundle_mrays_per_sec: f64,
    pub diffuse_mrays_per_sec: f64,
    /// Steps 1 and 2 of the paper.
    #[serde(flatten)]
    pub warp: WarpSpeed,
    /// The stages of a frame in mode `exact`.
    #[serde(flatten)]
    pub stages: StageSpeed,
    /// The cost of features that the scene does not need.
    #[serde(flatten)]
    pub features: FeatureSpeed,
    /// Microseconds of wall time for the diffuse light of one first hit, shadow rays included, on
    /// all threads.
    pub shade_us_per_pixel: f64,
    pub build_secs: f64,
    pub bvh_bytes: usize,
    pub primary_rays: usize,
    pub shadow_rays: usize,
    pub diffuse_rays: usize,
}

/// Times every stage on a view and returns the figures with the rays that were timed. `on_part`
/// receives the name of each stage before it is timed. `None` after a stop.
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
    let mut begin = |part| {
        on_part(part);
        (!stop()).then_some(())
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
    begin("primary rays")?;
    result.primary_mrays_per_sec = closest_rate(bvh, &primary);
    begin("tiles of primary rays")?;
    result.primary_tile_mrays_per_sec = tile_rate(tracer, &view);
    begin("visibility")?;
    result.visibility = visibility_speed(tracer, &view);
    begin("shadow rays")?;
    result.shadow_mrays_per_sec = any_rate(bvh, &shadow);
    begin("bundles of shadow rays")?;
    result.shadow_bundle_mrays_per_sec = bundle_rate(bvh, &bundles, shadow.len());
    begin("diffuse rays")?;
    result.diffuse_mrays_per_sec = closest_rate(bvh, &diffuse);
    begin("shading")?;
    result.shade_us_per_pixel = shade_us(tracer, &points, &settings.trace);
    begin("the warp")?;
    result.warp = warp_speed(tracer, settings);
    let floors = Floors {
        primary_mrays_per_sec: result.primary_mrays_per_sec,
        primary_tile_mrays_per_sec: result.primary_tile_mrays_per_sec,
        visibility_ns_per_pixel: result.visibility.visibility_ns_per_pixel,
        memory_gb_per_sec: result.warp.memory_gb_per_sec,
    };
    begin("the stages of a frame")?;
    result.stages = stage_speed(tracer, settings, &floors);
    begin("the frame with every feature forced on")?;
    result.features = feature_speed(tracer, settings, stop)?;
    begin("building the hierarchy")?;
    result.build_secs = build_secs(tracer);
    let closest = primary.into_iter().chain(diffuse).collect();
    Some((result, RayDump { closest, any: shadow }))
}
