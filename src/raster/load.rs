//! Reading back the pictures that [`super::save`] writes, and others of the same kinds.

use super::color::{linear_from_srgb, srgb_from_linear};
use exr::prelude::{ReadChannels, ReadLayers};
use glam::Vec3;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[error("cannot read {path}: {cause}", path = path.display())]
pub struct LoadError {
    /// The file.
    pub path: PathBuf,
    /// What the system or the decoder said.
    pub cause: String,
}

/// What the numbers of a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureKind {
    /// sRGB, 0..1.
    Display,
    /// Linear, scene-referred, unbounded.
    SceneLinear,
}

/// A picture from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height.
    pub size: [u32; 2],
    /// What the values mean.
    pub kind: PictureKind,
    /// Row-major from the top.
    pub values: Vec<Vec3>,
}

/// What a picture says of itself, by name: the notes of [`super::save`]. No pixel is read.
///
/// # Errors
/// [`LoadError`] with the path and the cause.
pub fn read_notes(path: &Path) -> Result<Vec<(String, String)>, LoadError> {
    let outcome = catch_unwind(AssertUnwindSafe(|| notes(path)));
    let outcome = outcome.unwrap_or_else(|_| Err("the decoder failed on it".to_owned()));
    outcome.map_err(|cause| LoadError { path: path.to_owned(), cause })
}

fn notes(path: &Path) -> Result<Vec<(String, String)>, String> {
    let (file, magic) = open(path)?;
    match magic {
        PNG => {
            let reader = png::Decoder::new(file).read_info().map_err(|e| e.to_string())?;
            let text = |note: &png::text_metadata::ITXtChunk| {
                note.get_text().ok().map(|text| (note.keyword.clone(), text))
            };
            Ok(reader.info().utf8_text.iter().filter_map(text).collect())
        }
        EXR => {
            let meta = exr::meta::MetaData::read_from_buffered(file, false).map_err(|e| e.to_string())?;
            let attributes = meta.headers.iter().flat_map(|h| h.own_attributes.other.iter());
            let text = |(name, value): (&exr::prelude::Text, &exr::prelude::AttributeValue)| match value {
                exr::prelude::AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
                _ => None,
            };
            Ok(attributes.filter_map(text).collect())
        }
        _ => Err("it is neither PNG nor OpenEXR".to_owned()),
    }
}

/// How files of these kinds begin.
const PNG: [u8; 4] = [0x89, b'P', b'N', b'G'];
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

fn open(path: &Path) -> Result<(BufReader<File>, [u8; 4]), String> {
    let mut file = BufReader::new(open_regular(path)?);
    let mut magic = [0; 4];
    file.read_exact(&mut magic).map_err(|_| "it is no picture".to_owned())?;
    file.seek(SeekFrom::Start(0)).map_err(|e| e.to_string())?;
    Ok((file, magic))
}

/// The most pixels read: 8192 squared. A header can claim more than there is memory for.
const MAX_PIXELS: u64 = 1 << 26;

impl Picture {
    /// Reads a PNG or an OpenEXR file, told apart by their first bytes.
    ///
    /// # Errors
    /// [`LoadError`] with the path and the cause.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        // A decoder may panic on a damaged file.
        let outcome = catch_unwind(AssertUnwindSafe(|| read(path)));
        let outcome = outcome.unwrap_or_else(|_| Err("the decoder failed on it".to_owned()));
        outcome.map_err(|cause| LoadError { path: path.to_owned(), cause })
    }

    /// The values as sRGB in 0..1; a linear picture is clipped at 1.
    pub fn display(&self) -> Vec<Vec3> {
        match self.kind {
            PictureKind::Display => self.values.clone(),
            PictureKind::SceneLinear => display_of(&self.values),
        }
    }

    /// The values as linear light.
    pub fn linear(&self) -> Vec<Vec3> {
        let decode = |v: &Vec3| Vec3::from(v.to_array().map(linear_from_srgb));
        match self.kind {
            PictureKind::Display => self.values.iter().map(decode).collect(),
            PictureKind::SceneLinear => self.values.clone(),
        }
    }
}

/// sRGB in 0..1 of linear radiance, clipped at 1: the tone map `linear` at exposure 0. What is not a number is black.
pub fn display_of(radiance: &[Vec3]) -> Vec<Vec3> {
    exposed(radiance, 0.0)
}

/// The same at another exposure in stops.
pub fn exposed(radiance: &[Vec3], exposure_ev: f32) -> Vec<Vec3> {
    let gain = exposure_ev.exp2();
    let encode = |c: f32| srgb_from_linear(if c.is_nan() { 0.0 } else { c.clamp(0.0, 1.0) });
    radiance.iter().map(|v| Vec3::from((*v * gain).to_array().map(encode))).collect()
}

/// The bytes of a regular file of at most `most` bytes: never those of a device or a pipe, which may never end.
///
/// # Errors
/// [`LoadError`] with the path and the cause.
pub fn read_bounded(path: &Path, most: u64) -> Result<Vec<u8>, LoadError> {
    let failed = |cause: String| LoadError { path: path.to_owned(), cause };
    let mut bytes = Vec::new();
    let file = open_regular(path).map_err(failed)?;
    file.take(most + 1).read_to_end(&mut bytes).map_err(|e| failed(e.to_string()))?;
    if bytes.len() as u64 > most {
        return Err(failed(format!("it is longer than {most} bytes")));
    }
    Ok(bytes)
}

fn open_regular(path: &Path) -> Result<File, String> {
    // Asked before opening: opening a pipe waits for its writer.
    let metadata = path.metadata().map_err(|e| e.to_string())?;
    if !metadata.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    File::open(path).map_err(|e| e.to_string())
}

fn read(path: &Path) -> Result<Picture, String> {
    let (file, magic) = open(path)?;
    match magic {
        PNG => read_png(file),
        EXR => read_exr(path),
        _ => Err("it is neither PNG nor OpenEXR".to_owned()),
    }
}

fn check_size(width: u64, height: u64) -> Result<usize, String> {
    match width.checked_mul(height) {
        Some(count) if count > 0 && count <= MAX_PIXELS => Ok(count as usize),
        _ => Err(format!("{width}x{height} pixels, at most {MAX_PIXELS} are supported")),
    }
}

fn read_png(file: BufReader<File>) -> Result<Picture, String> {
    let mut decoder = png::Decoder::new(file);
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let size = [reader.info().width, reader.info().height];
    check_size(size[0].into(), size[1].into())?;
    let bytes = reader.output_buffer_size().ok_or("too large for this machine")?;
    let mut buffer = vec![0; bytes];
    let frame = reader.next_frame(&mut buffer).map_err(|e| e.to_string())?;
    let color = |c: &[u8]| match c {
        [r, g, b, ..] => Vec3::new((*r).into(), (*g).into(), (*b).into()) / 255.0,
        [v, ..] => Vec3::splat(f32::from(*v) / 255.0),
        [] => Vec3::ZERO,
    };
    let values = buffer[..frame.buffer_size()].chunks_exact(frame.color_type.samples()).map(color).collect();
    Ok(Picture { size, kind: PictureKind::Display, values })
}

fn read_exr(path: &Path) -> Result<Picture, String> {
    let meta = exr::meta::MetaData::read_from_file(path, false).map_err(|e| e.to_string())?;
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
        .from_file(path)
        .map_err(|e| e.to_string())?;
    let size = [image.layer_data.size.width() as u32, image.layer_data.size.height() as u32];
    Ok(Picture { size, kind: PictureKind::SceneLinear, values: image.layer_data.channel_data.pixels.1 })
}
