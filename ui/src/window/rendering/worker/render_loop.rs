//! Frames: begun, gone on with, refined, shown.

use crate::window::rendering::exchange::PublishedFrame;
use crate::window::rendering::render_thread::Message;
use crate::window::rendering::worker::{Worker, panic_text};
use afterimage::Walkthrough;
use afterimage::trace::parallel::Stop;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// A picture that is gone on with, and one at rest, is shown anew after so long: often enough to be seen converging,
/// seldom enough that drawing it is little beside tracing it. Whatever changes ends the work at once.
const SLICE_TIME: Duration = Duration::from_millis(200);

/// What a slice of going on has come to.
struct Slice {
    is_shown: bool,
    is_refinement: bool,
    has_converged: bool,
}

impl Worker {
    pub(crate) fn render(&mut self, generation: u64) {
        let (Some(walk), Some(request)) = (&mut self.walk, self.request) else { return };
        let start = Instant::now();
        let shared = &*self.shared;
        let stop = || {
            let is_useless = shared.quit.load(Ordering::Relaxed) || shared.abandon.load(Ordering::Relaxed);
            match request.budget {
                Some(budget) => is_useless || start.elapsed() >= budget,
                None => shared.is_useless(generation),
            }
        };
        if *walk.settings() != request.settings {
            walk.set_settings(request.settings);
            self.refused.clear();
        }
        if request.is_compared {
            walk.drop_refinement();
        }
        let mut published = shared.exchange.spare();
        let added = &self.added;
        let made = catch_unwind(AssertUnwindSafe(|| {
            self.pool.install(|| {
                walk.render(&request.camera, request.size, &stop);
                if request.budget.is_none() && shared.is_useless(generation) {
                    return None;
                }
                published.fill(walk.frame(), &walk.tracer().scene().frame, walk.used(), generation);
                published.list(walk.cache(), walk.used(), added);
                Some(published)
            })
        }));
        self.rendered = Some(generation);
        shared.frames_rendered.fetch_add(1, Ordering::AcqRel);
        self.publish(made);
    }

    /// Goes on for a while with the last frame, which was cut at the budget.
    pub(crate) fn resume(&mut self, generation: u64) {
        self.go_on(generation, |walk, stop| {
            walk.resume(stop);
            let is_complete = walk.frame().stats.is_complete;
            Slice { is_shown: true, is_refinement: !is_complete, has_converged: false }
        });
    }

    /// Goes on with the picture of the last frame for a while. What panics is not tried again.
    pub(crate) fn refine(&mut self, generation: u64) {
        let slice = self.go_on(generation, |walk, stop| {
            let state = walk.refine(stop);
            Slice { is_shown: state.of > 0, is_refinement: true, has_converged: state.is_complete }
        });
        self.converged = slice.is_none_or(|slice| slice.has_converged).then_some(generation);
    }

    /// Works on the last frame for a slice of time and shows how far it is, unless nobody wants it any more. `None` after
    /// a panic.
    fn go_on(
        &mut self,
        generation: u64,
        work: impl FnOnce(&mut Walkthrough, Stop<'_>) -> Slice + Send,
    ) -> Option<Slice> {
        let walk = self.walk.as_mut()?;
        let start = Instant::now();
        let shared = &*self.shared;
        let is_useless = || shared.is_useless(generation);
        let stop = || is_useless() || start.elapsed() >= SLICE_TIME;
        let mut published = shared.exchange.spare();
        let added = &self.added;
        let made = catch_unwind(AssertUnwindSafe(|| {
            self.pool.install(|| {
                let slice = work(walk, &stop);
                if is_useless() || !slice.is_shown {
                    return (slice, None);
                }
                published.fill(walk.frame(), &walk.tracer().scene().frame, walk.used(), generation);
                published.list(walk.cache(), walk.used(), added);
                published.is_refinement = slice.is_refinement;
                (slice, Some(published))
            })
        }));
        let (slice, made) = match made {
            Ok((slice, published)) => (Some(slice), Ok(published)),
            Err(panic) => (None, Err(panic)),
        };
        self.publish(made);
        slice
    }

    /// Shows what was made. After a panic the walk begins anew.
    fn publish(&mut self, made: std::thread::Result<Option<PublishedFrame>>) {
        match made {
            Ok(Some(published)) if !self.shared.abandon.load(Ordering::Acquire) => {
                self.shared.exchange.publish(published);
            }
            Ok(_) => {}
            Err(panic) => {
                // Its buffers may be half-written; the scene is not.
                if let (Some(walk), Some(request)) = (&mut self.walk, self.request) {
                    *walk = Walkthrough::new(walk.tracer().clone(), request.settings).progressive();
                }
                let text = panic_text(&*panic);
                self.say(Message::Failed(format!("rendering failed: {text}")));
            }
        }
        (self.wake)();
    }
}
