//! Light of a reference in the setting of the lights in which it was traced.

use crate::reference::layers::LightWords;
use crate::scene::Scene;
use std::sync::Arc;

/// The light of a reference as it was traced, while it shows that of other settings of the lights.
#[derive(Clone, Debug)]
pub(super) struct TracedLight {
    pub(super) words: LightWords,
    /// State of the scene that it was traced in.
    pub(super) origin: Arc<Scene>,
}
