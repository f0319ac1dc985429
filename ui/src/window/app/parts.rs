//! `Parts`: state that panels read, the open scene, and background services.

use super::{current_scene::CurrentScene, services::Services};
use crate::window::state::AppState;

/// State that panels read, the open scene, and background services. Handlers change all three.
pub(super) struct Parts {
    pub(super) state: AppState,
    pub(super) current: CurrentScene,
    pub(super) services: Services,
}
