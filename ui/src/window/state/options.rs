//! Switches of the window.

use super::{Coloring, Heatmap};
use crate::window::input::ViewChange;
use crate::window::rendering::Quantity;

/// Figures over the viewport.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Statistics {
    /// What everyone wants to know: state, pictures a second, share that is reused.
    #[default]
    Short,
    /// All figures.
    Full,
    /// None.
    Off,
}

impl Statistics {
    /// The next choice: short, full, off, and short again.
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::Short => Self::Full,
            Self::Full => Self::Off,
            Self::Off => Self::Short,
        }
    }
}

/// Heatmap, panels, pause and other switches of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Whether pixel types are shown over the picture.
    pub heatmap: Heatmap,
    /// Meaning of the heatmap's colours.
    pub coloring: Coloring,
    /// Regions of Type 3 have an outline.
    pub has_outline: bool,
    /// The edges of surfaces are drawn as dark lines.
    pub has_edges: bool,
    /// What the viewport shows.
    pub quantity: Quantity,
    /// Lines of equal value are drawn over quantities in false colour.
    pub has_isolines: bool,
    /// The menu and the side panel are shown.
    pub shows_panels: bool,
    /// Figures that are shown over the viewport.
    pub statistics: Statistics,
    /// The list of keys is shown.
    pub shows_help: bool,
    /// The renderer is paused until the camera moves: no frame and no reference is traced.
    pub is_paused: bool,
    /// The pause lasts while the camera moves, and the last frame is reprojected.
    pub is_frozen: bool,
    /// Whether a change of view is eased.
    pub view_change: ViewChange,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            heatmap: Heatmap::Off,
            coloring: Coloring::ByType,
            has_outline: false,
            has_edges: false,
            quantity: Quantity::Picture,
            has_isolines: false,
            shows_panels: true,
            statistics: Statistics::Short,
            shows_help: false,
            is_paused: false,
            is_frozen: false,
            view_change: ViewChange::default(),
        }
    }
}

impl Options {
    /// Pauses rendering until the camera moves, or ends any pause.
    #[must_use]
    pub fn paused(self, is_paused: bool) -> Self {
        Self { is_paused, is_frozen: false, ..self }
    }

    /// Freezes the last frame, or ends any pause.
    #[must_use]
    pub fn frozen(self, is_frozen: bool) -> Self {
        Self { is_paused: is_frozen, is_frozen, ..self }
    }

    /// Shows the heatmap where its colouring has changed: the user wants to see it.
    #[must_use]
    pub fn with_visible_colors(self, before: &Self) -> Self {
        let is_hidden = self.coloring != before.coloring && self.heatmap == Heatmap::Off;
        Self { heatmap: if is_hidden { Heatmap::Blend } else { self.heatmap }, ..self }
    }
}
