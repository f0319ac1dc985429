//! Arrows against the rules that are still to be mended.

/// Importing and defining file of each, below `src` or `ui/src`. Without these imports no circle is
/// left.
pub(super) const KNOWN: &[(&str, &str)] = &[
    // experiment
    ("experiment/error_time/mod.rs", "experiment/error_time/pictures.rs"),
    ("experiment/error_time/mod.rs", "experiment/error_time/report.rs"),
    ("experiment/placement/report.rs", "experiment/placement/mod.rs"),
    ("experiment/run/mod.rs", "experiment/error_time/mod.rs"),
    ("experiment/run/mod.rs", "experiment/placement/mod.rs"),
    ("experiment/run/mod.rs", "experiment/run/folder.rs"),
    ("experiment/run/mod.rs", "experiment/run/journal.rs"),
    ("experiment/run/mod.rs", "experiment/run/merge.rs"),
    ("experiment/run/mod.rs", "experiment/scaling/mod.rs"),
    ("experiment/run/mod.rs", "experiment/soak.rs"),
    ("experiment/run/mod.rs", "experiment/stability/mod.rs"),
    ("experiment/run/mod.rs", "experiment/table1/mod.rs"),
    ("experiment/run/mod.rs", "experiment/throughput/mod.rs"),
    ("experiment/scaling/report.rs", "experiment/scaling/mod.rs"),
    ("experiment/stability/mod.rs", "experiment/stability/artefacts.rs"),
    ("experiment/stability/mod.rs", "experiment/stability/cache.rs"),
    ("experiment/stability/mod.rs", "experiment/stability/camera.rs"),
    ("experiment/stability/mod.rs", "experiment/stability/geometry.rs"),
    ("experiment/stability/mod.rs", "experiment/stability/materials.rs"),
    ("experiment/stability/mod.rs", "experiment/stability/scale.rs"),
    ("experiment/stability/mod.rs", "experiment/stability/theorems.rs"),
    ("experiment/table1/mod.rs", "experiment/table1/views.rs"),
    ("experiment/table1/report.rs", "experiment/table1/mod.rs"),
    ("experiment/throughput/mod.rs", "experiment/throughput/feature_speed.rs"),
    ("experiment/throughput/mod.rs", "experiment/throughput/stage_speed.rs"),
    ("experiment/throughput/mod.rs", "experiment/throughput/warp_speed.rs"),
    // trace
    ("trace/bvh/cone.rs", "trace/bvh/bundle.rs"),
    ("trace/bvh/packet.rs", "trace/bvh/mod.rs"),
];
