//! Actions that wait for an answer: those that would lose unsaved changes, and those that would
//! read what a file from elsewhere names.

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

/// A scene that waits for an answer: its session names a picture of the sky outside the folder of
/// the model.
#[derive(Clone, Debug)]
pub struct OutsidePicture {
    /// The picture, as the session names it.
    pub name: String,
    /// Where the scene was loaded from.
    pub source: SceneSource,
    /// The scene, ready for rays.
    pub tracer: Arc<Tracer>,
}

/// What is done with the unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The changes are saved in the session first. If that fails, the action is cancelled.
    Save,
    /// The changes are lost.
    Discard,
    /// The action is cancelled, and the changes are kept.
    Stay,
}
