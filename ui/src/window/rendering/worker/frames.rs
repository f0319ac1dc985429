//! Rendering, resuming, refining and publishing frames.

use super::super::{Message, PublishedFrame, Quantity, panic_text};
use super::state::Worker;
use afterimage::Walkthrough;
use afterimage::render::outlines::outlines_of_frame;
use afterimage::render::schedule::{SLICE_TIME, Step, StepOutcome};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::time::Instant;

impl Worker {
    /// Renders the requested frame, up to its budget, and shows it.
    pub(super) fn render(&mut self, generation: u64) {
        let (Some(walk), Some(request)) = (&mut self.walk, self.request) else { return };
        if *walk.settings() != request.settings {
            walk.set_settings(request.settings);
            self.schedule.forget_failures();
        }
        match &request.section {
            Some(section) => walk.set_section(&[section.plane], section.tones),
            None => walk.set_section(&[], [0.0; 2]),
        }
        self.quantity = request.quantity;
        walk.show_light(request.quantity.shows_light());
        walk.set_previews(!request.is_moving);
        walk.set_endless(request.is_endless);
        if request.is_compared {
            walk.drop_refinement();
        }
        let (shared, start) = (self.shared.clone(), Instant::now());
        self.schedule.begin_frame(generation);
        let stop = || match request.budget {
            Some(budget) => shared.is_abandoned() || start.elapsed() >= budget,
            None => shared.is_stale(generation),
        };
        self.show(generation, |walk| {
            let done = Step::Frame.run(walk, &request.camera, request.size, &stop);
            shared.frames_rendered.fetch_add(1, Ordering::AcqRel);
            let is_shown = request.budget.is_some() || !shared.is_stale(generation);
            StepOutcome { is_shown, ..done }
        });
        self.framed = Some(Instant::now());
        self.report_store();
    }

    /// Resumes or refines the last frame for a slice of time, and shows it unless it has become
    /// stale. Refining is not tried again after a panic.
    pub(super) fn proceed(&mut self, step: Step, generation: u64) {
        let Some(request) = self.request else { return };
        let (shared, start) = (self.shared.clone(), Instant::now());
        let done = self.show(generation, |walk| {
            let stop = || shared.is_stale(generation) || start.elapsed() >= SLICE_TIME;
            let done = step.run(walk, &request.camera, request.size, &stop);
            StepOutcome { is_shown: done.is_shown && !shared.is_stale(generation), ..done }
        });
        if step == Step::Refine {
            self.schedule.set_converged(generation, done.is_none_or(|done| done.has_converged));
        }
    }

    /// Works on the walkthrough and publishes its frame. Returns `None` after a panic; the
    /// walkthrough then starts again, because its buffers may be half written.
    fn show(
        &mut self,
        generation: u64,
        work: impl FnOnce(&mut Walkthrough) -> StepOutcome + Send,
    ) -> Option<StepOutcome> {
        let has_edges = self.request.is_some_and(|request| request.has_edges);
        let (walk, added, pool, quantity) = (self.walk.as_mut()?, &self.added, &self.pool, self.quantity);
        let mut published = self.shared.exchange.spare();
        published.begun = Instant::now();
        let done = catch_unwind(AssertUnwindSafe(|| {
            pool.install(|| {
                let done = work(walk);
                if done.is_shown {
                    let shown = (walk.frame(), &**walk.tracer().scene());
                    published.fill(shown, quantity, walk.used(), generation);
                    if has_edges && matches!(quantity, Quantity::Picture | Quantity::Clay) {
                        published.darken(&outlines_of_frame(walk.tracer(), walk.frame()));
                    }
                    published.list(walk.cache(), walk.used(), added);
                    published.is_refinement = done.is_refinement;
                }
                (done, published)
            })
        }));
        match done {
            Ok((done, published)) => {
                self.publish(published, done.is_shown);
                Some(done)
            }
            Err(panic) => {
                let settings = self.request.map_or(*walk.settings(), |r| r.settings);
                let mut store = walk.set_store(None);
                *walk = Walkthrough::new(walk.tracer().clone(), settings).progressive();
                if let Some(store) = &mut store {
                    store.set_tracer(walk.tracer());
                }
                walk.set_store(store);
                self.send(Message::Failed(format!("rendering failed: {}", panic_text(&*panic))));
                None
            }
        }
    }

    fn publish(&self, frame: PublishedFrame, is_shown: bool) {
        if is_shown && !self.shared.abandon.load(Ordering::Acquire) {
            self.shared.is_deciding.store(true, Ordering::Release);
            self.shared.exchange.publish(frame);
        }
        (self.wake)();
    }
}
