//! `render --projection`.

use clap::{Args, ValueEnum};

/// How directions become points of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Projection {
    /// A pinhole camera.
    #[default]
    Perspective,
    /// All directions: columns are longitudes, rows are latitudes.
    Equirectangular,
}

/// The flags of the projection.
#[derive(Args, Clone, Debug)]
pub(crate) struct ProjectionArgs {
    /// Projection of the picture: as a pinhole camera sees it, or `equirectangular` for a panorama
    /// of all directions, twice as wide as high, with the camera's heading in its middle
    /// [default: perspective].
    #[arg(long, value_name = "perspective|equirectangular", default_value = "perspective")]
    #[arg(value_enum, hide_possible_values = true, hide_default_value = true)]
    pub(super) projection: Projection,
}
