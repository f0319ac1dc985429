//! What a walk leaves behind: one record a frame, one a reference, and the sum of it.
//!
//! Seconds, metres, degrees, percent. The names are those of the command line's contract.

use crate::camera::Camera;
use crate::experiment::measure::Measurement;
use crate::experiment::statistics::{median, percentile};
use crate::raster::pixel_types::TypePercentages;
use crate::render::{AuditEstimate, TemporalStability};
use crate::trace::RayCounts;
use serde::Serialize;

/// Where a frame or a reference was taken, in words that `--eye`, `--look-at` and `--fov-y` take.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pose {
    /// World metres.
    pub eye: [f64; 3],
    /// A point one metre ahead, world metres.
    pub look_at: [f64; 3],
    /// Vertical, degrees.
    pub fov_y_deg: f64,
}

impl From<&Camera> for Pose {
    fn from(camera: &Camera) -> Self {
        Self {
            eye: camera.eye.to_array(),
            look_at: (camera.eye + camera.forward()).to_array(),
            fov_y_deg: camera.fov_y.to_degrees(),
        }
    }
}

/// One frame of a walk.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameRecord {
    /// From 0.
    pub frame: u32,
    /// Where.
    pub pose: Pose,
    /// How its pixels came to their colours.
    pub types: TypePercentages,
    /// References warped.
    pub references_used: usize,
    /// References in the cache.
    pub references_held: usize,
    /// Reference pixels warped.
    pub warped_pixels: usize,
    /// All stages; references and measuring left out.
    pub frame_secs: f64,
    /// Choosing references.
    pub select_secs: f64,
    /// Warping, classifying, copying.
    pub warp_secs: f64,
    /// Type 2.
    pub secondary_secs: f64,
    /// Type 3.
    pub trace_secs: f64,
    /// Checking pixels.
    pub audit_secs: f64,
    /// What checks say of this frame and those before it, where frames are checked.
    pub audit: Option<AuditEstimate>,
    /// What it has in common with the frame before it, where frames are measured.
    #[serde(rename = "steadiness")]
    pub temporal_stability: Option<TemporalStability>,
    /// False where it was cut at the budget.
    pub is_complete: bool,
    /// Rays by purpose; those of checks left out.
    pub rays: RayCounts,
    /// A reference was traced after this frame.
    pub reference_added: bool,
    /// What it took.
    pub reference_secs: f64,
    /// How good the picture is, where that was asked.
    pub measurement: Option<Measurement>,
}

/// One reference of a walk.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceRecord {
    /// Running number.
    pub reference: u32,
    /// The frame after which it was traced.
    pub after_frame: u32,
    /// It was traced before frame 0 instead.
    pub is_ahead: bool,
    /// Where.
    pub pose: Pose,
    /// What it took.
    pub secs: f64,
    /// Rays by purpose.
    pub rays: RayCounts,
    /// Memory it holds.
    pub bytes: usize,
}

/// A whole walk.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TourRecord {
    /// Frame by frame.
    pub frames: Vec<FrameRecord>,
    /// How many references were traced.
    pub references_added: usize,
    /// Seconds they took together.
    pub reference_secs_total: f64,
    /// Seconds of the frame rendered before the walk to warm the machine up; it counts nowhere.
    pub warm_up_secs: f64,
    /// False where the walk was stopped early.
    pub is_complete: bool,
    /// The sum of it.
    pub summary: Summary,
    /// One by one.
    #[serde(skip)]
    pub references: Vec<ReferenceRecord>,
}

/// A walk in a few numbers. Without frames all are absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(missing_docs, reason = "the names say it; units are in them")]
pub struct Summary {
    pub frame_secs_median: Option<f64>,
    pub frame_secs_p99: Option<f64>,
    pub type3_percent_median: Option<f64>,
    pub type3_percent_max: Option<f64>,
    pub warp_ns_per_reference_pixel: Option<f64>,
    pub rays_per_sec: Option<f64>,
    /// Median share of surface points whose pixel came to its colour in another way than in the frame before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flips_percent_median: Option<f64>,
    /// Median of the PSNR between the same matte points in two frames.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steadiness_psnr_db_median: Option<f64>,
    /// Frames cut at the budget, in percent.
    pub cut_percent: f64,
    #[serde(flatten)]
    pub measured: Option<MeasuredSummary>,
}

/// The part of a summary that only a measured walk has.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(missing_docs, reason = "the names say it; units are in them")]
pub struct MeasuredSummary {
    pub measured_frames: usize,
    pub full_frame_secs_median: f64,
    /// Of the medians; what references cost is left out.
    pub speedup: f64,
    /// Of the whole walk, every second spent on references counted, against tracing every frame in full.
    pub speedup_with_references: f64,
    pub psnr_db_median: f64,
    pub psnr_db_min: f64,
    pub full_psnr_db_median: f64,
    pub flip_mean_median: f64,
    pub full_flip_mean_median: f64,
    pub see_through_percent_median: f64,
    pub truth_samples: u32,
    /// A picture without any noise would be measured at about this PSNR, because the truth has noise of its own.
    pub truth_noise_psnr_db: f64,
    pub noise: String,
}

impl TourRecord {
    /// Sums up what was recorded. `samples` and `truth_samples` are shadow samples of the frames and of the truth.
    pub fn new(
        frames: Vec<FrameRecord>,
        references: Vec<ReferenceRecord>,
        warm_up_secs: f64,
        is_complete: bool,
        [samples, truth_samples]: [u32; 2],
    ) -> Self {
        // Not `sum`, which makes -0 of nothing.
        let reference_secs_total = references.iter().fold(0.0, |sum, r| sum + r.secs);
        let mut summary = Summary::of(&frames);
        summary.measured = MeasuredSummary::of(&frames, reference_secs_total, samples, truth_samples);
        Self {
            frames,
            references_added: references.len(),
            reference_secs_total,
            warm_up_secs,
            is_complete,
            summary,
            references,
        }
    }
}

impl Summary {
    fn of(frames: &[FrameRecord]) -> Self {
        let type3 = || frames.iter().map(|f| f.types.type3_percent);
        let frame_secs = || frames.iter().map(|f| f.frame_secs);
        let warps = frames.iter().filter(|f| f.warped_pixels > 0);
        let all_rays: u64 = frames.iter().map(|f| f.rays.total()).sum();
        let steady = || frames.iter().filter_map(|f| f.temporal_stability);
        let cut = frames.iter().filter(|f| !f.is_complete).count();
        let ray_secs: f64 = frames.iter().map(|f| f.secondary_secs + f.trace_secs).sum();
        Self {
            frame_secs_median: median(frame_secs()),
            frame_secs_p99: percentile(frame_secs(), 99.0),
            type3_percent_median: median(type3()),
            type3_percent_max: type3().max_by(f64::total_cmp),
            warp_ns_per_reference_pixel: median(warps.map(|f| f.warp_secs * 1e9 / f.warped_pixels as f64)),
            rays_per_sec: (ray_secs > 0.0).then(|| all_rays as f64 / ray_secs),
            flips_percent_median: median(steady().map(|s| s.flips_percent)),
            steadiness_psnr_db_median: median(steady().map(|s| s.psnr_db)),
            cut_percent: 100.0 * cut as f64 / frames.len().max(1) as f64,
            measured: None,
        }
    }
}

impl MeasuredSummary {
    fn of(frames: &[FrameRecord], reference_secs: f64, samples: u32, truth_samples: u32) -> Option<Self> {
        let measured: Vec<&Measurement> = frames.iter().filter_map(|f| f.measurement.as_ref()).collect();
        let of = |value: fn(&Measurement) -> f64| measured.iter().map(move |m| value(m));
        let full_frame_secs_median = median(of(|m| m.full_frame_secs))?;
        let frame_secs_median = median(frames.iter().map(|f| f.frame_secs))?;
        let walk_secs = frames.iter().map(|f| f.frame_secs).sum::<f64>() + reference_secs;
        let full_psnr_db_median = median(of(|m| m.full_psnr_db))?;
        // The variance of both falls with the samples: full's error is its own noise plus the truth's.
        let ratio = f64::from(samples + truth_samples) / f64::from(samples.max(1));
        let truth_noise_psnr_db = full_psnr_db_median + 10.0 * ratio.log10();
        Some(Self {
            measured_frames: measured.len(),
            full_frame_secs_median,
            speedup: full_frame_secs_median / frame_secs_median,
            speedup_with_references: full_frame_secs_median * frames.len() as f64 / walk_secs,
            psnr_db_median: median(of(|m| m.psnr_db))?,
            psnr_db_min: of(|m| m.psnr_db).min_by(f64::total_cmp)?,
            full_psnr_db_median,
            flip_mean_median: median(of(|m| m.flip_mean))?,
            full_flip_mean_median: median(of(|m| m.full_flip_mean))?,
            see_through_percent_median: median(of(|m| m.see_through_percent))?,
            truth_samples,
            truth_noise_psnr_db,
            noise: format!(
                "the truth has {truth_samples} shadow samples per light and a seed of its own; a PSNR above \
                 about {truth_noise_psnr_db:.0} dB cannot be told from its noise"
            ),
        })
    }
}
