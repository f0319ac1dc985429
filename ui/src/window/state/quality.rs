//! What decides how good a picture is, how long it takes and how it is developed.

use afterimage::WalkthroughSettings;
use afterimage::raster::color::ToneMap;

/// Samples per light in the window: a person wants fluid motion. Files are rendered with more.
pub const WINDOW_SAMPLES: u32 = 4;

/// What decides how good a picture is and how long it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Mode, samples, bounces, placement, cache.
    pub walk: WalkthroughSettings,
    /// Rendered pixels per pixel of the viewport, along an edge.
    pub render_scale: f32,
    /// A frame is shown after so long as it is.
    pub budget_ms: f32,
    /// In stops.
    pub exposure_ev: f32,
    /// From radiance to display.
    pub tone_map: ToneMap,
}

impl Quality {
    /// The window's defaults with someone's settings.
    pub fn new(walk: WalkthroughSettings) -> Self {
        let tone_map = ToneMap::default();
        Self { walk, render_scale: 0.5, budget_ms: 100.0, exposure_ev: 0.0, tone_map }
    }
}
