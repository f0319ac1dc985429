//! The error of a frame of a walk against its view traced in full and against its converged
//! picture.

use super::truth::{TruthRequest, truth};
use crate::raster::metrics::{CompareError, flip, mse, psnr_of_mse};
use crate::raster::{exposure::serialize_decimal, load::exposed, pixel_types::PixelType, save::SaveError};
use crate::render::{Frame, FrameRequest, Mode, RenderSettings, Renderer};
use crate::trace::{TraceSettings, Tracer, parallel::Stop};
use serde::Serialize;
use std::path::PathBuf;

/// Which frames of a walk are compared with a converged picture, at which exposure, and how that
/// picture is traced.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureSettings {
    /// Every n-th frame is measured, beginning with the first.
    pub every: u32,
    /// Shadow rays per light and pixel of the converged picture.
    pub truth_samples: u32,
    /// Folder that keeps converged pictures between runs; `None` keeps none.
    pub truth_folder: Option<PathBuf>,
    /// Exposure in stops of all pictures that are compared.
    pub exposure_ev: f32,
}

/// The errors of one frame.
///
/// PSNR, mean squared error and FLIP compare display values: radiance times two to the power of the
/// exposure, clipped to 0..1 and encoded as sRGB, without a tone map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measurement {
    /// Time of tracing the same view in full with the same samples, in seconds.
    pub full_frame_secs: f64,
    /// Exposure in stops of the pictures that are compared.
    #[serde(serialize_with = "serialize_decimal")]
    pub exposure_ev: f32,
    /// Mean squared difference of the frame's display values from those of the converged picture,
    /// over pixels and channels.
    pub mse: f64,
    /// Mean squared difference of the fully traced view's display values from those of the
    /// converged picture.
    pub full_mse: f64,
    /// PSNR of the frame against the converged picture in dB.
    pub psnr_db: f64,
    /// PSNR of the fully traced view against the converged picture in dB.
    pub full_psnr_db: f64,
    /// Mean FLIP of the frame against the converged picture.
    pub flip_mean: f64,
    /// Mean FLIP of the fully traced view against the converged picture.
    pub full_flip_mean: f64,
    /// Share of the Type 1 and Type 2 pixels, in percent, whose depth is off by more than
    /// [`DEPTH_TOLERANCE`].
    pub see_through_percent: f64,
}

/// Relative difference in depth beyond which a reused pixel is taken to show another surface than
/// it should.
pub const DEPTH_TOLERANCE: f32 = 0.01;

/// Combined with the seed of a run, so that a converged picture and the frames compared with it use
/// different random numbers.
pub(super) const TRUTH_SEED: u64 = 0x7275_7468_0000_0001;

/// Measures frames and reuses its buffers.
#[derive(Debug)]
pub struct Measurer {
    settings: MeasureSettings,
    renderer: Renderer,
    /// First error in storing a converged picture.
    pub keep_error: Option<SaveError>,
}

impl Measurer {
    /// A measurer with empty buffers.
    pub fn new(settings: MeasureSettings) -> Self {
        Self { settings, renderer: Renderer::default(), keep_error: None }
    }

    /// Returns true if the frame of this number is to be measured.
    pub fn is_due(&self, frame: u32) -> bool {
        frame.is_multiple_of(self.settings.every.max(1))
    }

    /// Measures a frame. `None` after a stop.
    ///
    /// # Errors
    /// [`CompareError`] if the frame has no pixels.
    pub fn measure(
        &mut self,
        tracer: &Tracer,
        frame: &Frame,
        trace: &TraceSettings,
        stop: Stop<'_>,
    ) -> Result<Option<Measurement>, CompareError> {
        let size = frame.view.size;
        let settings = RenderSettings { mode: Mode::Full, trace: *trace };
        let full =
            self.renderer.render(&FrameRequest::new(tracer, &frame.camera, size, &settings).with_stop(stop));
        if !full.stats.is_complete {
            return Ok(None);
        }
        let seed = trace.seed ^ TRUTH_SEED;
        let settings = TraceSettings { samples: self.settings.truth_samples, seed, ..*trace };
        let request = TruthRequest { tracer, camera: &frame.camera, size, settings, passes: 1 };
        let folder = self.settings.truth_folder.as_deref();
        let Some((truth, error)) = truth(&request, folder, stop) else { return Ok(None) };
        self.keep_error = self.keep_error.take().or(error);
        let exposure_ev = self.settings.exposure_ev;
        let pictures = [&truth, &frame.radiance, &full.radiance];
        let [truth, shown, full_shown] = pictures.map(|radiance| exposed(radiance, exposure_ev));
        let [mse, full_mse] = [&shown, &full_shown].map(|shown| mse(shown, &truth));
        Ok(Some(Measurement {
            full_frame_secs: full.stats.secs.frame,
            exposure_ev,
            mse,
            full_mse,
            psnr_db: psnr_of_mse(mse),
            full_psnr_db: psnr_of_mse(full_mse),
            flip_mean: flip(&shown, &truth, size)?.mean,
            full_flip_mean: flip(&full_shown, &truth, size)?.mean,
            see_through_percent: see_through_percent(frame, full),
        }))
    }
}

/// Returns the share of a frame's reused pixels, in percent, whose depth differs from that of the
/// same view traced in full by more than [`DEPTH_TOLERANCE`].
pub fn see_through_percent(frame: &Frame, full: &Frame) -> f64 {
    let (mut reused, mut wrong) = (0usize, 0usize);
    for ((t, shown), right) in frame.types.iter().zip(&frame.disparity).zip(&full.disparity) {
        if !matches!(t, PixelType::Reused | PixelType::Secondary) {
            continue;
        }
        reused += 1;
        // The ratio of disparities is the inverse ratio of depths. It is 0, infinite or NaN if one
        // is sky.
        let both_sky = *shown == 0.0 && *right == 0.0;
        let is_near = (right / shown - 1.0).abs() <= DEPTH_TOLERANCE;
        wrong += usize::from(!both_sky && !is_near);
    }
    100.0 * wrong as f64 / reused.max(1) as f64
}
