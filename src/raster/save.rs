//! PNG files of complete pictures, and the channels of OpenEXR files. Files are written with
//! [`write_atomically`].

pub use super::atomic_file::{SaveError, Target, write_atomically};

use std::path::Path;

/// Metadata of a picture file: names and texts.
pub type Notes<'a> = &'a [(&'a str, String)];

/// Channel of an OpenEXR file: one number per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name, as OpenEXR names channels: `R`, `depth.Z`.
    pub name: String,
    /// Values, row-major from the top.
    pub values: ChannelValues,
}

/// Values of a channel.
#[derive(Clone, Debug, PartialEq)]
pub enum ChannelValues {
    /// Measured quantities.
    Real(Vec<f32>),
    /// Identifiers.
    Index(Vec<u32>),
}

/// Writes an 8-bit sRGB picture, with notes as text chunks.
///
/// # Errors
/// [`SaveError`] with the path and the cause.
pub fn save_png(path: &Path, size: [u32; 2], srgb: &[[u8; 3]], notes: Notes<'_>) -> Result<(), SaveError> {
    let bytes = encode_png(size, srgb, notes)
        .map_err(|cause| SaveError::Encode { path: path.to_owned(), cause: cause.into() })?;
    write_atomically(path, &bytes)
}

/// Returns the bytes of an 8-bit sRGB picture as a PNG file, with notes as text chunks.
///
/// # Errors
/// If the number of pixels does not match the size, or a note cannot be encoded.
pub fn encode_png(
    [width, height]: [u32; 2],
    srgb: &[[u8; 3]],
    notes: Notes<'_>,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    for (keyword, text) in notes {
        encoder.add_itxt_chunk((*keyword).to_owned(), text.clone())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytemuck::cast_slice(srgb))?;
    writer.finish()?;
    Ok(bytes)
}

impl Channel {
    /// Creates a channel of measured quantities.
    pub fn real(name: &str, values: Vec<f32>) -> Self {
        Self { name: name.to_owned(), values: ChannelValues::Real(values) }
    }

    /// Creates a channel of identifiers.
    pub fn index(name: &str, values: Vec<u32>) -> Self {
        Self { name: name.to_owned(), values: ChannelValues::Index(values) }
    }

    /// Creates the channels R, G and B of linear colours.
    pub fn rgb(colors: &[glam::Vec3]) -> Vec<Self> {
        let channel = |name, axis: usize| Self::real(name, colors.iter().map(|c| c[axis]).collect());
        vec![channel("R", 0), channel("G", 1), channel("B", 2)]
    }
}

impl ChannelValues {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Real(v) => v.len(),
            Self::Index(v) => v.len(),
        }
    }

    /// True if there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes of the values as they lie in memory.
    pub(super) fn bytes(&self) -> &[u8] {
        match self {
            Self::Real(v) => bytemuck::cast_slice(v),
            Self::Index(v) => bytemuck::cast_slice(v),
        }
    }
}
