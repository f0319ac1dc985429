//! A view that does not change, rendered step by step by the window's [`Schedule`].

use super::{
    frame::Frame,
    schedule::{FRAME_BUDGET, MOTION_TIME, RENDER_SCALE, SLICE_TIME, Schedule, Step, StepOutcome},
    schedule::{is_sharp, scaled_edge},
    settings::WalkthroughSettings,
    walkthrough::Walkthrough,
};
use crate::{
    camera::Camera,
    trace::{Tracer, parallel::Stop},
};
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// A view that does not change, on its way to convergence.
///
/// References are traced between two frames on the current thread pool, where the window traces
/// them on a second thread.
#[derive(Debug)]
pub struct StillView {
    walk: Walkthrough,
    schedule: Schedule,
    camera: Camera,
    size: [u32; 2],
    /// Raised by every change of what the next frame shows.
    generation: u64,
    /// False while frames are small and cut at [`FRAME_BUDGET`].
    is_sharp: bool,
    spent: Duration,
}

impl StillView {
    /// A view whose first frame has every pixel.
    pub fn new(tracer: Arc<Tracer>, settings: WalkthroughSettings, camera: &Camera, size: [u32; 2]) -> Self {
        let walk = Walkthrough::new(tracer, settings).progressive();
        let (schedule, camera) = (Schedule::default(), *camera);
        Self { walk, schedule, camera, size, generation: 0, is_sharp: true, spent: Duration::ZERO }
    }

    /// The same view in a window with its default settings that has just opened: frames begin small
    /// and cut, and have every pixel once the camera has rested.
    #[must_use]
    pub fn in_window(mut self) -> Self {
        self.is_sharp = false;
        self.walk.set_previews(true);
        self
    }

    /// Does the next step. Returns `None` where nothing is left to do. After a stop, the frame
    /// shows what was done.
    pub fn step(&mut self, stop: Stop<'_>) -> Option<StepOutcome> {
        let start = Instant::now();
        self.sharpen();
        let size = self.frame_size();
        let done = match self.schedule.next_reference(&self.walk, self.generation, size) {
            Some(camera) => Some(self.add_reference(camera, size, stop)),
            None => match self.schedule.next(&self.walk, self.generation, true) {
                Step::Rest => self.wait(),
                step => Some(self.run(step, size, start, stop)),
            },
        };
        self.spent += start.elapsed();
        done
    }

    /// Time of all steps so far, and of waiting for the camera to rest, which takes no time here.
    pub fn spent(&self) -> Duration {
        self.spent
    }

    /// The last frame. In a window it may have less than every pixel.
    pub fn frame(&self) -> &Frame {
        self.walk.frame()
    }

    /// The walkthrough.
    pub fn walk(&self) -> &Walkthrough {
        &self.walk
    }

    /// Begins again with other settings. The references are kept.
    #[cfg(feature = "pictures")]
    pub(super) fn restart(&mut self, settings: WalkthroughSettings) {
        self.walk.set_settings(settings);
        self.generation += 1;
    }

    fn frame_size(&self) -> [u32; 2] {
        let scale = if self.is_sharp { 1.0 } else { RENDER_SCALE };
        self.size.map(|edge| scaled_edge(edge, scale))
    }

    /// Begins to request every pixel, once the view has rested.
    fn sharpen(&mut self) {
        let has_newest = self.schedule.has_rendered(self.generation) && self.frame().stats.is_complete;
        let mode = self.walk.settings().render.mode;
        if !self.is_sharp && is_sharp(mode, RENDER_SCALE, false, self.spent, has_newest) {
            self.is_sharp = true;
            self.generation += 1;
        }
    }

    /// Passes the time until the view counts as rested. Returns `None` where it does so already.
    fn wait(&mut self) -> Option<StepOutcome> {
        let may_sharpen = self.walk.settings().render.mode.refines() && !self.is_sharp;
        let is_waiting = may_sharpen && self.spent < MOTION_TIME;
        self.spent = if is_waiting { MOTION_TIME } else { self.spent };
        is_waiting.then(StepOutcome::default)
    }

    fn add_reference(&mut self, camera: Camera, size: [u32; 2], stop: Stop<'_>) -> StepOutcome {
        let reference = self.walk.reference_job(camera, size).trace(stop);
        self.schedule.end_reference(false);
        if let Some(reference) = reference {
            self.walk.insert(reference);
            self.generation += 1;
        }
        StepOutcome::default()
    }

    fn run(&mut self, step: Step, size: [u32; 2], start: Instant, stop: Stop<'_>) -> StepOutcome {
        let limit = match step {
            Step::Frame if self.is_sharp => Duration::MAX,
            Step::Frame => FRAME_BUDGET,
            _ => SLICE_TIME,
        };
        if step == Step::Frame {
            self.schedule.begin_frame(self.generation);
        }
        let done = step.run(&mut self.walk, &self.camera, size, &|| stop() || start.elapsed() >= limit);
        if step == Step::Refine {
            self.schedule.set_converged(self.generation, done.has_converged);
        }
        done
    }
}
