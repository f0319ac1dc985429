//! `render --projection`.

use super::flags::number_in;
use clap::{Args, ValueEnum};

/// How directions become points of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Projection {
    /// A pinhole camera.
    #[default]
    Perspective,
    /// All directions: columns are longitudes, rows are latitudes.
    Equirectangular,
    /// Parallel rays: plans and elevations.
    Orthographic,
}

/// The flags of the projection.
#[derive(Args, Clone, Debug)]
pub(crate) struct ProjectionArgs {
    /// Projection of the picture: as a pinhole camera sees it, or `equirectangular` for a panorama
    /// of all directions, twice as wide as high, with the camera's heading in its middle, or
    /// `orthographic` for a plan or elevation by parallel rays, traced in full, which begin at the
    /// plane of the eye [default: perspective].
    #[arg(long, value_name = "perspective|equirectangular|orthographic", default_value = "perspective")]
    #[arg(value_enum, hide_possible_values = true, hide_default_value = true)]
    pub(super) projection: Projection,
    /// Width of what an orthographic picture shows, metres [default: the whole model].
    #[arg(long, value_name = "M", value_parser = number_in(0.001..=1e6, " metres"))]
    pub(super) width: Option<f64>,
}
