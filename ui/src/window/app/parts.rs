//! The three parts of the app that handlers change.

use super::{services::Services, session::Session};
use crate::window::state::AppState;

/// What is shown, the open scene, and the threads behind them.
pub(super) struct Parts {
    pub(super) state: AppState,
    pub(super) session: Session,
    pub(super) services: Services,
}
