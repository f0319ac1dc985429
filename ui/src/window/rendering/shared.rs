//! State that the window shares with its render thread.

use super::{Exchange, Outcome, RenderCommand, RenderRequest, locked};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Condvar, Mutex};

/// Request, commands and traced references that wait for the render thread.
#[derive(Debug, Default)]
pub(super) struct Inbox {
    pub(super) request: Option<RenderRequest>,
    /// Set with another scene. A pose of the old scene may lie inside a wall of the new one, so no
    /// reference may be traced there.
    pub(super) drops_request: bool,
    pub(super) commands: Vec<RenderCommand>,
    pub(super) outcomes: Vec<Outcome>,
}

#[derive(Debug, Default)]
pub(super) struct Shared {
    pub(super) inbox: Mutex<Inbox>,
    /// Signals that the inbox or `quit` has changed.
    pub(super) bell: Condvar,
    /// Generation: raised by each change of what the next frame shows.
    pub(super) generation: AtomicU64,
    /// The frame that is being rendered is of no use, because its scene is gone.
    pub(super) abandon: AtomicBool,
    pub(super) quit: AtomicBool,
    /// A reference is being traced.
    pub(super) is_adding: AtomicBool,
    /// A frame was shown, and it is not known yet whether it asks for a reference.
    pub(super) is_deciding: AtomicBool,
    pub(super) frames_rendered: AtomicU64,
    pub(super) exchange: Exchange,
}

impl Shared {
    /// Changes what the next frame shows, and returns its generation. The generation is raised
    /// under the lock, so that the render thread never sees a change without its generation.
    pub(super) fn change(&self, write: impl FnOnce(&mut Inbox)) -> u64 {
        let mut inbox = locked(&self.inbox);
        write(&mut inbox);
        let generation = self.generation.fetch_add(1, Ordering::AcqRel) + 1;
        drop(inbox);
        self.bell.notify_all();
        generation
    }

    /// Adds to the inbox without changing the next frame.
    pub(super) fn note(&self, write: impl FnOnce(&mut Inbox)) {
        write(&mut locked(&self.inbox));
        self.bell.notify_all();
    }

    /// Delivers a reference that was traced, or the reason why it was not.
    pub(super) fn deliver(&self, outcome: Outcome) {
        if matches!(outcome, Outcome::Traced(_)) {
            self.change(|inbox| inbox.outcomes.push(outcome));
        } else {
            self.note(|inbox| inbox.outcomes.push(outcome));
        }
    }

    /// True where the frame of a generation is no longer wanted.
    pub(super) fn is_stale(&self, generation: u64) -> bool {
        self.generation.load(Ordering::Relaxed) != generation || self.is_abandoned()
    }

    /// True where the frame that is being rendered is of no use at all.
    pub(super) fn is_abandoned(&self) -> bool {
        self.quit.load(Ordering::Relaxed) || self.abandon.load(Ordering::Relaxed)
    }
}
