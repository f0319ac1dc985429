//! Decoding one picture file into texels, within limits. Pictures come from unknown sources, and
//! decoders have panicked on some.

use super::{dds, options::Limits};
use crate::raster::color::{linear_from_srgb, srgb_from_linear};
use crate::scene::{Encoding, Texture};
use glam::Vec3;
use image::{ColorType, DynamicImage, ImageDecoder, ImageFormat, ImageReader, Rgba32FImage};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::{io::Cursor, path::Path};

/// A decoded picture.
#[derive(Clone, Debug)]
pub(super) struct Picture {
    /// sRGB colours; alpha as in the file.
    pub(super) texture: Texture,
    /// True where alpha is not the same in all texels.
    pub(super) alpha_varies: bool,
}

/// Why a picture is not used.
#[derive(Debug, thiserror::Error)]
pub(super) enum PictureError {
    #[error("{0}")]
    Unreadable(String),
    #[error("its data: address cannot be read")]
    DataAddress,
    #[error(transparent)]
    Decode(#[from] image::ImageError),
    #[error("the decoder failed on it")]
    DecoderPanicked,
    #[error("it is empty")]
    Empty,
    #[error("{width} x {height} is too large; at most {side} on a side and {megabytes} MB")]
    TooLarge { width: u32, height: u32, side: u32, megabytes: u64 },
    #[error("all textures together exceed {megabytes} MB")]
    AllTooLarge { megabytes: u64 },
}

/// Takes a file's bytes, and its name for formats without a signature; returns width and height
/// without decoding.
pub(super) fn dimensions(bytes: &[u8], path: &Path, limits: &Limits) -> Result<[u32; 2], PictureError> {
    let (width, height, decoded) = match dds::plain_size(bytes) {
        Some((width, height)) => (width, height, u64::from(width) * u64::from(height) * 4),
        None => guarded(|| decoded_size(reader(bytes, path, limits)?))?,
    };
    if width == 0 || height == 0 {
        return Err(PictureError::Empty);
    }
    // Not every decoder keeps the limits it is given, so they are checked here as well.
    if width.max(height) > limits.texture_side || decoded > limits.texture_bytes {
        let (side, megabytes) = (limits.texture_side, limits.texture_bytes >> 20);
        return Err(PictureError::TooLarge { width, height, side, megabytes });
    }
    if image::guess_format(bytes).is_ok_and(|format| format == ImageFormat::OpenExr) {
        guarded(|| check_layers(bytes, limits))?;
    }
    Ok([width, height])
}

/// Checks the sizes of all layers and tiles of an OpenEXR file: its decoder allocates by them,
/// while the size of the picture is that of its display window.
fn check_layers(bytes: &[u8], limits: &Limits) -> Result<(), PictureError> {
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|error| PictureError::Unreadable(error.to_string()))?;
    for header in &meta.headers {
        let tile = match header.blocks {
            exr::meta::BlockDescription::Tiles(tiles) => tiles.tile_size,
            exr::meta::BlockDescription::ScanLines => header.layer_size,
        };
        for size in [header.layer_size, tile] {
            let [width, height] = [size.width(), size.height()].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
            let texels = u64::from(width).saturating_mul(u64::from(height));
            let decoded = texels.saturating_mul(header.channels.bytes_per_pixel as u64);
            if width.max(height) > limits.texture_side || decoded > limits.texture_bytes {
                let (side, megabytes) = (limits.texture_side, limits.texture_bytes >> 20);
                return Err(PictureError::TooLarge { width, height, side, megabytes });
            }
        }
    }
    Ok(())
}

/// Takes a file's bytes, which [`dimensions`] must have accepted; returns the picture.
pub(super) fn decode(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Picture, PictureError> {
    let image = match dds::plain(bytes) {
        Some(rgba) => DynamicImage::ImageRgba8(rgba),
        None => guarded(|| Ok(reader(bytes, path, limits)?.decode()?))?,
    };
    let rgba = match image {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => from_float(&image.into_rgba32f()),
        other => other.into_rgba8(),
    };
    let [width, height] = [rgba.width(), rgba.height()];
    let texels: Vec<[u8; 4]> = rgba.pixels().map(|p| p.0).collect();
    let first = texels.first().ok_or(PictureError::Empty)?[3];
    let alpha_varies = texels.iter().any(|t| t[3] != first);
    Ok(Picture { texture: Texture { width, height, texels, encoding: Encoding::Srgb }, alpha_varies })
}

/// Converts a float picture, which is linear and unbounded, to 8-bit sRGB. Values that are not
/// finite become black.
fn from_float(image: &Rgba32FImage) -> image::RgbaImage {
    let byte = |x: f32| (x * 255.0 + 0.5) as u8; // saturates; NaN is 0
    let convert = |c: f32| byte(srgb_from_linear(if c.is_finite() { c.clamp(0.0, 1.0) } else { 0.0 }));
    image::RgbaImage::from_fn(image.width(), image.height(), |x, y| {
        let [r, g, b, a] = image.get_pixel(x, y).0;
        image::Rgba([convert(r), convert(g), convert(b), byte(a)])
    })
}

fn reader<'a>(
    bytes: &'a [u8],
    path: &Path,
    limits: &Limits,
) -> Result<ImageReader<Cursor<&'a [u8]>>, PictureError> {
    let mut reader = ImageReader::new(Cursor::new(bytes));
    if let Ok(format) = ImageFormat::from_path(path) {
        reader.set_format(format);
    }
    let mut reader = reader.with_guessed_format().map_err(image::ImageError::IoError)?;
    let mut allowed = image::Limits::default();
    allowed.max_image_width = Some(limits.texture_side);
    allowed.max_image_height = Some(limits.texture_side);
    allowed.max_alloc = Some(limits.texture_bytes);
    reader.limits(allowed);
    Ok(reader)
}

/// Returns width, height, and the bytes of the picture as it is decoded and converted.
fn decoded_size(reader: ImageReader<Cursor<&[u8]>>) -> Result<(u32, u32, u64), PictureError> {
    let decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    let is_float = matches!(decoder.color_type(), ColorType::Rgb32F | ColorType::Rgba32F);
    // Floats become four floats a texel, and everything becomes four bytes.
    let converted = u64::from(width) * u64::from(height) * if is_float { 16 } else { 4 };
    Ok((width, height, converted.max(decoder.total_bytes())))
}

fn guarded<T>(work: impl FnOnce() -> Result<T, PictureError>) -> Result<T, PictureError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or(Err(PictureError::DecoderPanicked))
}

/// The picture shown for a missing texture: a magenta checker, which is seen on any surface.
pub(super) fn checker() -> Texture {
    const SIDE: u32 = 8;
    let texel =
        |i: u32| if (i % SIDE + i / SIDE).is_multiple_of(2) { [255, 0, 255, 255] } else { [96, 96, 96, 255] };
    let texels = (0..SIDE * SIDE).map(texel).collect();
    Texture { width: SIDE, height: SIDE, texels, encoding: Encoding::Srgb }
}

/// Returns a texture whose alpha is the luma of the picture, for coverage stored as a grey picture.
pub(super) fn coverage(picture: &Texture) -> Texture {
    let texels = picture.texels.iter().map(|t| [255, 255, 255, luma(t)]).collect();
    Texture { texels, encoding: Encoding::Linear, ..*picture }
}

/// True for a picture of directions, which is mostly bluish; false for one of heights, which is
/// grey.
pub(super) fn holds_normals(picture: &Texture) -> bool {
    /// By how much blue, on average, exceeds the mean of red and green: a flat map has one half.
    const BLUISH: f32 = 1.0 / 8.0;
    let mean = mean_linear(picture);
    mean.z - (mean.x + mean.y) / 2.0 > BLUISH
}

/// Returns the normal map of a picture of heights, which repeats. White is 2 % of the width of the
/// picture above black: MTL gives no unit, and joints of brick are as deep as that.
pub(super) fn normals_of_heights(picture: &Texture) -> Texture {
    const HEIGHT: f32 = 0.02;
    let (width, height) = (picture.width as usize, picture.height as usize);
    let at = |x: usize, y: usize| f32::from(luma(&picture.texels[y % height * width + x % width])) / 255.0;
    // Both middle values stand for zero.
    let byte = |part: f32| (part * 127.0 + if part < 0.0 { 127.0 } else { 128.0 }).round() as u8;
    let texel = |i: usize| {
        let (x, y) = (i % width, i / width);
        let right = at(x + 1, y) - at(x + width - 1, y);
        let down = at(x, y + 1) - at(x, y + height - 1);
        let slope = HEIGHT * width as f32 / 2.0;
        let n = Vec3::new(-right * slope, down * slope, 1.0).normalize_or(Vec3::Z);
        [byte(n.x), byte(n.y), byte(n.z), 255]
    };
    let texels = (0..width * height).map(texel).collect();
    Texture { texels, encoding: Encoding::Linear, ..*picture }
}

/// Returns the luma of a texel.
pub(super) fn luma([r, g, b, _]: &[u8; 4]) -> u8 {
    (0.2126 * f32::from(*r) + 0.7152 * f32::from(*g) + 0.0722 * f32::from(*b) + 0.5) as u8
}

/// True where so many texels are neither there nor gone that they are not only the edges of holes:
/// cloth and frosted films, not leaves.
pub(super) fn is_translucent(coverage: impl ExactSizeIterator<Item = u8>) -> bool {
    /// Share of the texels. Along the edges of the leaves of a published room it is 2 %.
    const SHARE: f32 = 1.0 / 8.0;
    let count = coverage.len();
    let between = coverage.filter(|alpha| (16..240).contains(alpha)).count();
    between as f32 > SHARE * count as f32
}

/// Returns the picture with its alpha mapped.
pub(super) fn with_alpha(picture: &Texture, alpha: impl Fn(u8) -> u8) -> Texture {
    let texels = picture.texels.iter().map(|&[r, g, b, a]| [r, g, b, alpha(a)]).collect();
    Texture { texels, ..*picture }
}

/// Returns the mean linear colour of an sRGB picture.
pub(super) fn mean_color(picture: &Texture) -> Vec3 {
    mean(picture, |byte| linear_from_srgb(byte as f32 / 255.0))
}

/// Returns the mean of a picture whose values are not colours, in 0 to 1.
pub(super) fn mean_linear(picture: &Texture) -> Vec3 {
    mean(picture, |byte| byte as f32 / 255.0)
}

fn mean(picture: &Texture, decode: impl Fn(usize) -> f32) -> Vec3 {
    let mut counts = [[0u64; 256]; 3];
    for texel in &picture.texels {
        for (counts, value) in counts.iter_mut().zip(texel) {
            counts[*value as usize] += 1;
        }
    }
    let mean = |counts: [u64; 256]| {
        let sum: f64 = (0..256).map(|i| counts[i] as f64 * f64::from(decode(i))).sum();
        (sum / picture.texels.len() as f64) as f32
    };
    Vec3::from_array(counts.map(mean))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The header of an OpenEXR file with a display window of one pixel, and nothing after it.
    fn exr(side: i32, tile: Option<u32>) -> Vec<u8> {
        let mut bytes = vec![0x76, 0x2F, 0x31, 0x01, 2, if tile.is_some() { 2 } else { 0 }, 0, 0];
        let mut add = |name: &str, kind: &str, value: &[u8]| {
            bytes.extend([name.as_bytes(), b"\0", kind.as_bytes(), b"\0"].concat());
            bytes.extend((value.len() as u32).to_le_bytes());
            bytes.extend(value);
        };
        let words = |values: &[i32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        let channel = [b"R\0".as_slice(), &words(&[2, 0, 1, 1]), b"\0"].concat();
        add("channels", "chlist", &channel);
        add("compression", "compression", &[0]);
        add("dataWindow", "box2i", &words(&[0, 0, side - 1, side - 1]));
        add("displayWindow", "box2i", &words(&[0, 0, 0, 0]));
        add("lineOrder", "lineOrder", &[0]);
        add("pixelAspectRatio", "float", &1f32.to_le_bytes());
        add("screenWindowCenter", "v2f", &words(&[0, 0]));
        add("screenWindowWidth", "float", &1f32.to_le_bytes());
        if let Some(tile) = tile {
            let size = [tile.to_le_bytes(), tile.to_le_bytes()].concat();
            add("tiles", "tiledesc", &[size.as_slice(), &[0]].concat());
        }
        bytes.push(0);
        bytes
    }

    /// The decoder allocates by the layer and by the tile, whatever the display window says.
    #[test]
    fn layers_and_tiles_of_exr_files_are_within_the_limits() {
        let limits = Limits::default();
        let is_too_large =
            |bytes: &[u8]| matches!(check_layers(bytes, &limits), Err(PictureError::TooLarge { .. }));
        assert!(check_layers(&exr(4, None), &limits).is_ok());
        assert!(check_layers(&exr(4, Some(4)), &limits).is_ok());
        assert!(is_too_large(&exr(20_000, None)));
        assert!(is_too_large(&exr(10_000, None)), "400 MB");
        assert!(is_too_large(&exr(4, Some(20_000))));
    }

    /// A TIFF of grey bytes that says its size, without the bytes.
    fn grey_tiff(side: u32) -> Vec<u8> {
        let entries: [(u16, u32); 9] = [
            (256, side),
            (257, side),
            (258, 8),
            (259, 1),
            (262, 1),
            (273, 8),
            (277, 1),
            (278, side),
            (279, side * side),
        ];
        let mut bytes = b"II*\0\x08\0\0\0\x09\0".to_vec();
        for (tag, value) in entries {
            // A number of four bytes, once.
            bytes.extend([tag.to_le_bytes(), 4u16.to_le_bytes()].concat());
            bytes.extend([1u32.to_le_bytes(), value.to_le_bytes()].concat());
        }
        bytes.extend([0; 4]);
        bytes
    }

    /// The size counts in the bytes of its channels: not every TIFF is made of floats.
    #[test]
    fn a_tiff_of_bytes_may_be_larger_than_one_of_floats() {
        let limits = Limits::default();
        let size = |side| dimensions(&grey_tiff(side), Path::new("a.tif"), &limits);
        assert_eq!(size(5000).unwrap(), [5000; 2]);
        assert!(matches!(size(9000), Err(PictureError::TooLarge { .. })));
    }
}
