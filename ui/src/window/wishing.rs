//! What the renderer is to do, and what it is doing, in a word.

use super::app::App;
use super::render_thread::Wish;
use super::state::Work;
use std::time::{Duration, Instant};

/// After the last motion the state still says moving for so long: a drag pauses between two events.
pub(super) const MOTION_TIME: Duration = Duration::from_millis(250);

/// The largest texture that every adapter takes.
const LARGEST_EDGE: f32 = 8192.0;

impl App {
    /// Sends the pose and the settings where they have changed.
    pub(super) fn send_wish(&mut self) {
        let q = &self.state.quality;
        let edge = |pixels: u32| (pixels as f32 * q.render_scale).round().clamp(1.0, LARGEST_EDGE) as u32;
        let size = if self.viewport_size.contains(&0) { [0, 0] } else { self.viewport_size.map(edge) };
        let wish = Wish {
            camera: *self.state.fly.camera(),
            size,
            settings: q.walk,
            budget: Duration::from_secs_f32(q.budget_ms / 1000.0),
            is_paused: self.state.options.is_paused,
            is_compared: self.state.comparison.is_wanted(),
        };
        if self.sent != Some(wish) {
            if self.sent.is_some_and(|s| s.camera != wish.camera) {
                self.moved = Instant::now();
                self.state.shows_hint = false;
            }
            self.threads.wish(wish);
            self.sent = Some(wish);
        }
    }

    pub(super) fn work(&self) -> Work {
        let frame = self.state.frame.as_ref();
        let is_newest =
            frame.is_some_and(|f| f.generation == self.threads.generation() && f.stats.is_complete);
        match () {
            () if self.loader.is_some() => Work::Loading,
            () if self.state.scene.is_none() => Work::NoScene,
            () if self.state.options.is_paused => Work::Paused,
            () if self.moved.elapsed() < MOTION_TIME && !self.state.shows_hint => Work::Moving,
            () if self.is_editing => Work::Editing,
            () if !is_newest => Work::Filling,
            () if self.threads.is_adding_reference() => Work::AddingReference,
            () => match frame.map(|f| f.stats.refined) {
                Some(refined) if refined.of > 0 && refined.is_complete => Work::Converged,
                Some(refined) if refined.of > 0 => Work::Refining,
                _ => Work::Complete,
            },
        }
    }
}
