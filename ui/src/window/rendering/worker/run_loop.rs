//! Loop of the render thread: waits for requests and commands, applies them, and renders.

use super::super::{Message, RenderCommand, locked};
use super::state::{Worker, asks_for_pixels};
use crate::picture::memory;
use afterimage::{Tracer, Walkthrough, WalkthroughSettings, render::schedule::Step};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::time::Duration;

/// Time after a frame in which the next pose comes while the camera moves.
const NEXT_POSE: Duration = Duration::from_millis(100);

impl Worker {
    /// Renders until the window is closed.
    pub(in crate::window::rendering) fn run(&mut self) {
        while let Some(generation) = self.wait() {
            match self.next_step(generation) {
                Step::Rest => {}
                Step::Frame => self.render(generation),
                step => self.proceed(step, generation),
            }
            self.request_reference();
            self.request_layers();
            self.shared.is_deciding.store(false, Ordering::Release);
            self.send_picture();
        }
        self.cancel_reference();
        self.cancel_layers();
        // The light of a view at rest is stored.
        if let Some(walk) = &mut self.walk {
            walk.drop_refinement();
        }
    }

    /// Sleeps until there is something to do, and empties the inbox. Returns the generation of its
    /// content, `None` at the end.
    fn wait(&mut self) -> Option<u64> {
        let shared = self.shared.clone();
        let mut inbox = locked(&shared.inbox);
        loop {
            if shared.quit.load(Ordering::Acquire) {
                return None;
            }
            let generation = shared.generation.load(Ordering::Acquire);
            if std::mem::take(&mut inbox.drops_request) {
                self.request = None;
            }
            let request = inbox.request.or(self.request);
            let is_due = !self.schedule.has_rendered(generation)
                && self.walk.is_some()
                && request.as_ref().is_some_and(asks_for_pixels);
            let has_mail =
                inbox.request.is_some() || !inbox.commands.is_empty() || !inbox.outcomes.is_empty();
            // The settings of a new request are applied before an older frame is resumed or
            // refined.
            let can_continue = inbox.request.is_none() && self.next_step(generation) != Step::Rest;
            if can_continue
                && !is_due
                && !has_mail
                && let Some(pause) = self.pause_in_motion()
            {
                let waited = shared.bell.wait_timeout(inbox, pause);
                inbox = waited.unwrap_or_else(PoisonError::into_inner).0;
                continue;
            }
            if is_due || has_mail || can_continue {
                let is_new = inbox.request.take().is_some();
                self.request = request;
                let commands = std::mem::take(&mut inbox.commands);
                let outcomes = std::mem::take(&mut inbox.outcomes);
                drop(inbox);
                if is_new {
                    self.refuse_too_large();
                }
                for outcome in outcomes {
                    self.take_reference(outcome);
                }
                for command in commands {
                    self.apply(command);
                }
                return Some(generation);
            }
            inbox = shared.bell.wait(inbox).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// The time for which the next pose is awaited before a frame is continued: in motion, it comes
    /// as soon as the frame is drawn.
    fn pause_in_motion(&self) -> Option<Duration> {
        let is_moving = self.request.is_some_and(|request| request.is_moving);
        let left = NEXT_POSE.checked_sub(self.framed?.elapsed());
        left.filter(|left| is_moving && !left.is_zero())
    }

    /// Drops a request that does not fit into memory: a failed allocation would end the program.
    fn refuse_too_large(&mut self) {
        let Some([width, height]) = self.request.map(|r| r.size) else { return };
        if let Err(why) = memory::check(u64::from(width) * u64::from(height), 1) {
            self.request = None;
            self.send(Message::Failed(format!("a picture of {width} x {height}: {why}")));
        }
    }

    /// A walk through another scene, with the references of the last walk that still hold. Without
    /// references where a panic ended this: frames will report the bug.
    fn carried_to(&mut self, tracer: &Arc<Tracer>, settings: WalkthroughSettings) -> Walkthrough {
        let new = || Walkthrough::new(tracer.clone(), settings).progressive();
        let (Some(before), abandon) = (self.walk.take(), &self.shared.abandon) else { return new() };
        let pool = &self.pool;
        let carried = catch_unwind(AssertUnwindSafe(|| {
            let mut walk = new();
            pool.install(|| walk.take_references(before, &|| abandon.load(Ordering::Relaxed)));
            walk
        }));
        carried.unwrap_or_else(|_| new())
    }

    fn apply(&mut self, command: RenderCommand) {
        match (command, &mut self.walk) {
            (RenderCommand::SetTracer(tracer), _) => {
                self.cancel_reference();
                self.cancel_layers_except(tracer.scene().full_hash());
                self.shared.abandon.store(false, Ordering::Release);
                // The request of the old scene may be dropped already.
                let last = self.walk.as_ref().map(|walk| *walk.settings());
                let settings = self.request.map(|r| r.settings).or(last).unwrap_or_default();
                // A new walkthrough: with another tracer in the old one, pixels that the first
                // frame has not traced yet would show the old scene. Of the references it takes
                // over what still holds.
                let store = self.walk.as_mut().and_then(|walk| walk.set_store(None));
                let mut walk = self.carried_to(&tracer, settings);
                walk.set_store(self.store_of(store, &tracer));
                let entries = walk.cache().entries();
                self.added.retain(|(id, _)| entries.iter().any(|entry| entry.id == *id));
                self.walk = Some(walk);
                self.schedule.forget_failures();
            }
            (RenderCommand::AddReference(camera), _) => self.schedule.add_reference(Some(camera)),
            (RenderCommand::Picture, _) => self.wants_picture = true,
            (RenderCommand::KnowLights(knows), _) => self.knows_lights = knows,
            (RenderCommand::Remove(id), Some(walk)) => {
                walk.cache_mut().remove(id);
            }
            (RenderCommand::Enable(id, is_enabled), Some(walk)) => {
                walk.cache_mut().set_enabled(id, is_enabled);
            }
            (RenderCommand::ShowReference(id), Some(_)) => self.send_reference(id),
            (RenderCommand::ReadStore, Some(walk)) => {
                let tracer = walk.tracer().clone();
                drop(walk.set_store(None));
                let store = self.store_of(None, &tracer);
                if let Some(walk) = &mut self.walk {
                    walk.set_store(store);
                }
            }
            (RenderCommand::Clear, Some(walk)) => {
                walk.cache_mut().clear();
                self.cancel_reference();
                self.cancel_layers();
            }
            (_, None) => {}
        }
    }
}
