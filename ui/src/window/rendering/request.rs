//! What the renderer is to do, and what it is doing, in a word.

use crate::window::app::App;
use crate::window::rendering::render_thread::RenderRequest;
use crate::window::state::Work;
use std::time::{Duration, Instant};

/// After the last motion the state still says moving for so long: a drag pauses between two events.
pub(crate) const MOTION_TIME: Duration = Duration::from_millis(250);

/// The largest texture that every adapter takes.
const LARGEST_EDGE: f32 = 8192.0;

impl App {
    /// Sends the pose and the settings where they have changed.
    pub(crate) fn send_request(&mut self) {
        let (is_sharp, q) = (self.is_sharp(), &self.state.quality);
        let scale = if is_sharp { 1.0 } else { q.render_scale };
        let edge = |pixels: u32| (pixels as f32 * scale).round().clamp(1.0, LARGEST_EDGE) as u32;
        let size = if self.viewport_size.contains(&0) { [0, 0] } else { self.viewport_size.map(edge) };
        let request = RenderRequest {
            camera: *self.state.navigation.fly.camera(),
            size,
            settings: q.walk,
            budget: (!is_sharp).then(|| Duration::from_secs_f32(q.budget_ms / 1000.0)),
            is_paused: self.state.options.is_paused,
            is_compared: self.state.comparison.is_wanted(),
        };
        if self.sent != Some(request) {
            if self.sent.is_some_and(|s| s.camera != request.camera) {
                self.moved = Instant::now();
                self.state.navigation.shows_hint = false;
            }
            self.threads.request(request);
            self.sent = Some(request);
        }
    }

    /// True where nothing has changed since a frame of the render scale was complete: the picture at rest has every pixel of
    /// the window. Only in modes that go on at rest.
    fn is_sharp(&self) -> bool {
        let (q, camera) = (&self.state.quality, self.state.navigation.fly.camera());
        let may_be = q.walk.render.mode.refines() && q.render_scale < 1.0;
        let is_same = |s: &RenderRequest| s.camera == *camera && s.settings == q.walk && !s.is_paused;
        may_be
            && self
                .sent
                .as_ref()
                .filter(|s| is_same(s))
                .is_some_and(|s| s.budget.is_none() || self.has_rested())
    }

    fn has_rested(&self) -> bool {
        // Pictures that are compared keep their size.
        let is_compared = self.state.comparison.is_wanted();
        self.moved.elapsed() >= MOTION_TIME && self.has_newest() && !is_compared
    }

    /// True where what was wished for last is shown whole.
    fn has_newest(&self) -> bool {
        let frame = self.state.frame.as_ref();
        frame.is_some_and(|f| f.generation == self.threads.generation() && f.stats.is_complete)
    }

    pub(crate) fn work(&self) -> Work {
        let frame = self.state.frame.as_ref();
        match () {
            () if self.loader.is_some() => Work::Loading,
            () if self.state.scene.is_none() => Work::NoScene,
            () if self.state.options.is_paused => Work::Paused,
            () if self.moved.elapsed() < MOTION_TIME && !self.state.navigation.shows_hint => Work::Moving,
            () if self.is_editing => Work::Editing,
            () if !self.has_newest() => Work::Filling,
            () if self.threads.is_adding_reference() => Work::AddingReference,
            () => match frame.map(|f| f.stats.refined) {
                Some(refined) if refined.of > 0 && refined.is_complete => Work::Converged,
                Some(refined) if refined.of > 0 => Work::Refining,
                _ => Work::Complete,
            },
        }
    }
}
