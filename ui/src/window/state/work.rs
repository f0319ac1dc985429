//! What the renderer is doing, in words.

use crate::window::rendering::PublishedFrame;

/// What the renderer is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs, reason = "word() describes each")]
pub enum Work {
    #[default]
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
    /// The word that is shown for it.
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
            Self::Converged => "done",
        }
    }

    /// The word, with the number of passes while `frame` is being refined.
    pub(super) fn text(self, frame: Option<&PublishedFrame>) -> String {
        match (self, frame) {
            (Self::Refining, Some(frame)) => {
                let refined = frame.stats.refined;
                match refined.pass <= refined.of && !refined.is_complete {
                    true => format!("{} {}/{}", self.word(), refined.pass, refined.of),
                    false => format!("improving, pass {}", refined.pass),
                }
            }
            // The light may still improve with more passes.
            (Self::Converged, Some(frame)) => passes_done(frame.stats.refined.pass),
            _ => self.word().to_owned(),
        }
    }
}

/// Says how many passes are done.
pub(super) fn passes_done(passes: u32) -> String {
    format!("{passes} {} done", if passes == 1 { "pass" } else { "passes" })
}
