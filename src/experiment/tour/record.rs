//! Records of a tour: one per frame, one per reference, and a summary.
//!
//! The names are part of the command line's interface; units are seconds, metres, degrees and
//! percent.

use crate::camera::Camera;
use crate::experiment::measure::Measurement;
use crate::experiment::statistics::{geometric_mean, median, percentile};
use crate::raster::{exposure::serialize_decimal, pixel_types::TypePercentages};
use crate::render::{AuditEstimate, TemporalStability};
use crate::store::StoreSession;
use crate::trace::RayCounts;
use serde::Serialize;

/// Camera of a frame or a reference, in the form of `--eye`, `--look-at` and `--fov-y`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pose {
    /// Position of the eye, world metres.
    pub eye: [f64; 3],
    /// Point one metre ahead of the eye, world metres.
    pub look_at: [f64; 3],
    /// Vertical field of view in degrees.
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

/// Record of one frame. Times are in seconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameRecord {
    /// Number of the frame, from 0.
    pub frame: u32,
    /// Camera of the frame.
    pub pose: Pose,
    /// Shares of the pixel types.
    pub types: TypePercentages,
    /// Number of references that were used.
    pub references_used: usize,
    /// Number of references in the cache.
    pub references_held: usize,
    /// Number of reference pixels that were warped.
    pub warped_pixels: usize,
    /// Time of all stages, without tracing references and measuring.
    pub frame_secs: f64,
    /// Time of selecting references.
    pub select_secs: f64,
    /// Time of warping, classifying and copying; in look-up modes, of visibility and look-up.
    pub warp_secs: f64,
    /// Time of the pixels of Type 2.
    pub secondary_secs: f64,
    /// Time of the pixels of Type 3.
    pub trace_secs: f64,
    /// Time of the audit.
    pub audit_secs: f64,
    /// Estimate of the audit over this frame and those before it, if frames are audited.
    pub audit: Option<AuditEstimate>,
    /// Comparison with the previous frame, if frames are measured.
    #[serde(rename = "steadiness")]
    pub temporal_stability: Option<TemporalStability>,
    /// False if the frame reached its time limit.
    pub is_complete: bool,
    /// Rays by purpose, without those of the audit.
    pub rays: RayCounts,
    /// True if a reference was traced after this frame.
    pub reference_added: bool,
    /// Time of tracing that reference.
    pub reference_secs: f64,
    /// Errors of the frame, if it was measured.
    pub measurement: Option<Measurement>,
}

/// Record of one reference. Times are in seconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceRecord {
    /// Number of the reference, from 0.
    pub reference: u32,
    /// Number of the frame after which it was traced.
    pub after_frame: u32,
    /// True if it was traced before frame 0.
    pub is_ahead: bool,
    /// Camera of the reference.
    pub pose: Pose,
    /// Time of tracing it.
    pub secs: f64,
    /// Rays by purpose.
    pub rays: RayCounts,
    /// Memory in bytes.
    pub bytes: usize,
}

/// What a tour took from a store of references, and gave to it. Zeros without a store.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StoreRecord {
    /// References that were read instead of traced.
    pub references_from_store: usize,
    /// References that were written.
    pub references_to_store: u64,
    /// Size of the store afterwards, bytes.
    pub store_bytes: u64,
    /// Time in seconds that opening, searching, reading and completing the store took. Writing goes
    /// on during the frames, and takes its time from theirs.
    pub store_secs: f64,
}

impl StoreRecord {
    /// What was read from a store and written to it so far.
    pub fn of(store: &StoreSession) -> Self {
        let report = store.report();
        Self {
            references_from_store: report.references_read,
            references_to_store: report.written.records,
            store_bytes: store.bytes(),
            store_secs: report.secs,
        }
    }
}

/// The parts of a tour, before they are summarised.
pub(super) struct FlownTour {
    pub(super) frames: Vec<FrameRecord>,
    pub(super) references: Vec<ReferenceRecord>,
    pub(super) warm_up_secs: f64,
    pub(super) is_complete: bool,
    pub(super) store: StoreRecord,
}

/// A whole tour.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TourRecord {
    /// Records of the frames.
    pub frames: Vec<FrameRecord>,
    /// Number of references that were traced.
    pub references_added: usize,
    /// Total time of tracing references.
    pub reference_secs_total: f64,
    /// What came from a store of references and went to it.
    #[serde(flatten)]
    pub store: StoreRecord,
    /// Time of the warm-up frame before the walk, which is not counted anywhere.
    pub warm_up_secs: f64,
    /// False if the walk was stopped early.
    pub is_complete: bool,
    /// Summary of the tour.
    pub summary: Summary,
    /// Records of the references.
    #[serde(skip)]
    pub references: Vec<ReferenceRecord>,
}

/// A tour in a few numbers. Without frames all values are absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(missing_docs, reason = "the names say it; units are in them")]
pub struct Summary {
    pub frame_secs_median: Option<f64>,
    pub frame_secs_p99: Option<f64>,
    pub type3_percent_median: Option<f64>,
    pub type3_percent_max: Option<f64>,
    pub warp_ns_per_reference_pixel: Option<f64>,
    pub rays_per_sec: Option<f64>,
    /// Median share of surface points, in percent, whose light was reused in one of two successive
    /// frames and traced in the other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flips_percent_median: Option<f64>,
    /// Median PSNR between the same diffuse points in two successive frames.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steadiness_psnr_db_median: Option<f64>,
    /// Share of the frames that reached their time limit, in percent.
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
    /// Ratio of the median frame times; the time of references is left out.
    pub speedup: f64,
    /// Time of tracing every frame in full over the time of the whole walk, references and store
    /// included.
    pub speedup_with_references: f64,
    /// How many times as long full tracing takes for the error of the walk, references counted:
    /// [`Self::mse_ratio`] times [`Self::speedup_with_references`], because the mean squared error
    /// of full tracing is inversely proportional to its time. Absent if no measured frame had
    /// references.
    pub equal_error_speedup: Option<f64>,
    /// Geometric mean, over the measured frames that had references, of the mean squared error of
    /// full tracing over that of the frame.
    pub mse_ratio: Option<f64>,
    /// Number of measured frames that had references.
    pub measured_frames_with_references: usize,
    /// Exposure in stops of all pictures that were compared.
    #[serde(serialize_with = "serialize_decimal")]
    pub exposure_ev: f32,
    pub psnr_db_median: f64,
    pub psnr_db_min: f64,
    pub full_psnr_db_median: f64,
    pub flip_mean_median: f64,
    pub full_flip_mean_median: f64,
    pub see_through_percent_median: f64,
    pub truth_samples: u32,
    /// Approximate PSNR that a noise-free picture would be measured at, because the converged
    /// picture has noise of its own.
    pub truth_noise_psnr_db: f64,
    pub noise: String,
}

impl TourRecord {
    /// Summarises the records. `samples` and `truth_samples` are the shadow rays per light and
    /// pixel of the frames and of the converged pictures.
    pub(super) fn new(flown: FlownTour, [samples, truth_samples]: [u32; 2]) -> Self {
        let FlownTour { frames, references, warm_up_secs, is_complete, store } = flown;
        // Not `sum`, which returns -0 for an empty list.
        let reference_secs_total = references.iter().fold(0.0, |sum, r| sum + r.secs);
        let mut summary = Summary::of(&frames);
        let other_secs = reference_secs_total + store.store_secs;
        summary.measured = MeasuredSummary::of(&frames, other_secs, samples, truth_samples);
        Self {
            frames,
            references_added: references.len(),
            reference_secs_total,
            store,
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

/// Returns the mean squared error of full tracing over that of the frame.
fn mse_ratio(measurement: &Measurement) -> f64 {
    /// Errors of less than -120 dB count as this: it is below the resolution of the display values,
    /// and equal pictures have no ratio of errors.
    const MIN_MSE: f64 = 1e-12;
    measurement.full_mse.max(MIN_MSE) / measurement.mse.max(MIN_MSE)
}

impl MeasuredSummary {
    /// `other_secs` is the time of the walk that no frame counts: of references and the store.
    fn of(frames: &[FrameRecord], other_secs: f64, samples: u32, truth_samples: u32) -> Option<Self> {
        let measured: Vec<&Measurement> = frames.iter().filter_map(|f| f.measurement.as_ref()).collect();
        let of = |value: fn(&Measurement) -> f64| measured.iter().map(move |m| value(m));
        let full_frame_secs_median = median(of(|m| m.full_frame_secs))?;
        let frame_secs_median = median(frames.iter().map(|f| f.frame_secs))?;
        let walk_secs = frames.iter().map(|f| f.frame_secs).sum::<f64>() + other_secs;
        let full_psnr_db_median = median(of(|m| m.full_psnr_db))?;
        // Variance is inversely proportional to samples: full tracing's error is its own noise plus
        // the truth's.
        let ratio = f64::from(samples + truth_samples) / f64::from(samples.max(1));
        let truth_noise_psnr_db = full_psnr_db_median + 10.0 * ratio.log10();
        let speedup_with_references = full_frame_secs_median * frames.len() as f64 / walk_secs;
        let reusing = frames.iter().filter(|f| f.references_used > 0).filter_map(|f| f.measurement.as_ref());
        let ratios: Vec<f64> = reusing.map(mse_ratio).collect();
        let mse_ratio = geometric_mean(ratios.iter().copied());
        Some(Self {
            measured_frames: measured.len(),
            full_frame_secs_median,
            speedup: full_frame_secs_median / frame_secs_median,
            speedup_with_references,
            equal_error_speedup: mse_ratio.map(|ratio| ratio * speedup_with_references),
            mse_ratio,
            measured_frames_with_references: ratios.len(),
            exposure_ev: measured.first()?.exposure_ev,
            psnr_db_median: median(of(|m| m.psnr_db))?,
            psnr_db_min: of(|m| m.psnr_db).min_by(f64::total_cmp)?,
            full_psnr_db_median,
            flip_mean_median: median(of(|m| m.flip_mean))?,
            full_flip_mean_median: median(of(|m| m.full_flip_mean))?,
            see_through_percent_median: median(of(|m| m.see_through_percent))?,
            truth_samples,
            truth_noise_psnr_db,
            noise: format!(
                "the converged picture has {truth_samples} shadow samples per light and a seed of its own; a PSNR \
                 above about {truth_noise_psnr_db:.0} dB cannot be distinguished from its noise"
            ),
        })
    }
}
