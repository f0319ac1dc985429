//! `afterimage experiment throughput` without a folder: measures the speed of each stage, and
//! prints it.

use super::args::ExperimentArgs;
use crate::cli::scene::{Loaded, load};
use crate::cli::{failure::Failure, flags::Flags, interrupt, output, pose::camera};
use crate::picture::memory;
use afterimage::experiment::throughput::{Throughput, ThroughputSettings, measure_throughput};
use afterimage::raster::save::write_atomically;
use afterimage::trace::{BounceLimit, TraceSettings};
use serde_json::{Value, json};

/// Measures and prints; no folder is written.
pub(super) fn run(args: &ExperimentArgs, flags: &Flags) -> Result<(), Failure> {
    memory::check(flags.pixels(), 1)?;
    let loaded = load(Some(args.scene()?), flags)?;
    let camera = camera(flags, loaded.scene())?;
    let settings = ThroughputSettings { camera, size: flags.size(), trace: trace(flags) };
    let stop = interrupt::is_cancelled;
    let timing = |part: &str| output::say(&format!("timing: {part}"));
    let (throughput, rays) =
        measure_throughput(&loaded.tracer, &settings, &stop, timing).ok_or(Failure::Interrupted)?;
    let object = object(flags, &loaded, &throughput);
    if let Some(path) = &args.dump_rays {
        write_atomically(path, &rays.to_bytes(&loaded.tracer))?;
    }
    output::result(flags.json, &object, || table(&throughput));
    loaded.verdict(flags)
}

/// Settings of the timed stages: direct light unless a flag or setting gives bounces.
fn trace(flags: &Flags) -> TraceSettings {
    TraceSettings { bounces: flags.bounces.unwrap_or(BounceLimit::NONE).0, ..flags.trace() }
}

fn object(flags: &Flags, loaded: &Loaded, throughput: &Throughput) -> Value {
    let mut object = json!({
        "experiment": "throughput",
        "scene": loaded.name,
        "scene_hash": loaded.scene().hash,
        "stiffness": loaded.scene().conditioning,
        "version": env!("CARGO_PKG_VERSION"),
        "size": flags.size(),
        "samples": flags.trace().samples,
        "bounces": trace(flags).bounce_limit(),
        "seed": flags.seed,
    });
    output::extend(&mut object, throughput);
    object
}

fn table(t: &Throughput) -> String {
    let rate = |mrays: f64, count: usize| format!("{mrays:.2} Mrays/s ({count} rays)");
    let rows = [
        ("threads", t.threads.to_string()),
        ("primary", rate(t.primary_mrays_per_sec, t.primary_rays)),
        ("primary, tiles", rate(t.primary_tile_mrays_per_sec, t.primary_rays)),
        (
            "visibility",
            format!(
                "{:.1} ns per pixel; on one core {:.1}, by tiles {:.1}; {:.2} % by single rays",
                t.visibility.visibility_ns_per_pixel,
                t.visibility.visibility_ns_per_pixel_one_core,
                t.visibility.primary_tile_ns_per_pixel_one_core,
                t.visibility.visibility_fallback_percent
            ),
        ),
        ("shadow", rate(t.shadow_mrays_per_sec, t.shadow_rays)),
        ("shadow, in bundles", rate(t.shadow_bundle_mrays_per_sec, t.shadow_rays)),
        ("diffuse", rate(t.diffuse_mrays_per_sec, t.diffuse_rays)),
        (
            "warp",
            format!(
                "{:.2} ns per reference pixel; on one core {:.2}, from memory {:.2}: {:.1} times the lower bound at {:.1} GB/s",
                t.warp.warp_ns_per_reference_pixel,
                t.warp.warp_ns_per_reference_pixel_one_core,
                t.warp.warp_from_memory_ns_per_reference_pixel_one_core,
                t.warp.warp_over_memory_floor,
                t.warp.memory_gb_per_sec_one_core
            ),
        ),
        ("shading", format!("{:.2} us per pixel", t.shade_us_per_pixel)),
        (
            "hierarchy",
            format!(
                "{} triangles, {:.1} MB, built in {:.3} s",
                t.triangles,
                t.bvh_bytes as f64 / 1e6,
                t.build_secs
            ),
        ),
    ];
    output::table(&[&rows[..], &stages(t)].concat())
}

fn stages(t: &Throughput) -> Vec<(&'static str, String)> {
    vec![
        (
            "look-up",
            format!(
                "{:.1} ns per pixel (lower bound {:.1}); with visibility {:.1}; on one core {:.1}, mode fast {:.1}",
                t.stages.lookup_ns_per_pixel,
                t.stages.lookup_floor_ns_per_pixel,
                t.stages.resolve_ns_per_pixel,
                t.stages.lookup_ns_per_pixel_one_core,
                t.stages.lookup_fast_ns_per_pixel_one_core
            ),
        ),
        (
            "uncertain pixels",
            format!(
                "{:.2} us per pixel, {:.2} once traced ({} pixels)",
                t.stages.check_new_us_per_pixel, t.stages.check_known_us_per_pixel, t.stages.checked_pixels
            ),
        ),
        (
            "mirrors and glass",
            format!(
                "{:.2} us per pixel, {:.2} once traced (lower bound {:.2}; {} pixels)",
                t.stages.secondary_new_us_per_pixel,
                t.stages.secondary_known_us_per_pixel,
                t.stages.secondary_floor_us_per_pixel,
                t.stages.secondary_pixels
            ),
        ),
        ("foresight", against(t.stages.foresight_ms, t.stages.foresight_floor_ms)),
        ("adding a reference", against(t.stages.directory_ms, t.stages.directory_floor_ms)),
        (
            "features forced on",
            format!(
                "full frames {:+.1} %, exact {:+.1} %",
                t.features.forced_full_percent, t.features.forced_exact_percent
            ),
        ),
    ]
}

fn against(ms: f64, floor_ms: f64) -> String {
    format!("{ms:.1} ms (lower bound {floor_ms:.1})")
}
