//! Actions that wait for an answer, because they would lose unsaved changes.

use crate::window::rendering::SceneSource;
use afterimage::Tracer;
use std::sync::Arc;

/// An action that waits for an answer.
#[derive(Clone, Debug)]
pub enum Leaving {
    /// The window is closed.
    Close,
    /// Another scene is loaded.
    Open(SceneSource),
    /// A scene that was loaded is shown: something was changed while it was loading.
    Show(SceneSource, Arc<Tracer>),
}

/// What is done with the unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// They are saved beside the scene first. If that fails, the action is cancelled.
    Save,
    /// They are lost.
    Discard,
    /// The action is cancelled.
    Stay,
}
