//! Pictures that are rendered for a given time.

use super::job::drawn;
use super::{MadePicture, Output, PictureJob, memory};
use afterimage::{
    Tracer,
    raster::save::SaveError,
    render::{TimedPicture, bands::Band},
    trace::parallel::Stop,
};
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// How far a picture is that is rendered for a given time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TimedState {
    /// Time of rendering, seconds.
    pub secs: f64,
    /// Passes over the picture so far.
    pub passes: u32,
    /// Samples of every pixel so far; before the first pass is complete, those of the pixels that
    /// have been rendered.
    pub samples: u64,
    /// Estimated PSNR in decibels; `None` before the second pass.
    pub estimated_psnr_db: Option<f64>,
}

impl PictureJob {
    /// Renders the best picture that a time allows, and writes its files. If it is stopped, they
    /// contain the picture so far. `progress` is called from time to time.
    ///
    /// # Errors
    /// [`SaveError`] of the first file that cannot be written; then no file is left.
    pub fn make_timed(
        &self,
        tracer: &Arc<Tracer>,
        outputs: &[Output],
        limit: Duration,
        stop: Stop<'_>,
        progress: &dyn Fn(&TimedState),
    ) -> Result<(MadePicture, TimedState), SaveError> {
        let start = Instant::now();
        let view = (&self.camera, self.size);
        let mut picture = TimedPicture::new(Arc::clone(tracer), self.settings, view, limit, self.exposure_ev);
        let is_over = || stop() || start.elapsed() >= limit;
        while !is_over() && picture.step(&is_over) {
            progress(&self.state(&picture));
        }
        picture.conclude();
        let (state, frame) = (self.state(&picture), picture.into_frame());
        let stats = frame.stats;
        let mut metadata = self.metadata(tracer, stats.refined);
        if let Some((_, settings)) = metadata.iter_mut().find(|(name, _)| *name == "Settings") {
            *settings += &format!(" --seconds {}", limit.as_secs_f64());
        }
        let mut files = self.begin_all(outputs, &metadata)?;
        self.write(tracer, outputs, &mut files, &drawn(Band::from(frame), &self.lines(tracer)))?;
        Ok((MadePicture::finish(files, stats)?, state))
    }

    fn state(&self, picture: &TimedPicture) -> TimedState {
        let passes = picture.passes();
        TimedState {
            secs: picture.spent().as_secs_f64(),
            passes,
            samples: picture.samples(),
            estimated_psnr_db: picture.estimated_psnr_db(),
        }
    }
}

/// Checks the size of a picture that is rendered for a given time.
///
/// # Errors
/// [`memory::TooLarge`] with the limit that it exceeds.
pub(crate) fn check_timed(pixels: u64) -> Result<(), memory::TooLarge> {
    // Its frame becomes a reference; the passes and the means of earlier rounds take less than
    // another.
    memory::check(pixels, 2)
}
