//! Options of how a finished frame is shown.

use afterimage::raster::color::ToneMap;
use egui::Color32;

/// Heatmap colour of pixels that the last frame does not contain and that are filled from their
/// surroundings until the next frame.
pub const FILLED_COLOR: Color32 = Color32::from_rgb(0xCC, 0x79, 0xA7);

/// How pixel types are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heatmap {
    /// Only the picture.
    #[default]
    Off,
    /// The picture and the types, blended equally.
    Blend,
    /// Only the types.
    Only,
}

/// Meaning of the colours of the heatmap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coloring {
    /// The type of the pixel.
    #[default]
    ByType,
    /// The reference that the light of the pixel was reused from.
    ByReference,
}

/// Overlay that compares the picture with the full tracer's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Overlay {
    /// No overlay.
    #[default]
    None,
    /// The full tracer's picture.
    Full,
    /// The full tracer's picture right of this fraction of the width.
    RightOf(f32),
    /// The error map.
    Errors,
}

/// Options of how a frame is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Presentation {
    /// How pixel types are shown.
    pub heatmap: Heatmap,
    /// Meaning of the heatmap's colours.
    pub coloring: Coloring,
    /// True to outline areas of Type 3.
    pub has_outline: bool,
    /// Exposure in stops.
    pub exposure_ev: f32,
    /// Tone map from radiance to display.
    pub tone_map: ToneMap,
    /// Overlay for comparison.
    pub overlay: Overlay,
}
