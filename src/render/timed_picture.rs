//! The best picture of a view that a given time allows.

use super::{
    deadline::Deadline,
    frame::{Frame, RefineState},
    settings::{Mode, RenderSettings, WalkthroughSettings},
    still_view::StillView,
    timed_rest::TimedRest,
};
use crate::{
    camera::Camera,
    raster::{load::exposed, metrics::mse},
    trace::{TraceSettings, Tracer, parallel::Stop},
};
use glam::Vec3;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// A picture that is refined for as long as its caller wants, from nothing: by the window's
/// schedule, or, in modes that look smooth light up, with a reference that is lit until the time
/// that is left is needed to show it.
///
/// Where the picture has converged, it begins again with another seed, and is the mean of all
/// passes.
#[derive(Debug)]
pub struct TimedPicture {
    view: TimedView,
    render: RenderSettings,
    spent: Duration,
    /// Number of the current round, from 0.
    round: u64,
    /// The converged picture of the first round; its radiance is the sum over the passes of all
    /// rounds before the current one.
    finished: Option<Frame>,
    finished_passes: u32,
    noise: NoiseEstimate,
}

impl TimedPicture {
    /// A picture of which nothing is rendered, for a time of `limit` from now on. Its error is
    /// estimated at an exposure in stops.
    pub fn new(
        tracer: Arc<Tracer>,
        render: RenderSettings,
        (camera, size): (&Camera, [u32; 2]),
        limit: Duration,
        exposure_ev: f32,
    ) -> Self {
        Self {
            view: TimedView::new(tracer, render, (camera, size), Deadline::after(limit)),
            render,
            spent: Duration::ZERO,
            round: 0,
            finished: None,
            finished_passes: 0,
            noise: NoiseEstimate { exposure_ev, ..NoiseEstimate::default() },
        }
    }

    /// Improves the picture until `stop` is true or it is worth showing. Returns false where it
    /// cannot be improved.
    pub fn step(&mut self, stop: Stop<'_>) -> bool {
        let start = Instant::now();
        // The first step of a round replaces the frame that the rounds before it contain already.
        let can_improve = self.view.step(stop) || (self.begin_round() && self.view.step(stop));
        self.spent += start.elapsed();
        let passes = self.passes();
        if self.noise.is_due(passes) {
            self.noise.note(&self.radiance(), passes);
        }
        can_improve
    }

    /// Passes that every pixel has had. A complete frame that is not refined yet counts as one.
    pub fn passes(&self) -> u32 {
        let has_frame = self.finished.is_some() || self.view.frame().stats.is_complete;
        (self.finished_passes + self.current_passes()).max(u32::from(has_frame && self.has_pixels()))
    }

    /// Samples of a pixel so far: of its light, or of all passes where they are more.
    pub fn samples(&self) -> u64 {
        let of_passes = u64::from(self.passes().max(1)) * u64::from(self.render.trace.samples);
        of_passes.max(u64::from(self.view.frame().stats.refined.light_samples))
    }

    /// Estimated PSNR in decibels against the picture that more passes converge to, from how much
    /// it has changed since half as many passes; `None` before the second pass.
    pub fn estimated_psnr_db(&self) -> Option<f64> {
        self.noise.psnr_db(self.passes())
    }

    /// Time of rendering so far.
    pub fn spent(&self) -> Duration {
        self.spent
    }

    /// Shows what there is, where the work ends before there is a picture.
    pub fn conclude(&mut self) {
        self.view.conclude();
    }

    /// The picture so far. It is complete where every pixel was rendered.
    pub fn into_frame(mut self) -> Frame {
        self.conclude();
        let (pass, radiance) = (self.passes(), self.radiance());
        let mut frame = self.finished.unwrap_or_else(|| self.view.frame().clone());
        frame.radiance = radiance;
        frame.stats.refined = RefineState { pass, of: pass, ..RefineState::default() };
        frame.stats.secs.frame = self.spent.as_secs_f64();
        frame
    }

    fn has_pixels(&self) -> bool {
        !self.view.frame().radiance.is_empty()
    }

    /// Passes of the current round.
    fn current_passes(&self) -> u32 {
        let stats = &self.view.frame().stats;
        let is_first = self.render.mode == Mode::Full && stats.is_complete && self.has_pixels();
        stats.refined.pass.max(u32::from(is_first))
    }

    /// The mean of all passes; the frame, before the first of them.
    fn radiance(&self) -> Vec<Vec3> {
        let (shown, new) = (&self.view.frame().radiance, self.current_passes());
        let Some(finished) = &self.finished else { return shown.clone() };
        let count = (self.finished_passes + new).max(1) as f32;
        // Until the current round has had a pass, its frame is a look-up.
        finished.radiance.iter().zip(shown).map(|(sum, mean)| (*sum + *mean * new as f32) / count).collect()
    }

    /// Keeps the converged picture and begins another with its own seed. False for a mode that does
    /// not refine.
    fn begin_round(&mut self) -> bool {
        let (shown, new) = (self.view.frame(), self.current_passes());
        if new == 0 || !self.render.mode.refines() {
            return false;
        }
        let finished = self.finished.get_or_insert_with(|| {
            let nothing = vec![Vec3::ZERO; shown.radiance.len()];
            Frame { radiance: nothing, ..shown.clone() }
        });
        for (sum, mean) in finished.radiance.iter_mut().zip(&shown.radiance) {
            *sum += *mean * new as f32;
        }
        self.finished_passes += new;
        self.round += 1;
        // Passes use the bits of the seed from 48 up, and a round has at most 64.
        let trace = self.render.trace;
        let seed = trace.seed.wrapping_add(self.round << 54);
        self.view.restart(RenderSettings { trace: TraceSettings { seed, ..trace }, ..self.render });
        true
    }
}

/// The two ways to a picture.
#[derive(Debug)]
enum TimedView {
    /// The window's schedule.
    Still(Box<StillView>),
    /// A reference lit for as long as there is time.
    Rest(Box<TimedRest>),
}

impl TimedView {
    fn new(
        tracer: Arc<Tracer>,
        render: RenderSettings,
        (camera, size): (&Camera, [u32; 2]),
        deadline: Deadline,
    ) -> Self {
        if render.mode.looks_up() && render.trace.bounces > 0 {
            return Self::Rest(Box::new(TimedRest::new(tracer, render, camera, size, deadline)));
        }
        let settings = WalkthroughSettings { render, ..WalkthroughSettings::default() };
        Self::Still(Box::new(StillView::new(tracer, settings, camera, size)))
    }

    fn step(&mut self, stop: Stop<'_>) -> bool {
        match self {
            Self::Still(view) => view.step(stop).is_some(),
            Self::Rest(view) => view.step(stop),
        }
    }

    fn frame(&self) -> &Frame {
        match self {
            Self::Still(view) => view.frame(),
            Self::Rest(view) => view.frame(),
        }
    }

    fn conclude(&mut self) {
        if let Self::Rest(view) = self {
            view.conclude();
        }
    }

    fn restart(&mut self, render: RenderSettings) {
        match self {
            Self::Still(view) => {
                view.restart(WalkthroughSettings { render, ..WalkthroughSettings::default() });
            }
            Self::Rest(view) => view.restart(render),
        }
    }
}

/// Estimates the noise of a mean of passes from how much the mean still changes.
///
/// If a pass has the variance v, the mean of n passes has v / n, and the mean of the first m of
/// them differs from it by the variance v / m - v / n. The estimate knows noise alone: an error
/// that all passes have in common does not change the mean. Light that few paths find is noticed
/// when the first of them is traced.
#[derive(Debug, Default)]
struct NoiseEstimate {
    exposure_ev: f32,
    /// Display values of the mean after `passes`.
    shown: Vec<Vec3>,
    passes: u32,
    /// Mean squared error of display values of a single pass.
    variance: Option<f64>,
}

impl NoiseEstimate {
    /// True where the mean has as many passes again as when it was last noted.
    fn is_due(&self, passes: u32) -> bool {
        passes >= (2 * self.passes).max(1)
    }

    fn note(&mut self, radiance: &[Vec3], passes: u32) {
        let shown = exposed(radiance, self.exposure_ev);
        if self.passes > 0 {
            let share = 1.0 / f64::from(self.passes) - 1.0 / f64::from(passes);
            self.variance = Some(mse(&shown, &self.shown) / share);
        }
        (self.shown, self.passes) = (shown, passes);
    }

    fn psnr_db(&self, passes: u32) -> Option<f64> {
        let mse = self.variance? / f64::from(passes.max(1));
        (mse > 0.0).then(|| -10.0 * mse.log10())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::key::Key;

    #[test]
    fn the_change_of_a_mean_reveals_its_noise() {
        // Passes of noise with a known variance around a grey picture, shown without a tone curve's
        // help: the estimate must agree with the error against the known mean.
        const PIXELS: usize = 4096;
        let noise = |pass: u32, pixel: usize| {
            let [random, _] = Key::of_pixel(7, pixel as u32).with(pass).pair();
            Vec3::splat(0.2 + 0.1 * (random - 0.5))
        };
        let (mut sums, mut estimate) = (vec![Vec3::ZERO; PIXELS], NoiseEstimate::default());
        for pass in 1..=32 {
            sums.iter_mut().enumerate().for_each(|(pixel, sum)| *sum += noise(pass, pixel));
            let mean: Vec<Vec3> = sums.iter().map(|sum| *sum / pass as f32).collect();
            if estimate.is_due(pass) {
                estimate.note(&mean, pass);
            }
        }
        let mean: Vec<Vec3> = sums.iter().map(|sum| *sum / 32.0).collect();
        let truth = vec![Vec3::splat(0.2); PIXELS];
        let right = -10.0 * mse(&exposed(&mean, 0.0), &exposed(&truth, 0.0)).log10();
        let found = estimate.psnr_db(32).unwrap();
        assert!((found - right).abs() < 0.5, "{found} dB estimated, {right} dB measured");
    }
}
