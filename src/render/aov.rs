//! What a finished frame knows of its pixels, as channels of a file and as pictures.

use super::frame::{Frame, NO_SUPPLIER};
use crate::raster::color::{ToneMap, srgb8};
use crate::raster::save::Channel;
use crate::raster::types_picture::type_color;
use crate::reference::frame::NO_TRIANGLE;
use crate::trace::{SurfacePoint, Tracer};
use glam::Vec3;
use rayon::prelude::*;

/// Something other than colour that a file can hold of each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// `depth.Z`: metres along the viewing axis; infinite for the sky.
    Depth,
    /// `normal.X`, `.Y`, `.Z`: the unit shading normal in world space; zero for the sky.
    Normal,
    /// `type.V`: 1, 2 or 3.
    Type,
    /// `reference.V`: which reference supplied it, by its position in the list; 4294967295 for none.
    Reference,
    /// `primitive.V`: the triangle seen; 4294967295 for the sky.
    Primitive,
}

impl Aov {
    /// All of them.
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

    /// Its channels.
    pub fn channels(self, frame: &Frame, tracer: &Tracer) -> Vec<Channel> {
        match self {
            Self::Depth => {
                let metres = 1.0 / tracer.scene().frame.units_per_metre as f32;
                vec![Channel::real("depth.Z", frame.disparity.iter().map(|d| metres / d).collect())]
            }
            Self::Normal => {
                let normals = normals(frame, tracer);
                let channel = |name, i: usize| Channel::real(name, normals.iter().map(|n| n[i]).collect());
                vec![channel("normal.X", 0), channel("normal.Y", 1), channel("normal.Z", 2)]
            }
            Self::Type => {
                vec![Channel::index("type.V", frame.types.iter().map(|t| t.number().into()).collect())]
            }
            Self::Reference => {
                let index = |s: &u8| if *s == NO_SUPPLIER { u32::MAX } else { (*s).into() };
                vec![Channel::index("reference.V", frame.supplier.iter().map(index).collect())]
            }
            Self::Primitive => vec![Channel::index("primitive.V", frame.triangle.clone())],
        }
    }
}

/// World axes and scene axes are parallel.
fn normals(frame: &Frame, tracer: &Tracer) -> Vec<Vec3> {
    let normal = |(pixel, (&triangle, &disparity)): (usize, (&u32, &f32))| {
        if triangle == NO_TRIANGLE || disparity <= 0.0 {
            return Vec3::ZERO;
        }
        let direction = frame.view.direction_of_pixel(pixel as u32);
        let position = frame.view.eye + direction / disparity;
        SurfacePoint::from_position(tracer.scene(), triangle, position, direction).shading_normal
    };
    frame.triangle.par_iter().zip(&frame.disparity).enumerate().map(normal).collect()
}

/// The frame as a screen shows it.
pub fn display_picture(frame: &Frame, exposure_ev: f32, tone_map: ToneMap) -> Vec<[u8; 3]> {
    frame.radiance.par_iter().map(|r| srgb8(*r, exposure_ev, tone_map)).collect()
}

/// The type of every pixel, in exactly three colours.
pub fn types_picture(frame: &Frame) -> Vec<[u8; 3]> {
    frame.types.iter().map(|t| type_color(t.number())).collect()
}
