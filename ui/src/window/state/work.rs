//! What the renderer is doing, in words.

use super::State;

/// What the renderer is doing, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the words say it")]
pub enum Work {
    Loading,
    NoScene,
    Paused,
    Moving,
    Editing,
    Filling,
    AddingReference,
    Complete,
    Refining,
    Converged,
}

impl Work {
    /// The word on the screen.
    pub fn word(self) -> &'static str {
        match self {
            Self::Loading => "loading",
            Self::NoScene => "no scene",
            Self::Paused => "paused",
            Self::Moving => "moving",
            Self::Editing => "applying a change",
            Self::Filling => "filling",
            Self::AddingReference => "adding a reference",
            Self::Complete => "complete",
            Self::Refining => "refining",
            Self::Converged => "converged",
        }
    }
}

impl State {
    /// What the renderer is doing, and how far it is.
    pub fn work_text(&self) -> String {
        match (self.work, &self.frame) {
            (Work::Refining, Some(frame)) => {
                let refined = frame.stats.refined;
                format!("{} {}/{}", self.work.word(), refined.pass, refined.of)
            }
            (work, _) => work.word().to_owned(),
        }
    }
}
