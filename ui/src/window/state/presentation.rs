//! How a finished frame is shown: heatmap, outline, exposure, tone mapping and overlay.

use afterimage::raster::color::ToneMap;
use egui::Color32;

/// Heatmap colour of pixels that the last frame does not contain and that are filled from their
/// surroundings until the next frame.
pub const FILLED_COLOR: Color32 = Color32::from_rgb(0xCC, 0x79, 0xA7);

/// How pixel types are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heatmap {
    /// Only the picture is shown.
    #[default]
    Off,
    /// The picture and the types are shown, blended equally.
    Blend,
    /// Only the types are shown.
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
    /// The picture is shown without an overlay.
    #[default]
    None,
    /// The full tracer's picture is shown in place of the frame.
    Full,
    /// The full tracer's picture is shown right of this fraction of the width, 0..1.
    RightOf(f32),
    /// The map of differences from the full tracer's picture is shown.
    Errors,
}

/// How values become colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FalseColors {
    /// Share of the scale for a pixel that is packed as one.
    pub scale: f32,
    /// Distance of lines of equal value as a share of the scale; zero for none.
    pub line_step: f32,
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
    /// Exposure in stops: radiance is multiplied by two to this power.
    pub exposure_ev: f32,
    /// Tone map from radiance to display.
    pub tone_map: ToneMap,
    /// Overlay that compares the picture with the full tracer's.
    pub overlay: Overlay,
    /// How values become colours; `None` for frames that are pictures.
    pub false_colors: Option<FalseColors>,
    /// True for frames of white clay, in which some pixels have no light to show.
    pub is_clay: bool,
}
