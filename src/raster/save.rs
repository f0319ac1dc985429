//! Picture files, encoded in memory and written in one piece ([`write_atomically`]).

pub use super::atomic_file::{SaveError, write_atomically, write_new_atomically};

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds,
    Layer, LayerAttributes, Text, WritableImage,
};
use std::io::Cursor;
use std::path::Path;

/// Words beside the pixels: a name and what it says.
pub type Notes<'a> = &'a [(&'a str, String)];

/// One number per pixel, named as EXR names channels: `R`, `depth.Z`.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Its name.
    pub name: String,
    /// Its values, row-major from the top.
    pub values: ChannelValues,
}

/// What a channel holds.
#[derive(Clone, Debug, PartialEq)]
pub enum ChannelValues {
    /// Measures.
    Real(Vec<f32>),
    /// Names of things.
    Index(Vec<u32>),
}

/// Writes an 8-bit sRGB picture with notes as text chunks.
///
/// # Errors
/// [`SaveError`] with the path and the cause.
pub fn save_png(path: &Path, size: [u32; 2], srgb: &[[u8; 3]], notes: Notes<'_>) -> Result<(), SaveError> {
    let bytes = encode_png(size, srgb, notes)
        .map_err(|cause| SaveError::Encode { path: path.to_owned(), cause: cause.to_string() })?;
    write_atomically(path, &bytes)
}

/// The bytes of an 8-bit sRGB picture as a PNG file, with notes as text chunks.
///
/// # Errors
/// Where the pixels do not fill the size or a note cannot be expressed.
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

/// Writes an OpenEXR file of named channels, without loss, with notes as attributes.
///
/// # Errors
/// [`SaveError`] with the path and the cause.
pub fn save_exr(
    path: &Path,
    size: [u32; 2],
    channels: Vec<Channel>,
    notes: Notes<'_>,
) -> Result<(), SaveError> {
    let failed = |cause: String| SaveError::Encode { path: path.to_owned(), cause };
    let size = size.map(|s| s as usize);
    if channels.iter().any(|c| c.values.len() != size[0] * size[1]) {
        return Err(failed("a channel has not one value per pixel".to_owned()));
    }
    let channels =
        channels.into_iter().map(|c| AnyChannel::new(c.name.as_str(), FlatSamples::from(c.values))).collect();
    let mut layer = Layer::new(
        (size[0], size[1]),
        LayerAttributes::default(),
        Encoding::FAST_LOSSLESS,
        AnyChannels::sort(channels),
    );
    for (name, text) in notes {
        if let (Some(name), Some(text)) = (Text::new_or_none(name), Text::new_or_none(text)) {
            layer.attributes.other.insert(name, AttributeValue::Text(text));
        }
    }
    let window = IntegerBounds::from_dimensions((size[0], size[1]));
    let image = Image { attributes: ImageAttributes::new(window), layer_data: layer };
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).map_err(|e| failed(e.to_string()))?;
    write_atomically(path, &bytes.into_inner())
}

impl Channel {
    /// A channel of measures.
    pub fn real(name: &str, values: Vec<f32>) -> Self {
        Self { name: name.to_owned(), values: ChannelValues::Real(values) }
    }

    /// A channel of indices.
    pub fn index(name: &str, values: Vec<u32>) -> Self {
        Self { name: name.to_owned(), values: ChannelValues::Index(values) }
    }

    /// The channels R, G, B of linear colours.
    pub fn rgb(colors: &[glam::Vec3]) -> Vec<Self> {
        let channel = |name, axis: usize| Self::real(name, colors.iter().map(|c| c[axis]).collect());
        vec![channel("R", 0), channel("G", 1), channel("B", 2)]
    }
}

impl ChannelValues {
    /// How many.
    pub fn len(&self) -> usize {
        match self {
            Self::Real(v) => v.len(),
            Self::Index(v) => v.len(),
        }
    }

    /// True where there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// As they lie in memory.
    pub(super) fn bytes(&self) -> &[u8] {
        match self {
            Self::Real(v) => bytemuck::cast_slice(v),
            Self::Index(v) => bytemuck::cast_slice(v),
        }
    }
}

impl From<ChannelValues> for FlatSamples {
    fn from(values: ChannelValues) -> Self {
        match values {
            ChannelValues::Real(v) => Self::F32(v),
            ChannelValues::Index(v) => Self::U32(v),
        }
    }
}
