//! Reading PNG, JPEG and OpenEXR pictures, such as [`super::save`] and [`super::stream`] write.

use super::color::{linear_from_srgb, srgb_from_linear};
use super::jpeg;
use exr::prelude::{ReadChannels, ReadLayers};
use glam::Vec3;
use std::error::Error;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// A file could not be read.
#[derive(Debug, thiserror::Error)]
#[error("cannot read {path}: {cause}", path = path.display())]
pub struct LoadError {
    /// Path of the file.
    pub path: PathBuf,
    /// Error of the system or of the decoder.
    pub cause: Box<dyn Error + Send + Sync>,
}

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Encoding of a picture's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureKind {
    /// Display-referred sRGB in 0..1.
    Display,
    /// Scene-referred linear light, unbounded.
    SceneLinear,
}

/// A picture from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Encoding of the values.
    pub kind: PictureKind,
    /// Values, row-major from the top.
    pub values: Vec<Vec3>,
}

/// Maximum number of pixels of a picture: 8192 squared. A header can claim more than there is
/// memory for.
const MAX_PIXELS: u64 = 1 << 26;

#[derive(Clone, Copy)]
enum Format {
    Png,
    Jpeg,
    Exr,
}

/// Reads the notes of a picture, as names and texts, without reading its pixels.
///
/// # Errors
/// [`LoadError`] with the path and the cause.
pub fn read_notes(path: &Path) -> Result<Vec<(String, String)>, LoadError> {
    guarded(path, || match open(path)? {
        (file, Format::Png) => png_notes(file),
        (file, Format::Jpeg) => jpeg::read_notes(file),
        (file, Format::Exr) => exr_notes(file),
    })
}

impl Picture {
    /// Reads a PNG, a JPEG or an OpenEXR file. Its first bytes decide which.
    ///
    /// # Errors
    /// [`LoadError`] with the path and the cause.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        guarded(path, || match open(path)? {
            (file, Format::Png) => read_png(file),
            (file, Format::Jpeg) => read_jpeg(file),
            (_, Format::Exr) => read_exr(path),
        })
    }

    /// Returns the values as sRGB in 0..1. A linear picture is exposed by a number of stops and
    /// clipped at 1; a display-referred one has its exposure already.
    pub fn display(&self, exposure_ev: f32) -> Vec<Vec3> {
        match self.kind {
            PictureKind::Display => self.values.clone(),
            PictureKind::SceneLinear => exposed(&self.values, exposure_ev),
        }
    }

    /// Returns the values as linear light.
    pub fn linear(&self) -> Vec<Vec3> {
        let decode = |v: &Vec3| Vec3::from(v.to_array().map(linear_from_srgb));
        match self.kind {
            PictureKind::Display => self.values.iter().map(decode).collect(),
            PictureKind::SceneLinear => self.values.clone(),
        }
    }
}

/// Returns linear radiance as sRGB in 0..1, clipped at 1: the tone map `linear` at exposure 0. NaN
/// becomes black.
pub fn display_of(radiance: &[Vec3]) -> Vec<Vec3> {
    exposed(radiance, 0.0)
}

/// [`display_of`] at an exposure in stops.
pub fn exposed(radiance: &[Vec3], exposure_ev: f32) -> Vec<Vec3> {
    let gain = exposure_ev.exp2();
    let encode = |c: f32| srgb_from_linear(if c.is_nan() { 0.0 } else { c.clamp(0.0, 1.0) });
    radiance.iter().map(|v| Vec3::from((*v * gain).to_array().map(encode))).collect()
}

/// Reads a regular file of at most `max_bytes` bytes. Devices and pipes are refused: they may never
/// end.
///
/// # Errors
/// [`LoadError`] with the path and the cause.
pub fn read_bounded(path: &Path, max_bytes: u64) -> Result<Vec<u8>, LoadError> {
    let read = || -> Outcome<Vec<u8>> {
        let mut bytes = Vec::new();
        open_regular(path)?.take(max_bytes + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > max_bytes {
            return Err(format!("it is longer than {max_bytes} bytes").into());
        }
        Ok(bytes)
    };
    read().map_err(|cause| LoadError { path: path.to_owned(), cause })
}

/// Runs a decoder, which may panic on a damaged file.
fn guarded<T>(path: &Path, decode: impl FnOnce() -> Outcome<T>) -> Result<T, LoadError> {
    let outcome = catch_unwind(AssertUnwindSafe(decode));
    let outcome = outcome.unwrap_or_else(|_| Err("the decoder failed on it".into()));
    outcome.map_err(|cause| LoadError { path: path.to_owned(), cause })
}

fn open(path: &Path) -> Outcome<(BufReader<File>, Format)> {
    const PNG: [u8; 4] = [0x89, b'P', b'N', b'G'];
    const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
    let mut file = BufReader::new(open_regular(path)?);
    let mut magic = Vec::new();
    file.by_ref().take(4).read_to_end(&mut magic)?;
    file.seek(SeekFrom::Start(0))?;
    match magic {
        magic if magic == PNG => Ok((file, Format::Png)),
        magic if magic == EXR => Ok((file, Format::Exr)),
        magic if magic.starts_with(&jpeg::MAGIC) => Ok((file, Format::Jpeg)),
        _ => Err("it is neither PNG, JPEG nor OpenEXR".into()),
    }
}

fn open_regular(path: &Path) -> Outcome<File> {
    // Check before opening: opening a pipe waits for its writer.
    if !path.metadata()?.is_file() {
        return Err("it is not a regular file".into());
    }
    Ok(File::open(path)?)
}

fn check_size(width: u64, height: u64) -> Outcome<()> {
    match width.checked_mul(height) {
        Some(1..=MAX_PIXELS) => Ok(()),
        _ => Err(format!("it has {width}x{height} pixels, at most {MAX_PIXELS} are supported").into()),
    }
}

fn png_notes(file: BufReader<File>) -> Outcome<Vec<(String, String)>> {
    let reader = png::Decoder::new(file).read_info()?;
    let text =
        |note: &png::text_metadata::ITXtChunk| note.get_text().ok().map(|text| (note.keyword.clone(), text));
    Ok(reader.info().utf8_text.iter().filter_map(text).collect())
}

fn exr_notes(file: BufReader<File>) -> Outcome<Vec<(String, String)>> {
    let meta = exr::meta::MetaData::read_from_buffered(file, false)?;
    let attributes = meta.headers.iter().flat_map(|h| h.own_attributes.other.iter());
    let text = |(name, value): (&exr::prelude::Text, &exr::prelude::AttributeValue)| match value {
        exr::prelude::AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
        _ => None,
    };
    Ok(attributes.filter_map(text).collect())
}

fn read_png(file: BufReader<File>) -> Outcome<Picture> {
    let mut decoder = png::Decoder::new(file);
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info()?;
    let size = [reader.info().width, reader.info().height];
    check_size(size[0].into(), size[1].into())?;
    let mut buffer = vec![0; reader.output_buffer_size().ok_or("it is too large for this machine")?];
    let frame = reader.next_frame(&mut buffer)?;
    let color = |c: &[u8]| match c {
        [r, g, b, ..] => Vec3::new((*r).into(), (*g).into(), (*b).into()) / 255.0,
        [v, ..] => Vec3::splat(f32::from(*v) / 255.0),
        [] => Vec3::ZERO,
    };
    let values = buffer[..frame.buffer_size()].chunks_exact(frame.color_type.samples()).map(color).collect();
    Ok(Picture { size, kind: PictureKind::Display, values })
}

fn read_jpeg(file: BufReader<File>) -> Outcome<Picture> {
    let (size, pixels) = jpeg::read(file, &check_size)?;
    let color = |rgb: [u8; 3]| Vec3::from(rgb.map(f32::from)) / 255.0;
    Ok(Picture { size, kind: PictureKind::Display, values: pixels.into_iter().map(color).collect() })
}

fn read_exr(path: &Path) -> Outcome<Picture> {
    let meta = exr::meta::MetaData::read_from_file(path, false)?;
    for header in &meta.headers {
        check_size(header.layer_size.width() as u64, header.layer_size.height() as u64)?;
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![Vec3::ZERO; size.area()]),
            |(width, values), at, (r, g, b): (f32, f32, f32)| {
                values[at.y() * *width + at.x()] = Vec3::new(r, g, b)
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(path)?;
    let size = [image.layer_data.size.width() as u32, image.layer_data.size.height() as u32];
    Ok(Picture { size, kind: PictureKind::SceneLinear, values: image.layer_data.channel_data.pixels.1 })
}
