//! Progress of an import, and its cancellation.

use crate::scene::SceneError;

/// Phase of an import.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// The file is read into memory.
    Reading,
    /// Its text is parsed.
    Parsing,
    /// Material libraries are read.
    Materials,
    /// Pictures are decoded.
    Textures,
    /// Triangles are made.
    Building,
}

impl Phase {
    /// Returns a description for users.
    pub fn label(self) -> &'static str {
        match self {
            Self::Reading => "reading the file",
            Self::Parsing => "parsing the model",
            Self::Materials => "reading materials",
            Self::Textures => "decoding textures",
            Self::Building => "building triangles",
        }
    }
}

/// Callback that receives a phase and its progress, 0 to 1, on any thread. It returns `false` to
/// cancel the import.
pub type Progress<'a> = &'a (dyn Fn(Phase, f32) -> bool + Sync);

/// Reports progress to the caller of the import, and learns of a cancellation.
pub(super) struct Steps<'a> {
    pub(super) progress: Progress<'a>,
}

impl Steps<'_> {
    /// Reports progress. Fails with [`SceneError::Cancelled`] where the caller has cancelled.
    pub(super) fn at(&self, phase: Phase, fraction: f32) -> Result<(), SceneError> {
        if (self.progress)(phase, fraction.clamp(0.0, 1.0)) { Ok(()) } else { Err(SceneError::Cancelled) }
    }
}
