//! One picture file to texels, within limits: pictures come from strangers, and decoders have panicked before.

use crate::import::Limits;
use crate::raster::color::{linear_from_srgb, srgb_from_linear};
use crate::scene::{Encoding, Texture};
use glam::Vec3;
use image::{DynamicImage, ImageFormat, ImageReader, Rgba32FImage};
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// A picture as textures are made from it.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    /// sRGB colours; alpha as in the file.
    pub(crate) texture: Texture,
    /// Its alpha says something.
    pub(crate) alpha_varies: bool,
}

/// Takes a file's bytes and its name, for formats without a signature; returns its width and height without decoding.
pub(crate) fn dimensions(bytes: &[u8], path: &Path, limits: &Limits) -> Result<[u32; 2], String> {
    let (width, height) = guarded(|| reader(bytes, path, limits)?.into_dimensions().map_err(text))?;
    let decoded = u64::from(width) * u64::from(height) * bytes_per_texel(bytes, path);
    if width == 0 || height == 0 {
        return Err("it is empty".to_owned());
    }
    // Not every decoder keeps the limits it is given, so they are checked here as well.
    if width.max(height) > limits.texture_side || decoded > limits.texture_bytes {
        return Err(format!(
            "{width} x {height} is too large; at most {} on a side and {} MB",
            limits.texture_side,
            limits.texture_bytes >> 20
        ));
    }
    Ok([width, height])
}

/// Takes a file's bytes; returns its texels. [`dimensions`] must have accepted it.
pub(crate) fn decode(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Picture, String> {
    let image = guarded(|| reader(bytes, path, limits)?.decode().map_err(text))?;
    let rgba = match image {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => from_float(&image.into_rgba32f()),
        other => other.into_rgba8(),
    };
    let [width, height] = [rgba.width(), rgba.height()];
    let texels: Vec<[u8; 4]> = rgba.pixels().map(|p| p.0).collect();
    let first = texels.first().ok_or("it is empty")?[3];
    let alpha_varies = texels.iter().any(|t| t[3] != first);
    Ok(Picture { texture: Texture { width, height, texels, encoding: Encoding::Srgb }, alpha_varies })
}

/// Float pictures are linear and may hold anything; what is not a number becomes black.
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
) -> Result<ImageReader<Cursor<&'a [u8]>>, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes));
    if let Ok(format) = ImageFormat::from_path(path) {
        reader.set_format(format);
    }
    let mut reader = reader.with_guessed_format().map_err(|e| e.to_string())?;
    let mut allowed = image::Limits::default();
    allowed.max_image_width = Some(limits.texture_side);
    allowed.max_image_height = Some(limits.texture_side);
    allowed.max_alloc = Some(limits.texture_bytes);
    reader.limits(allowed);
    Ok(reader)
}

fn bytes_per_texel(bytes: &[u8], path: &Path) -> u64 {
    let format = image::guess_format(bytes).or_else(|_| ImageFormat::from_path(path));
    if matches!(format, Ok(ImageFormat::Hdr)) { 16 } else { 4 }
}

fn text(error: image::ImageError) -> String {
    error.to_string()
}

fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| Err("the decoder failed on it".to_owned()))
}

/// The colour that marks a missing texture, on a checker so that it is seen on any surface.
pub(crate) fn checker() -> Texture {
    const SIDE: u32 = 8;
    let texel =
        |i: u32| if (i % SIDE + i / SIDE).is_multiple_of(2) { [255, 0, 255, 255] } else { [96, 96, 96, 255] };
    let texels = (0..SIDE * SIDE).map(texel).collect();
    Texture { width: SIDE, height: SIDE, texels, encoding: Encoding::Srgb }
}

/// A texture whose alpha is the picture's brightness, for coverage stored as a grey picture.
pub(crate) fn coverage(picture: &Texture) -> Texture {
    let luminance = |[r, g, b, _]: [u8; 4]| {
        (0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b) + 0.5) as u8
    };
    let texels = picture.texels.iter().map(|t| [255, 255, 255, luminance(*t)]).collect();
    Texture { texels, encoding: Encoding::Linear, ..*picture }
}

/// The picture with another alpha.
pub(crate) fn with_alpha(picture: &Texture, alpha: impl Fn(u8) -> u8) -> Texture {
    let texels = picture.texels.iter().map(|&[r, g, b, a]| [r, g, b, alpha(a)]).collect();
    Texture { texels, ..*picture }
}

/// The mean linear colour of an sRGB picture.
pub(crate) fn mean_color(picture: &Texture) -> Vec3 {
    mean(picture, |byte| linear_from_srgb(byte as f32 / 255.0))
}

/// The mean of a picture whose numbers are no colours.
pub(crate) fn mean_linear(picture: &Texture) -> Vec3 {
    mean(picture, |byte| byte as f32 / 255.0)
}

fn mean(picture: &Texture, decode: impl Fn(usize) -> f32) -> Vec3 {
    let mut counts = [[0u64; 256]; 3];
    for texel in &picture.texels {
        (0..3).for_each(|channel| counts[channel][texel[channel] as usize] += 1);
    }
    let mean = |counts: [u64; 256]| {
        let sum: f64 = (0..256).map(|i| counts[i] as f64 * f64::from(decode(i))).sum();
        (sum / picture.texels.len() as f64) as f32
    };
    Vec3::from_array(counts.map(mean))
}
