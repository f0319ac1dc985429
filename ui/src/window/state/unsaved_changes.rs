//! Actions that wait for an answer, because they would lose unsaved changes.

use crate::window::rendering::SceneSource;
use afterimage::Tracer;
use std::sync::Arc;

/// An action that waits for an answer.
#[derive(Clone, Debug)]
pub enum Leaving {
    /// The user closes the window.
    Close,
    /// The user opens another scene, which is not loaded yet.
    Open(SceneSource),
    /// A scene that was loaded is shown: something was changed while it was loading.
    Show(SceneSource, Arc<Tracer>),
}

/// What is done with the unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The changes are saved in the sidecar first. If that fails, the action is cancelled.
    Save,
    /// The changes are lost.
    Discard,
    /// The action is cancelled, and the changes are kept.
    Stay,
}
