//! Picture files written from the top in portions of rows: the memory used does not grow with the
//! picture.
//!
//! A thread encodes the rows while the next ones are rendered. The file has a temporary name until
//! it is finished; dropping an unfinished one removes it.

use super::atomic_file::{SaveError, Target};
use super::save::{ChannelValues, Notes};
use exr::block::{UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::meta::BlockDescription;
use exr::meta::attribute::{AttributeValue, ChannelDescription, SampleType, Text};
use exr::meta::header::Header;
use exr::prelude::{Compression, LineOrder};
use std::cell::Cell;
use std::collections::VecDeque;
use std::error::Error;
use std::io::{BufWriter, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use tempfile::NamedTempFile;

/// Name of the note that says whether all rows were rendered.
pub const COMPLETE: &str = "Complete";

/// Maximum number of portions that wait for the encoder.
const QUEUE: usize = 2;

/// Consecutive rows of a picture, row-major.
#[derive(Clone, Debug, PartialEq)]
pub enum Rows {
    /// 8-bit sRGB.
    Srgb(Vec<[u8; 3]>),
    /// 8-bit sRGB with coverage as straight alpha.
    SrgbAlpha(Vec<[u8; 4]>),
    /// Values of each channel, in the order of [`Contents::Exr`].
    Channels(Vec<ChannelValues>),
}

/// Format of a picture file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Contents {
    /// PNG of [`Rows::Srgb`].
    Png,
    /// PNG of [`Rows::SrgbAlpha`].
    PngAlpha,
    /// JPEG of [`Rows::Srgb`], with a quality from 1 to 100.
    Jpeg(u8),
    /// OpenEXR of [`Rows::Channels`]: the name of each channel, and whether its values are
    /// identifiers.
    Exr(Vec<(String, bool)>),
}

enum Portion {
    Rows(Rows),
    /// No more rows follow. True if all were rendered.
    End(bool),
}

type EncodeError = Box<dyn Error + Send + Sync>;

/// A picture file that is being written.
#[derive(Debug)]
pub struct PictureFile {
    target: Target,
    rows: Option<SyncSender<Portion>>,
    encoder: Option<JoinHandle<Result<NamedTempFile, EncodeError>>>,
}

impl PictureFile {
    /// Starts a file, with notes as text chunks or attributes.
    ///
    /// # Errors
    /// [`SaveError`] if its folder cannot be written to.
    pub fn begin(
        target: Target,
        contents: Contents,
        size: [u32; 2],
        notes: Notes<'_>,
    ) -> Result<Self, SaveError> {
        let file = target.begin()?;
        let notes: Vec<(String, String)> =
            notes.iter().map(|(name, text)| ((*name).to_owned(), text.clone())).collect();
        let (rows, portions) = sync_channel(QUEUE);
        let encode = move || match contents {
            Contents::Png => png(file, size, png::ColorType::Rgb, &notes, &portions),
            Contents::PngAlpha => png(file, size, png::ColorType::Rgba, &notes, &portions),
            Contents::Jpeg(quality) => jpeg(file, size, quality, &notes, &portions),
            Contents::Exr(channels) => exr(file, size, channels, &notes, &portions),
        };
        let encoder = std::thread::Builder::new().name("encode".to_owned()).spawn(encode);
        let encoder = encoder.map_err(|cause| SaveError::Write { path: target.path(), cause })?;
        Ok(Self { target, rows: Some(rows), encoder: Some(encoder) })
    }

    /// Adds the next rows. Waits if the encoder is behind.
    ///
    /// # Errors
    /// [`SaveError`] if the rows written so far could not be encoded.
    pub fn write(&mut self, rows: Rows) -> Result<(), SaveError> {
        let sent = self.rows.as_ref().is_some_and(|to| to.send(Portion::Rows(rows)).is_ok());
        if sent { Ok(()) } else { Err(self.failure()) }
    }

    /// Finishes the file and returns its path. Missing rows are black.
    ///
    /// # Errors
    /// [`SaveError`]; then the file was not written, and an existing one is unchanged.
    pub fn finish(mut self, is_complete: bool) -> Result<PathBuf, SaveError> {
        if let Some(rows) = self.rows.take() {
            // If the encoder has failed, `join` returns its error.
            let _ = rows.send(Portion::End(is_complete));
        }
        let file = self.join()?;
        self.target.finish(file)
    }

    fn join(&mut self) -> Result<NamedTempFile, SaveError> {
        let failed = |cause| SaveError::Encode { path: self.target.path(), cause };
        let Some(encoder) = self.encoder.take() else { return Err(failed("it has failed already".into())) };
        encoder.join().unwrap_or_else(|_| Err("the encoder panicked".into())).map_err(failed)
    }

    fn failure(&mut self) -> SaveError {
        self.rows = None;
        match self.join() {
            Err(error) => error,
            Ok(_) => SaveError::Encode { path: self.target.path(), cause: TOO_MANY_ROWS.into() },
        }
    }
}

impl Drop for PictureFile {
    fn drop(&mut self) {
        self.rows = None;
        // Wait, so that the temporary file is removed when this returns.
        if let Some(encoder) = self.encoder.take() {
            let _ = encoder.join();
        }
    }
}

const TOO_MANY_ROWS: &str = "it was given too many rows";

fn next_portion(portions: &Receiver<Portion>) -> Result<Portion, EncodeError> {
    portions.recv().map_err(|_| "it was abandoned".into())
}

fn png(
    mut file: NamedTempFile,
    [width, height]: [u32; 2],
    color: png::ColorType,
    notes: &[(String, String)],
    portions: &Receiver<Portion>,
) -> Result<NamedTempFile, EncodeError> {
    let mut encoder = png::Encoder::new(BufWriter::new(file.as_file_mut()), width, height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    for (keyword, note) in notes {
        encoder.add_itxt_chunk(keyword.clone(), note.clone())?;
    }
    let mut writer = encoder.write_header()?;
    let mut left = u64::from(width) * u64::from(height) * color.samples() as u64;
    let mut pixels = writer.stream_writer()?;
    let is_complete = loop {
        match next_portion(portions)? {
            Portion::Rows(rows) => {
                let bytes: &[u8] = match &rows {
                    Rows::Srgb(rows) => bytemuck::cast_slice(rows),
                    Rows::SrgbAlpha(rows) => bytemuck::cast_slice(rows),
                    Rows::Channels(_) => return Err("a PNG file cannot hold channels of numbers".into()),
                };
                left = left.checked_sub(bytes.len() as u64).ok_or(TOO_MANY_ROWS)?;
                pixels.write_all(bytes)?;
            }
            Portion::End(is_complete) => break is_complete && left == 0,
        }
    };
    std::io::copy(&mut std::io::repeat(0).take(left), &mut pixels)?;
    pixels.finish()?;
    let note = png::text_metadata::ITXtChunk::new(COMPLETE, yes_or_no(is_complete).trim());
    writer.write_text_chunk(&note)?;
    writer.finish()?;
    Ok(file)
}

fn jpeg(
    mut file: NamedTempFile,
    size: [u32; 2],
    quality: u8,
    notes: &[(String, String)],
    portions: &Receiver<Portion>,
) -> Result<NamedTempFile, EncodeError> {
    let is_whole = Cell::new(true);
    let mut next = || match next_portion(portions)? {
        Portion::Rows(Rows::Srgb(rows)) => Ok(Some(rows)),
        Portion::Rows(_) => Err("a JPEG file holds colours without transparency".into()),
        Portion::End(is_complete) => {
            is_whole.set(is_complete);
            Ok(None)
        }
    };
    let last = |has_all_rows: bool| (COMPLETE, yes_or_no(has_all_rows && is_whole.get()));
    super::jpeg::write(file.as_file_mut(), size, quality, notes, &mut next, &last)?;
    Ok(file)
}

/// Text of the note [`COMPLETE`]. Both texts have the same length, so that one can overwrite the
/// other.
fn yes_or_no(is_complete: bool) -> &'static str {
    if is_complete { "yes" } else { "no " }
}

fn exr(
    mut file: NamedTempFile,
    size: [u32; 2],
    channels: Vec<(String, bool)>,
    notes: &[(String, String)],
    portions: &Receiver<Portion>,
) -> Result<NamedTempFile, EncodeError> {
    // OpenEXR sorts channels by name.
    let mut order: Vec<usize> = (0..channels.len()).collect();
    order.sort_by(|a, b| channels[*a].0.cmp(&channels[*b].0));
    let header = exr_header(size, order.iter().map(|i| &channels[*i]), notes);
    let mut queue = RowQueue { portions, order, rows: VecDeque::new(), width: size[0] as usize, end: None };
    let mut cause = None;
    let written = exr::block::write(
        BufWriter::new(file.as_file_mut()),
        [header].into_iter().collect(),
        true,
        |meta, chunks| {
            for (index, block) in enumerate_ordered_header_block_indices(&meta.headers) {
                let data = queue.take(block.pixel_size.1).map_err(|error| {
                    cause = Some(error);
                    exr::error::Error::Aborted
                })?;
                let chunk = UncompressedBlock { index: block, data }.compress_to_chunk(&meta.headers)?;
                exr::block::writer::ChunksWriter::write_chunk(chunks, index, chunk)?;
            }
            Ok(())
        },
    );
    written.map_err(|error| cause.unwrap_or_else(|| error.into()))?;
    let is_complete = match queue.end {
        Some(end) => end,
        None => match next_portion(portions)? {
            Portion::End(is_complete) => is_complete,
            Portion::Rows(_) => return Err(TOO_MANY_ROWS.into()),
        },
    };
    if !is_complete {
        mark_incomplete(file.as_file_mut())?;
    }
    Ok(file)
}

fn exr_header<'a>(
    size: [u32; 2],
    channels: impl Iterator<Item = &'a (String, bool)>,
    notes: &[(String, String)],
) -> Header {
    let described = channels.map(|(name, is_index)| {
        let kind = if *is_index { SampleType::U32 } else { SampleType::F32 };
        ChannelDescription::new(Text::new_or_panic(name), kind, false)
    });
    let header =
        Header::new(Text::from("picture"), (size[0] as usize, size[1] as usize), described.collect());
    let mut header =
        header.with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing);
    let complete = (COMPLETE.to_owned(), yes_or_no(true).to_owned());
    for (name, note) in notes.iter().chain([&complete]) {
        if let (Some(name), Some(note)) = (Text::new_or_none(name), Text::new_or_none(note)) {
            header.own_attributes.other.insert(name, AttributeValue::Text(note));
        }
    }
    header
}

/// Overwrites the note [`COMPLETE`] of an OpenEXR file. The header is written first, but only the
/// end of the picture shows whether it is complete.
fn mark_incomplete(file: &mut std::fs::File) -> std::io::Result<()> {
    let mark = format!("{COMPLETE}\0string\0");
    let mut head = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    (&mut *file).take(1 << 16).read_to_end(&mut head)?;
    let found = head.windows(mark.len()).position(|bytes| bytes == mark.as_bytes());
    let at = found.ok_or_else(|| std::io::Error::other("the header has no note of completeness"))?;
    // The length of the text follows its name and type.
    file.seek(SeekFrom::Start((at + mark.len() + size_of::<u32>()) as u64))?;
    file.write_all(yes_or_no(false).as_bytes())
}

/// Rows received but not encoded yet. Turns portions of any height into blocks of the file.
struct RowQueue<'a> {
    portions: &'a Receiver<Portion>,
    /// Index of the given channel at each position of the file.
    order: Vec<usize>,
    /// Bytes of each row, one channel after the other.
    rows: VecDeque<Vec<u8>>,
    width: usize,
    end: Option<bool>,
}

impl RowQueue<'_> {
    /// Returns the bytes of the next `count` rows. Rows after the last one are zero.
    fn take(&mut self, count: usize) -> Result<Vec<u8>, EncodeError> {
        while self.rows.len() < count && self.end.is_none() {
            match next_portion(self.portions)? {
                Portion::Rows(Rows::Channels(channels)) => self.add(&channels)?,
                Portion::Rows(_) => return Err("an OpenEXR file needs channels of numbers".into()),
                Portion::End(is_complete) => self.end = Some(is_complete),
            }
        }
        if self.rows.len() < count {
            self.end = Some(false);
        }
        let missing = || vec![0; self.width * self.order.len() * size_of::<f32>()];
        let rows: Vec<Vec<u8>> = (0..count).map(|_| self.rows.pop_front().unwrap_or_else(missing)).collect();
        Ok(rows.concat())
    }

    fn add(&mut self, channels: &[ChannelValues]) -> Result<(), EncodeError> {
        let width = self.width.max(1);
        let count = channels.first().map_or(0, |c| c.len() / width);
        if channels.len() != self.order.len() || channels.iter().any(|c| c.len() != count * width) {
            return Err("a channel does not have one value per pixel".into());
        }
        let bytes = channels.iter().map(ChannelValues::bytes).collect::<Vec<&[u8]>>();
        let stride = width * size_of::<f32>();
        for row in 0..count {
            let part = |i: &usize| &bytes[*i][row * stride..(row + 1) * stride];
            self.rows.push_back(self.order.iter().map(part).collect::<Vec<_>>().concat());
        }
        Ok(())
    }
}
