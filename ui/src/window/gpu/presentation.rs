//! How a finished frame is shown.

use afterimage::raster::color::ToneMap;

/// How much of the pixel types is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heatmap {
    /// The picture alone.
    #[default]
    Off,
    /// Half picture, half types.
    Blend,
    /// Types alone.
    Only,
}

/// What the colours of the heatmap stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coloring {
    /// How a pixel came to its colour.
    #[default]
    ByType,
    /// Which reference supplied it.
    ByReference,
}

/// What lies over the picture for comparison with the full tracer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The full tracer's picture.
    Full,
    /// The full tracer's picture right of this part of the width.
    RightOf(f32),
    /// The map of errors.
    Errors,
}

/// How a frame is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Presentation {
    /// Types over the picture.
    pub heatmap: Heatmap,
    /// What their colours mean.
    pub coloring: Coloring,
    /// Type 3 is outlined.
    pub has_outline: bool,
    /// In stops.
    pub exposure_ev: f32,
    /// From radiance to display.
    pub tone_map: ToneMap,
    /// What lies over the picture.
    pub overlay: Overlay,
}
