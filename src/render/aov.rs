//! Data of a finished frame's pixels, as channels of a file and as pictures.

use super::bands::Band;
use crate::raster::{
    color::{ToneMap, srgb8},
    pixel_types::{NO_SUPPLIER, PixelType},
    save::Channel,
};
use crate::trace::{NO_TRIANGLE, SurfacePoint, Tracer};
use glam::Vec3;
use rayon::prelude::*;

/// Data other than colour that a file can store per pixel (arbitrary output variable).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// `depth.Z`: depth along the viewing axis in metres; infinite for the sky.
    Depth,
    /// `normal.X`, `.Y`, `.Z`: the unit shading normal in world space; zero for the sky.
    Normal,
    /// `type.V`: type of the pixel, 1, 2 or 3.
    Type,
    /// `reference.V`: position in the list of the reference that supplied the pixel; 4294967295 for
    /// none.
    Reference,
    /// `primitive.V`: index of the first triangle; 4294967295 for the sky.
    Primitive,
}

impl Aov {
    /// All variants.
    pub const ALL: [Self; 5] = [Self::Depth, Self::Normal, Self::Type, Self::Reference, Self::Primitive];

    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Type => "type",
            Self::Reference => "reference",
            Self::Primitive => "primitive",
        }
    }

    /// Names of the channels, and whether their values are indices rather than quantities.
    pub fn channel_names(self) -> &'static [(&'static str, bool)] {
        match self {
            Self::Depth => &[("depth.Z", false)],
            Self::Normal => &[("normal.X", false), ("normal.Y", false), ("normal.Z", false)],
            Self::Type => &[("type.V", true)],
            Self::Reference => &[("reference.V", true)],
            Self::Primitive => &[("primitive.V", true)],
        }
    }

    /// The channels with the values of a band.
    pub fn channels(self, band: &Band, tracer: &Tracer) -> Vec<Channel> {
        match self {
            Self::Depth => {
                let metres = 1.0 / tracer.scene().frame.units_per_metre as f32;
                vec![Channel::real("depth.Z", band.disparity.iter().map(|d| metres / d).collect())]
            }
            Self::Normal => {
                let normals = normals(band, tracer);
                let channel = |name, i: usize| Channel::real(name, normals.iter().map(|n| n[i]).collect());
                vec![channel("normal.X", 0), channel("normal.Y", 1), channel("normal.Z", 2)]
            }
            Self::Type => {
                vec![Channel::index("type.V", band.types.iter().map(|t| t.number().into()).collect())]
            }
            Self::Reference => {
                let index = |s: &u8| if *s == NO_SUPPLIER { u32::MAX } else { (*s).into() };
                vec![Channel::index("reference.V", band.supplier.iter().map(index).collect())]
            }
            Self::Primitive => vec![Channel::index("primitive.V", band.triangle.clone())],
        }
    }
}

/// Unit shading normals in world space, whose axes are parallel to those of scene space.
fn normals(band: &Band, tracer: &Tracer) -> Vec<Vec3> {
    let first = band.first_row * band.view.size[0];
    let normal = |(pixel, (&triangle, &disparity)): (usize, (&u32, &f32))| {
        if triangle == NO_TRIANGLE || disparity <= 0.0 {
            return Vec3::ZERO;
        }
        let direction = band.view.direction_of_pixel(first + pixel as u32);
        let position = band.view.eye + direction / disparity;
        SurfacePoint::from_position(tracer.scene(), triangle, position, direction).shading_normal
    };
    band.triangle.par_iter().zip(&band.disparity).enumerate().map(normal).collect()
}

/// Display values, 8-bit sRGB, of some rows.
pub fn display_rows(radiance: &[Vec3], exposure_ev: f32, tone_map: ToneMap) -> Vec<[u8; 3]> {
    radiance.par_iter().map(|r| srgb8(*r, exposure_ev, tone_map)).collect()
}

/// Display values of a band whose background was left out: 8-bit sRGB of the surfaces, and coverage
/// as alpha.
pub fn display_rows_alpha(band: &Band, exposure_ev: f32, tone_map: ToneMap) -> Vec<[u8; 4]> {
    let pixel = |(&radiance, &coverage): (&Vec3, &f32)| {
        let own = if coverage > 0.0 { radiance / coverage } else { Vec3::ZERO };
        let [r, g, b] = srgb8(own, exposure_ev, tone_map);
        if coverage > 0.0 { [r, g, b, (coverage * 255.0).round() as u8] } else { [0; 4] }
    };
    band.radiance.par_iter().zip(&band.coverage).map(pixel).collect()
}

/// The types of some pixels, in exactly three colours.
pub fn types_rows(types: &[PixelType]) -> Vec<[u8; 3]> {
    types.iter().map(|t| t.srgb()).collect()
}
