//! What is switched on.

use crate::window::gpu::presentation::{Coloring, Heatmap};
use crate::window::input::fly_camera::ViewChange;

/// What is switched on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Types over the picture.
    pub heatmap: Heatmap,
    /// What their colours mean.
    pub coloring: Coloring,
    /// Type 3 is outlined.
    pub has_outline: bool,
    /// Menu and side panel.
    pub shows_panels: bool,
    /// Figures over the viewport.
    pub shows_statistics: bool,
    /// The keys.
    pub shows_help: bool,
    /// Nothing is rendered.
    pub is_paused: bool,
    /// How views change.
    pub view_change: ViewChange,
}
