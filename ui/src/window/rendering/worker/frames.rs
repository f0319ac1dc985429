//! Rendering, resuming, refining and publishing frames.

use super::super::{Message, PublishedFrame, panic_text};
use super::state::Worker;
use afterimage::Walkthrough;
use afterimage::trace::parallel::Stop;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// A frame that is resumed or refined is shown at this interval: often enough to see it converge,
/// and rarely enough that drawing takes little time compared to tracing. Any change ends the work
/// at once.
const SLICE_TIME: Duration = Duration::from_millis(200);

/// Result of a slice of work on a frame.
struct Slice {
    is_shown: bool,
    is_refinement: bool,
    has_converged: bool,
}

impl Worker {
    /// Renders the requested frame, up to its budget, and shows it.
    pub(super) fn render(&mut self, generation: u64) {
        let (Some(walk), Some(request)) = (&mut self.walk, self.request) else { return };
        if *walk.settings() != request.settings {
            walk.set_settings(request.settings);
            self.refused.clear();
        }
        if request.is_compared {
            walk.drop_refinement();
        }
        let (shared, start) = (self.shared.clone(), Instant::now());
        self.rendered = Some(generation);
        let stop = || match request.budget {
            Some(budget) => shared.is_abandoned() || start.elapsed() >= budget,
            None => shared.is_stale(generation),
        };
        self.show(generation, |walk| {
            walk.render(&request.camera, request.size, &stop);
            shared.frames_rendered.fetch_add(1, Ordering::AcqRel);
            let is_shown = request.budget.is_some() || !shared.is_stale(generation);
            Slice { is_shown, is_refinement: false, has_converged: false }
        });
    }

    /// Resumes the last frame, which was cut at its budget, for a slice of time.
    pub(super) fn resume(&mut self, generation: u64) {
        self.show_slice(generation, |walk, stop| {
            walk.resume(stop);
            let is_complete = walk.frame().stats.is_complete;
            Slice { is_shown: true, is_refinement: !is_complete, has_converged: false }
        });
    }

    /// Refines the last frame for a slice of time. After a panic it is not tried again.
    pub(super) fn refine(&mut self, generation: u64) {
        let slice = self.show_slice(generation, |walk, stop| {
            let state = walk.refine(stop);
            Slice { is_shown: state.of > 0, is_refinement: true, has_converged: state.is_complete }
        });
        self.converged = slice.is_none_or(|slice| slice.has_converged).then_some(generation);
    }

    /// Works on the last frame for a slice of time, and shows it unless it has become stale.
    fn show_slice(
        &mut self,
        generation: u64,
        work: impl FnOnce(&mut Walkthrough, Stop<'_>) -> Slice + Send,
    ) -> Option<Slice> {
        let (shared, start) = (self.shared.clone(), Instant::now());
        self.show(generation, |walk| {
            let slice = work(walk, &|| shared.is_stale(generation) || start.elapsed() >= SLICE_TIME);
            Slice { is_shown: slice.is_shown && !shared.is_stale(generation), ..slice }
        })
    }

    /// Works on the walkthrough and publishes its frame. Returns `None` after a panic; the
    /// walkthrough then starts again, because its buffers may be half written.
    fn show(
        &mut self,
        generation: u64,
        work: impl FnOnce(&mut Walkthrough) -> Slice + Send,
    ) -> Option<Slice> {
        let (walk, added, pool) = (self.walk.as_mut()?, &self.added, &self.pool);
        let mut published = self.shared.exchange.spare();
        let done = catch_unwind(AssertUnwindSafe(|| {
            pool.install(|| {
                let slice = work(walk);
                if slice.is_shown {
                    published.fill(walk.frame(), &walk.tracer().scene().frame, walk.used(), generation);
                    published.list(walk.cache(), walk.used(), added);
                    published.is_refinement = slice.is_refinement;
                }
                (slice, published)
            })
        }));
        match done {
            Ok((slice, published)) => {
                self.publish(published, slice.is_shown);
                Some(slice)
            }
            Err(panic) => {
                let settings = self.request.map_or(*walk.settings(), |r| r.settings);
                *walk = Walkthrough::new(walk.tracer().clone(), settings).progressive();
                self.send(Message::Failed(format!("rendering failed: {}", panic_text(&*panic))));
                None
            }
        }
    }

    fn publish(&self, frame: PublishedFrame, is_shown: bool) {
        if is_shown && !self.shared.abandon.load(Ordering::Acquire) {
            self.shared.exchange.publish(frame);
        }
        (self.wake)();
    }
}
