//! The record of a whole walk.

use super::reference_usage::ReferenceUsage;
use crate::experiment::measure::Measurement;
use crate::experiment::run::RunRecord;
use crate::experiment::statistics::{median, percentile};
use crate::experiment::tour::{FrameRecord, TourRecord};
use crate::raster::exposure::decimal;

/// The record of a whole walk.
pub(super) fn summary(tour: &TourRecord, usage: &ReferenceUsage) -> RunRecord {
    let frames = &tour.frames;
    let of = |value: fn(&FrameRecord) -> f64| frames.iter().map(value);
    let mean =
        |value: fn(&FrameRecord) -> f64| of(value).fold(0.0, |a, b| a + b) / frames.len().max(1) as f64;
    let in_references: u64 = tour.references.iter().map(|r| r.rays.total()).sum();
    let in_frames: u64 = frames.iter().map(|f| f.rays.total()).sum();
    let measured = |value: fn(&Measurement) -> f64| {
        median(frames.iter().filter_map(|f| f.measurement.as_ref()).map(value))
    };
    let tracing_secs = tour.reference_secs_total + of(|f| f.trace_secs + f.secondary_secs).sum::<f64>();
    RunRecord::default()
        .with("kind", "summary")
        .with("references", tour.references_added)
        .with("reference_secs", tour.reference_secs_total)
        .with("tracing_secs", tracing_secs)
        .with("reference_mrays", in_references as f64 / 1e6)
        .with("traced_mrays", (in_references + in_frames) as f64 / 1e6)
        .with("type3_percent", mean(|f| f.types.type3_percent))
        .with("unseen_percent", mean(|f| f.types.unseen_percent))
        .with("unseen_p95_percent", percentile(of(|f| f.types.unseen_percent), 95.0))
        .with("frame_secs", median(of(|f| f.frame_secs)))
        .with("frame_p99_secs", percentile(of(|f| f.frame_secs), 99.0))
        .with("psnr_db", measured(|m| m.psnr_db))
        .with("flip_mean", measured(|m| m.flip_mean))
        .with("exposure_ev", measured(|m| decimal(m.exposure_ev)))
        .with("cache_mb", usage.max_bytes() as f64 / (1 << 20) as f64)
        .with("prediction_use_percent", usage.prediction_use_percent())
        .with("predictions", usage.predictions())
}
