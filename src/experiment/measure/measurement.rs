//! How good a frame is: against the same view traced in full, and against a converged picture of it.

use super::truth::{TruthRequest, truth};
use crate::raster::load::display_of;
use crate::raster::metrics::{CompareError, flip, psnr_db};
use crate::raster::pixel_types::PixelType;
use crate::raster::save::SaveError;
use crate::render::{Frame, Mode, RenderSettings, Renderer};
use crate::trace::parallel::Stop;
use crate::trace::{TraceSettings, Tracer};
use serde::Serialize;
use std::path::PathBuf;

/// What frames are measured with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeasureSettings {
    /// Every so many frames, the first among them.
    pub every: u32,
    /// Shadow samples of the truth.
    pub truth_samples: u32,
    /// Where truths are kept; `None` keeps none.
    pub truth_folder: Option<PathBuf>,
}

/// The errors of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measurement {
    /// Tracing the same view in full, at the same samples.
    pub full_frame_secs: f64,
    /// Of the frame against the truth.
    pub psnr_db: f64,
    /// Of the fully traced view against the truth.
    pub full_psnr_db: f64,
    /// Of the frame against the truth.
    pub flip_mean: f64,
    /// Of the fully traced view against the truth.
    pub full_flip_mean: f64,
    /// Of the Type 1 and Type 2 pixels, those whose depth is off by more than [`DEPTH_TOLERANCE`].
    pub see_through_percent: f64,
}

/// A reused pixel whose depth differs by a larger share shows another surface than it should.
pub const DEPTH_TOLERANCE: f32 = 0.01;

/// The truth's random numbers must not be those of the pictures measured against it.
pub(super) const TRUTH_SEED: u64 = 0x7275_7468_0000_0001;

/// Why a frame was not measured.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The pictures cannot be compared.
    #[error(transparent)]
    Compare(#[from] CompareError),
}

/// Measures frames; keeps its buffers from one to the next.
#[derive(Debug)]
pub struct Measurer {
    settings: MeasureSettings,
    renderer: Renderer,
    /// The first trouble with keeping truths.
    pub keep_error: Option<SaveError>,
}

impl Measurer {
    /// Measures nothing yet.
    pub fn new(settings: MeasureSettings) -> Self {
        Self { settings, renderer: Renderer::default(), keep_error: None }
    }

    /// True where the frame of this number is to be measured.
    pub fn is_due(&self, frame: u32) -> bool {
        frame.is_multiple_of(self.settings.every.max(1))
    }

    /// Measures a frame. `None` after a stop.
    ///
    /// # Errors
    /// [`MeasureError`] where the frame has no pixels or a pixel is not a number.
    pub fn measure(
        &mut self,
        tracer: &Tracer,
        frame: &Frame,
        trace: &TraceSettings,
        stop: Stop<'_>,
    ) -> Result<Option<Measurement>, MeasureError> {
        let size = frame.view.size;
        let settings = RenderSettings { mode: Mode::Full, trace: *trace };
        let full = self.renderer.render(tracer, &frame.camera, size, &settings, &[], stop);
        if !full.stats.is_complete {
            return Ok(None);
        }
        let seed = trace.seed ^ TRUTH_SEED;
        let settings = TraceSettings { samples: self.settings.truth_samples, seed, ..*trace };
        let request = TruthRequest { tracer, camera: &frame.camera, size, settings };
        let folder = self.settings.truth_folder.as_deref();
        let Some((truth, error)) = truth(&request, folder, stop) else { return Ok(None) };
        self.keep_error = self.keep_error.take().or(error);
        let [truth, shown, full_shown] = [&truth, &frame.radiance, &full.radiance].map(|r| display_of(r));
        Ok(Some(Measurement {
            full_frame_secs: full.stats.secs.frame,
            psnr_db: psnr_db(&shown, &truth),
            full_psnr_db: psnr_db(&full_shown, &truth),
            flip_mean: flip(&shown, &truth, size)?.mean,
            full_flip_mean: flip(&full_shown, &truth, size)?.mean,
            see_through_percent: see_through_percent(frame, full),
        }))
    }
}

/// The share of a frame's reused pixels whose depth is not that of the same view traced in full.
pub fn see_through_percent(frame: &Frame, full: &Frame) -> f64 {
    let (mut reused, mut wrong) = (0usize, 0usize);
    for ((t, shown), right) in frame.types.iter().zip(&frame.disparity).zip(&full.disparity) {
        if !matches!(t, PixelType::Reused | PixelType::Secondary) {
            continue;
        }
        reused += 1;
        // The ratio of disparities is that of depths; of a sky and a surface it is 0, infinite or no number.
        let both_sky = *shown == 0.0 && *right == 0.0;
        let is_near = (right / shown - 1.0).abs() <= DEPTH_TOLERANCE;
        wrong += usize::from(!both_sky && !is_near);
    }
    100.0 * wrong as f64 / reused.max(1) as f64
}
