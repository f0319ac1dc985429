//! Rendering settings of the window.

pub use afterimage::render::schedule::WINDOW_SAMPLES;

use afterimage::WalkthroughSettings;
use afterimage::raster::{color::ToneMap, exposure::Exposure};
use afterimage::render::schedule::FRAME_BUDGET;

/// Rendering settings that trade quality for time, and how frames are displayed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Mode, samples, bounces, placement and cache.
    pub walk: WalkthroughSettings,
    /// Rendered pixels per pixel of the viewport along an edge, at most, while the camera moves.
    pub render_scale: f32,
    /// Time in milliseconds after which a frame is shown, complete or not.
    pub budget_ms: f32,
    /// The picture at rest is improved until the camera moves, and not only until its last pass.
    pub keeps_improving: bool,
    /// Exposure of the picture.
    pub exposure: Exposure,
    /// The automatic exposure follows the view.
    pub follows_view: bool,
    /// Tone mapping from radiance to display.
    pub tone_map: ToneMap,
}

impl Default for Quality {
    fn default() -> Self {
        let (walk, tone_map) = (WalkthroughSettings::default(), ToneMap::default());
        let budget_ms = FRAME_BUDGET.as_secs_f32() * 1e3;
        Self {
            walk,
            render_scale: 1.0,
            budget_ms,
            keeps_improving: false,
            exposure: Exposure::Auto,
            follows_view: true,
            tone_map,
        }
    }
}
