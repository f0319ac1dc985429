//! Rendering settings of the window.

use afterimage::WalkthroughSettings;
use afterimage::raster::color::ToneMap;

/// Samples per light in the window: few, because motion must be fluid. Files are rendered with
/// more.
pub const WINDOW_SAMPLES: u32 = 4;

/// Rendering settings that trade quality for time, and how frames are displayed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Mode, samples, bounces, placement and cache.
    pub walk: WalkthroughSettings,
    /// Rendered pixels per pixel of the viewport along an edge, while the camera moves.
    pub render_scale: f32,
    /// Time in milliseconds after which a frame is shown, complete or not.
    pub budget_ms: f32,
    /// Exposure in stops: radiance is multiplied by two to this power.
    pub exposure_ev: f32,
    /// Tone mapping from radiance to display.
    pub tone_map: ToneMap,
}

impl Default for Quality {
    fn default() -> Self {
        let (walk, tone_map) = (WalkthroughSettings::default(), ToneMap::default());
        Self { walk, render_scale: 0.5, budget_ms: 100.0, exposure_ev: 0.0, tone_map }
    }
}
