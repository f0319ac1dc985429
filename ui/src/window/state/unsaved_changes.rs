//! What waits for an answer, because it would lose changes that are not saved.

use crate::window::rendering::scene_loading::SceneSource;
use afterimage::Tracer;
use std::sync::Arc;

/// What was asked for.
#[derive(Clone, Debug)]
pub enum Leaving {
    /// That the window closes.
    Close,
    /// Another scene.
    Open(SceneSource),
    /// The same, after that scene was loaded: something was changed meanwhile.
    Show(SceneSource, Arc<Tracer>),
}

/// What becomes of the changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// They are saved beside the scene first; where that fails nothing else happens.
    Save,
    /// They are lost.
    Discard,
    /// All stays as it is.
    Stay,
}
