//! What is done next for a view: the schedule that the window's renderer and headless commands
//! follow.
//!
//! A frame is rendered first. One that was cut is resumed, and then the picture is refined until it
//! has converged. References that the policy or the user wants are traced in between, or on another
//! thread; while one is being traced, the picture is not refined, because the next frame will show
//! the reference's light.

use super::{settings::Mode, walkthrough::Walkthrough};
use crate::{camera::Camera, reference::cache::CachedReference, trace::parallel::Stop};
use std::time::Duration;

/// Maximum time of a step that resumes or refines: often enough to see the picture converge, and
/// rarely enough that drawing takes little time compared to tracing. Any change ends the work at
/// once.
pub const SLICE_TIME: Duration = Duration::from_millis(200);

/// Time after the last motion during which the view counts as moving: a drag pauses between two
/// events. Afterwards frames have every pixel of the window.
pub const MOTION_TIME: Duration = Duration::from_millis(250);

/// Rendered pixels per pixel of the window along an edge, in the first frame. While the view
/// changes, [`super::Pace`] follows what the machine can do.
pub const RENDER_SCALE: f32 = 0.5;

/// Time after which a frame is shown, complete or not, while the view changes: the default. With
/// the time to show it, a window without a graphics card keeps 15 frames per second.
pub const FRAME_BUDGET: Duration = Duration::from_millis(35);

/// Samples per light in the window: few, because motion must be fluid. Files are rendered with
/// more.
pub const WINDOW_SAMPLES: u32 = 4;

/// Returns true where the next frame has every pixel of the window, instead of
/// [`RENDER_SCALE`] times as many along an edge: once the view has `rested` for [`MOTION_TIME`] and
/// `has_newest`, a complete frame of it is shown, and from then on, `was_sharp`. Only in modes that
/// refine a stationary picture.
pub fn is_sharp(mode: Mode, render_scale: f32, was_sharp: bool, rested: Duration, has_newest: bool) -> bool {
    let has_rested = rested >= MOTION_TIME && has_newest;
    mode.refines() && render_scale < 1.0 && (was_sharp || has_rested)
}

/// Returns the edge of a frame in pixels for an edge of the window.
pub fn scaled_edge(pixels: u32, render_scale: f32) -> u32 {
    ((pixels as f32 * render_scale).round() as u32).max(1)
}

/// One step of work on a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Renders a frame.
    Frame,
    /// Resumes the last frame, which was stopped.
    Resume,
    /// Refines the last frame.
    Refine,
    /// Nothing is left to do until something changes.
    Rest,
}

/// Outcome of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepOutcome {
    /// The walkthrough's frame is to be shown.
    pub is_shown: bool,
    /// The frame is a refined or unfinished picture of the same request as the one before it.
    pub is_refinement: bool,
    /// Nothing is left to refine.
    pub has_converged: bool,
}

impl Step {
    /// Does the step. [`Self::Frame`] renders the frame of `camera` and `size`; the others continue
    /// the last frame.
    pub fn run(self, walk: &mut Walkthrough, camera: &Camera, size: [u32; 2], stop: Stop<'_>) -> StepOutcome {
        match self {
            Self::Frame => {
                walk.render(camera, size, stop);
                StepOutcome { is_shown: true, ..StepOutcome::default() }
            }
            Self::Resume => {
                walk.resume(stop);
                let is_refinement = !walk.frame().stats.is_complete;
                StepOutcome { is_shown: true, is_refinement, has_converged: false }
            }
            Self::Refine => {
                let state = walk.refine(stop);
                let (is_shown, has_converged) = (state.of > 0, state.is_complete);
                StepOutcome { is_shown, is_refinement: true, has_converged }
            }
            Self::Rest => StepOutcome::default(),
        }
    }
}

/// Pose and size of a reference.
type ReferencePose = (Camera, [u32; 2]);

/// State of the schedule. A request has a number, its generation: every change of what the next
/// frame shows raises it.
#[derive(Clone, Debug, Default)]
pub struct Schedule {
    /// Generation of the last frame.
    rendered: Option<u64>,
    /// Generation whose picture has converged.
    converged: Option<u64>,
    /// The reference that is being traced.
    tracing: Option<ReferencePose>,
    /// Poses at which tracing a reference has failed: the placement policy would choose them again
    /// and again.
    refused: Vec<ReferencePose>,
    /// Pose of a reference that the user has added while another one was being traced.
    added: Option<Camera>,
}

impl Schedule {
    /// Returns the next step for the request of a generation. Pictures that are compared are not
    /// refined: `may_refine` is false.
    pub fn next(&self, walk: &Walkthrough, generation: u64, may_refine: bool) -> Step {
        let is_refining = may_refine && self.converged != Some(generation) && !self.has_reference();
        match self.rendered == Some(generation) {
            false => Step::Frame,
            true if walk.can_resume() => Step::Resume,
            true if is_refining => Step::Refine,
            true => Step::Rest,
        }
    }

    /// True if the frame of a generation was rendered.
    pub fn has_rendered(&self, generation: u64) -> bool {
        self.rendered == Some(generation)
    }

    /// Notes that the frame of a generation is being rendered.
    pub fn begin_frame(&mut self, generation: u64) {
        self.rendered = Some(generation);
    }

    /// Notes whether the picture of a generation has converged, or cannot be refined.
    pub fn set_converged(&mut self, generation: u64, has_converged: bool) {
        self.converged = has_converged.then_some(generation);
    }

    /// True while a reference is being traced or waits for that.
    fn has_reference(&self) -> bool {
        self.tracing.is_some() || self.added.is_some()
    }

    /// Returns the pose of the reference to be traced now, one at a time: the one that the user has
    /// added, or the one that the policy wants after the frame of a generation. The caller traces
    /// it and calls [`Self::end_reference`].
    pub fn next_reference(&mut self, walk: &Walkthrough, generation: u64, size: [u32; 2]) -> Option<Camera> {
        if self.tracing.is_some() {
            return None;
        }
        // While a frame is being resumed, its light is kept, so a reference need not trace it
        // again.
        let is_resuming = self.has_rendered(generation) && walk.can_resume();
        let by_policy = || {
            let pose = (wanted(walk, size)?, size);
            (!is_resuming && !self.refused.contains(&pose)).then_some(pose.0)
        };
        let camera = self.added.or_else(by_policy)?;
        (self.added, self.tracing) = (None, Some((camera, size)));
        Some(camera)
    }

    /// Notes that the reference is no longer being traced. One that `has_failed` is not requested
    /// again.
    pub fn end_reference(&mut self, has_failed: bool) {
        self.refused.extend(self.tracing.take().filter(|_| has_failed));
    }

    /// Adds a reference at a pose, whatever the policy decides; `None` drops one that waits.
    pub fn add_reference(&mut self, camera: Option<Camera>) {
        self.added = camera;
    }

    /// Allows references again at poses where tracing one has failed.
    pub fn forget_failures(&mut self) {
        self.refused.clear();
    }
}

/// Returns the pose at which the policy wants a reference. A pose that has one already is left out:
/// where Type 3 stays high in spite of it, the policy would choose that pose again and again. A
/// reference that is disabled, or stale in part, does not count and is replaced.
fn wanted(walk: &Walkthrough, size: [u32; 2]) -> Option<Camera> {
    let camera = walk.wanted_reference()?;
    let is_same = |e: &CachedReference| {
        let is_useful = e.is_enabled && e.frame.stale() == 0;
        is_useful && e.frame.camera == camera && e.frame.view.size == size
    };
    (!walk.cache().entries().iter().any(is_same)).then_some(camera)
}
