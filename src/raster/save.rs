//! Picture files, written so that a reader never meets half of one.
//!
//! A picture is encoded in memory, written to a temporary file in the folder it belongs to, flushed to the disk and
//! only then given its name. A full disk, a crash or a missing permission leaves the old file as it was.

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds,
    Layer, LayerAttributes, Text, WritableImage,
};
use std::fs::File;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

/// Why there is no file.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The system refused.
    #[error("cannot write {path}: {cause}", path = path.display())]
    Write {
        /// The file meant.
        path: PathBuf,
        /// What the system said.
        cause: std::io::Error,
    },
    /// The picture cannot be expressed in the format.
    #[error("cannot encode {path}: {cause}", path = path.display())]
    Encode {
        /// The file meant.
        path: PathBuf,
        /// What the encoder said.
        cause: String,
    },
}

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

/// Writes a file in one piece: afterwards `path` holds all of `bytes`, or what it held before.
///
/// A name that is a device or a pipe is written to as it is; there is nothing to keep whole.
///
/// # Errors
/// [`SaveError::Write`] with the path and the system's reason.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), SaveError> {
    let write = || match std::fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(std::io::ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => write_through(path, bytes),
        // A link keeps pointing where it pointed: the file behind it is replaced.
        Ok(_) => replace(&path.canonicalize()?, bytes),
        Err(_) => replace(path, bytes),
    };
    write().map_err(|cause| SaveError::Write { path: path.to_owned(), cause })
}

fn write_through(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = std::fs::OpenOptions::new().write(true).open(path)?;
    file.write_all(bytes)?;
    file.flush()
}

/// A name is tried with so many numbers before giving up.
const MAX_NAMES: u32 = 100_000;

/// Writes a new file `stem-0001.extension`, with the first number that is not taken, in one piece. Nothing is ever
/// overwritten. Returns the path.
///
/// # Errors
/// [`SaveError::Write`] with the path and the system's reason.
pub fn write_new_atomically(
    folder: &Path,
    stem: &str,
    extension: &str,
    bytes: &[u8],
) -> Result<PathBuf, SaveError> {
    let file = temporary(folder, bytes);
    let file =
        file.map_err(|cause| SaveError::Write { path: named_with(folder, stem, extension, 1), cause })?;
    persist_new(file, folder, stem, extension)
}

fn named_with(folder: &Path, stem: &str, extension: &str, number: u32) -> PathBuf {
    folder.join(format!("{stem}-{number:04}.{extension}"))
}

/// Gives a file the first numbered name that is not taken.
pub(super) fn persist_new(
    mut file: tempfile::NamedTempFile,
    folder: &Path,
    stem: &str,
    extension: &str,
) -> Result<PathBuf, SaveError> {
    let failed = |path: PathBuf, cause| SaveError::Write { path, cause };
    for number in 1..MAX_NAMES {
        let path = named_with(folder, stem, extension, number);
        match file.persist_noclobber(&path) {
            Ok(_) => {
                sync_folder(folder);
                return Ok(path);
            }
            Err(error) if error.error.kind() == std::io::ErrorKind::AlreadyExists => file = error.file,
            Err(error) => return Err(failed(path, error.error)),
        }
    }
    Err(failed(named_with(folder, stem, extension, MAX_NAMES), std::io::ErrorKind::AlreadyExists.into()))
}

fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    temporary(folder, bytes)?.persist(path).map_err(|e| e.error)?;
    sync_folder(folder);
    Ok(())
}

/// All of `bytes`, on the disk, in a file that has no lasting name yet.
fn temporary(folder: &Path, bytes: &[u8]) -> std::io::Result<tempfile::NamedTempFile> {
    let mut file = temporary_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    Ok(file)
}

/// An empty file that has no lasting name yet.
pub(super) fn temporary_in(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".afterimage-");
    // Temporary files are private by default; a picture gets what the user's umask grants.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// The name itself must reach the disk too. Some systems cannot sync a folder; the file is whole all the same.
pub(super) fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
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
