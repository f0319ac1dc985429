//! Reading a picture of the sky: Radiance (.hdr) and OpenEXR (.exr).

use super::files::{self, unreadable};
use super::options::Limits;
use crate::scene::{SceneError, SkyImage};
use exr::prelude::{ReadChannels, ReadLayers};
use image::{DynamicImage, ImageDecoder, codecs::hdr::HdrDecoder};
use std::error::Error;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Width and height in pixels, the texels, and the luminance in cd/m2 of a value of one.
type Decoded = ([u32; 2], Vec<[f32; 3]>, Option<f32>);

/// Reads a picture of the sky in latitude and longitude: twice as wide as high, up at the top,
/// north (-Z) in the centre, east (+X) to the right.
///
/// An OpenEXR file that gives the luminance of white (`whiteLuminance`) is photometric. Values of a
/// Radiance file are divided by its `EXPOSURE`, as its format says.
///
/// # Errors
/// [`SceneError::Read`] where the file is missing, no such picture, too large, not twice as wide as
/// high, or has values that are not finite.
pub fn load_sky(path: &Path, limits: &Limits) -> Result<SkyImage, SceneError> {
    let refused = |error: String, remedy: &str| unreadable(path, error, remedy);
    let bytes = files::read_limited(path, limits.sky_bytes).map_err(|error| {
        let remedy = if path.is_file() { "use a smaller picture" } else { &error.remedy };
        refused(error.cause, remedy)
    })?;
    let decoded = catch_unwind(AssertUnwindSafe(|| decode(&bytes)));
    let decoded = decoded.unwrap_or_else(|_| Err("the decoder failed on it".into()));
    let remedy = "use another picture, or convert this one";
    let (size, texels, nits) = decoded.map_err(|error| refused(error.to_string(), remedy))?;
    SkyImage::new(path, size, texels, nits).map_err(|error| refused(error.to_string(), remedy))
}

fn decode(bytes: &[u8]) -> Outcome<Decoded> {
    match bytes {
        [b'#', b'?', ..] => decode_hdr(bytes),
        [0x76, 0x2f, 0x31, 0x01, ..] => decode_exr(bytes),
        _ => Err("it is neither a Radiance picture (.hdr) nor OpenEXR".into()),
    }
}

fn decode_hdr(bytes: &[u8]) -> Outcome<Decoded> {
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes))?;
    let size: [u32; 2] = decoder.dimensions().into();
    SkyImage::check_size(size)?;
    let exposure = decoder.metadata().exposure.filter(|e| e.is_finite() && *e > 0.0).unwrap_or(1.0);
    let values = DynamicImage::from_decoder(decoder)?.into_rgb32f().into_raw();
    let texels = values.as_chunks::<3>().0.iter().map(|texel| texel.map(|v| v / exposure)).collect();
    Ok((size, texels, None))
}

fn decode_exr(bytes: &[u8]) -> Outcome<Decoded> {
    // The sizes of all layers are checked before any is decoded.
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false)?;
    for header in &meta.headers {
        let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        SkyImage::check_size([side(header.layer_size.width()), side(header.layer_size.height())])?;
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![[0.0; 3]; size.area()]),
            |(width, texels), at, (r, g, b): (f32, f32, f32)| texels[at.y() * *width + at.x()] = [r, g, b],
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))?;
    let layer = image.layer_data;
    let size = [layer.size.width() as u32, layer.size.height() as u32];
    let nits = layer.attributes.white_luminance.filter(|nits| nits.is_finite() && *nits > 0.0);
    Ok((size, layer.channel_data.pixels.1, nits))
}
