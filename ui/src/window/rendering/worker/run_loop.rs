//! Loop of the render thread: waits for requests and commands, applies them, and renders.

use super::super::{Message, RenderCommand, locked};
use super::state::{Worker, asks_for_pixels};
use crate::picture::memory;
use afterimage::{Walkthrough, render::schedule::Step};
use std::sync::PoisonError;
use std::sync::atomic::Ordering;

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
            self.send_picture();
        }
        self.cancel_reference();
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

    /// Drops a request that does not fit into memory: a failed allocation would end the program.
    fn refuse_too_large(&mut self) {
        let Some([width, height]) = self.request.map(|r| r.size) else { return };
        if let Err(why) = memory::check(u64::from(width) * u64::from(height), 1) {
            self.request = None;
            self.send(Message::Failed(format!("a picture of {width} x {height}: {why}")));
        }
    }

    fn apply(&mut self, command: RenderCommand) {
        match (command, &mut self.walk) {
            (RenderCommand::SetTracer(tracer), _) => {
                self.cancel_reference();
                self.shared.abandon.store(false, Ordering::Release);
                let settings = self.request.map(|r| r.settings).unwrap_or_default();
                // A new walkthrough: with another tracer in the old one, pixels that the first
                // frame has not traced yet would show the old scene.
                self.walk = Some(Walkthrough::new(tracer, settings).progressive().with_previews());
                self.added.clear();
                self.schedule.forget_failures();
            }
            (RenderCommand::AddReference(camera), _) => self.schedule.add_reference(Some(camera)),
            (RenderCommand::Picture, _) => self.wants_picture = true,
            (RenderCommand::Remove(id), Some(walk)) => {
                walk.cache_mut().remove(id);
            }
            (RenderCommand::Enable(id, is_enabled), Some(walk)) => {
                walk.cache_mut().set_enabled(id, is_enabled);
            }
            (RenderCommand::ShowReference(id), Some(_)) => self.send_reference(id),
            (RenderCommand::Clear, Some(walk)) => {
                walk.cache_mut().clear();
                self.cancel_reference();
            }
            (_, None) => {}
        }
    }
}
