//! Picture files written from the top, some rows at a time: what is held in memory does not grow with the picture.
//!
//! A thread encodes what it is given, so that whoever makes the picture goes on meanwhile. The file has a temporary name
//! until it is finished, in the folder it belongs to; dropping an unfinished one leaves nothing behind.

use super::atomic_file::{SaveError, persist_new, sync_folder, temporary_in};
use super::save::{ChannelValues, Notes};
use exr::block::{UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::meta::BlockDescription;
use exr::meta::attribute::{AttributeValue, ChannelDescription, SampleType, Text};
use exr::meta::header::Header;
use exr::prelude::{Compression, LineOrder};
use std::collections::VecDeque;
use std::io::{BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use tempfile::NamedTempFile;

/// The note that says whether every row was made.
pub const COMPLETE: &str = "Complete";

/// Rows wait for the encoder in so many portions.
const QUEUE: usize = 2;

/// What a finished file is called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// This name; a file that has it is replaced.
    File(PathBuf),
    /// The first of `stem-0001.extension`, `stem-0002.extension`, ... that is not taken.
    Next {
        /// Where.
        folder: PathBuf,
        /// How names begin.
        stem: String,
        /// How they end, without a dot.
        extension: &'static str,
    },
}

impl Target {
    /// The file meant, or the first name that is tried.
    pub fn path(&self) -> PathBuf {
        match self {
            Self::File(path) => path.clone(),
            Self::Next { folder, stem, extension } => folder.join(format!("{stem}-0001.{extension}")),
        }
    }

    /// Whether its folder takes a file at all: asked before hours of work.
    ///
    /// # Errors
    /// [`SaveError::Write`] with the system's reason.
    pub fn probe(&self) -> Result<(), SaveError> {
        let folder = if self.is_device() { std::env::temp_dir() } else { self.folder() };
        temporary_in(&folder).map(drop).map_err(|cause| SaveError::Write { path: self.path(), cause })
    }

    /// A name that is a device or a pipe is written to as it is; there is nothing to keep whole.
    fn is_device(&self) -> bool {
        let Self::File(path) = self else { return false };
        std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
    }

    fn folder(&self) -> PathBuf {
        match self {
            Self::File(path) => {
                // A link keeps pointing where it pointed: the file behind it is replaced.
                let path = path.canonicalize().unwrap_or_else(|_| path.clone());
                let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
                parent.map_or_else(|| PathBuf::from("."), Path::to_owned)
            }
            Self::Next { folder, .. } => folder.clone(),
        }
    }

    /// Gives a file its name.
    fn take(&self, file: NamedTempFile) -> Result<PathBuf, SaveError> {
        let Self::File(path) = self else {
            let Self::Next { folder, stem, extension } = self else { return Ok(self.path()) };
            return persist_new(file, folder, stem, extension);
        };
        let failed = |cause| SaveError::Write { path: path.clone(), cause };
        if self.is_device() {
            let mut from = file.reopen().map_err(failed)?;
            let mut to = std::fs::OpenOptions::new().write(true).open(path).map_err(failed)?;
            std::io::copy(&mut from, &mut to).and_then(|_| to.flush()).map_err(failed)?;
        } else {
            let meant = path.canonicalize().unwrap_or_else(|_| path.clone());
            file.persist(meant).map_err(|e| failed(e.error))?;
            sync_folder(&self.folder());
        }
        Ok(path.clone())
    }
}

/// Some rows of a picture, row-major.
#[derive(Clone, Debug, PartialEq)]
pub enum Rows {
    /// 8-bit sRGB.
    Srgb(Vec<[u8; 3]>),
    /// 8-bit sRGB with coverage, not multiplied by it.
    SrgbAlpha(Vec<[u8; 4]>),
    /// One list of values for each channel, in the order in which they were named.
    Channels(Vec<ChannelValues>),
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Contents {
    /// PNG of [`Rows::Srgb`].
    Png,
    /// PNG of [`Rows::SrgbAlpha`].
    PngAlpha,
    /// OpenEXR of [`Rows::Channels`]: their names, and whether they are indices rather than measures.
    Exr(Vec<(String, bool)>),
}

enum Portion {
    Rows(Rows),
    /// No more rows come; true where all were made.
    End(bool),
}

/// A picture file in the making.
#[derive(Debug)]
pub struct PictureFile {
    target: Target,
    rows: Option<SyncSender<Portion>>,
    encoder: Option<JoinHandle<Result<NamedTempFile, String>>>,
}

impl PictureFile {
    /// Begins a file, with notes as text chunks or attributes.
    ///
    /// # Errors
    /// [`SaveError`] where its folder takes no file.
    pub fn begin(
        target: Target,
        contents: Contents,
        size: [u32; 2],
        notes: Notes<'_>,
    ) -> Result<Self, SaveError> {
        let failed = |cause| SaveError::Write { path: target.path(), cause };
        if matches!(&target, Target::File(path) if path.is_dir()) {
            return Err(failed(std::io::ErrorKind::IsADirectory.into()));
        }
        let folder = if target.is_device() { std::env::temp_dir() } else { target.folder() };
        let file = temporary_in(&folder).map_err(failed)?;
        let notes: Vec<(String, String)> =
            notes.iter().map(|(name, text)| ((*name).to_owned(), text.clone())).collect();
        let (rows, portions) = sync_channel(QUEUE);
        let encode = move || match contents {
            Contents::Png => png(file, size, png::ColorType::Rgb, &notes, &portions),
            Contents::PngAlpha => png(file, size, png::ColorType::Rgba, &notes, &portions),
            Contents::Exr(channels) => exr(file, size, channels, &notes, &portions),
        };
        let encoder = std::thread::Builder::new().name("encode".to_owned()).spawn(encode).map_err(failed)?;
        Ok(Self { target, rows: Some(rows), encoder: Some(encoder) })
    }

    /// Adds the next rows; waits where the encoder is behind.
    ///
    /// # Errors
    /// [`SaveError`] where the file could not be written so far.
    pub fn write(&mut self, rows: Rows) -> Result<(), SaveError> {
        let sent = self.rows.as_ref().is_some_and(|to| to.send(Portion::Rows(rows)).is_ok());
        if sent { Ok(()) } else { Err(self.failure()) }
    }

    /// Ends the file and gives it its name; rows that were not made are black. Returns the name.
    ///
    /// # Errors
    /// [`SaveError`]; then there is no file, or the one that was there before.
    pub fn finish(mut self, is_complete: bool) -> Result<PathBuf, SaveError> {
        if let Some(rows) = self.rows.take() {
            // Where the encoder has failed its own error is the one to tell.
            let _ = rows.send(Portion::End(is_complete));
        }
        let file = self.join()?;
        let failed = |cause| SaveError::Write { path: self.target.path(), cause };
        file.as_file().sync_all().map_err(failed)?;
        self.target.take(file)
    }

    fn join(&mut self) -> Result<NamedTempFile, SaveError> {
        let failed = |cause: String| SaveError::Encode { path: self.target.path(), cause };
        let Some(encoder) = self.encoder.take() else {
            return Err(failed("it has failed already".to_owned()));
        };
        encoder.join().unwrap_or_else(|_| Err("the encoder failed on it".to_owned())).map_err(failed)
    }

    fn failure(&mut self) -> SaveError {
        self.rows = None;
        match self.join() {
            Err(error) => error,
            Ok(_) => SaveError::Encode { path: self.target.path(), cause: "too many rows".to_owned() },
        }
    }
}

impl Drop for PictureFile {
    fn drop(&mut self) {
        self.rows = None;
        // Waits, so that the temporary file is gone when this is.
        if let Some(encoder) = self.encoder.take() {
            let _ = encoder.join();
        }
    }
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// What is said where the maker of the picture has given up.
const GIVEN_UP: &str = "it was given up";

fn png(
    mut file: NamedTempFile,
    [width, height]: [u32; 2],
    color: png::ColorType,
    notes: &[(String, String)],
    portions: &Receiver<Portion>,
) -> Result<NamedTempFile, String> {
    let mut encoder = png::Encoder::new(BufWriter::new(file.as_file_mut()), width, height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    for (keyword, note) in notes {
        encoder.add_itxt_chunk(keyword.clone(), note.clone()).map_err(text)?;
    }
    let mut writer = encoder.write_header().map_err(text)?;
    let mut left = u64::from(width) * u64::from(height) * color.samples() as u64;
    let mut pixels = writer.stream_writer().map_err(text)?;
    let is_complete = loop {
        match portions.recv().map_err(|_| GIVEN_UP)? {
            Portion::Rows(rows) => {
                let bytes: &[u8] = match &rows {
                    Rows::Srgb(rows) => bytemuck::cast_slice(rows),
                    Rows::SrgbAlpha(rows) => bytemuck::cast_slice(rows),
                    Rows::Channels(_) => return Err("a PNG has no channels of numbers".to_owned()),
                };
                left = left.checked_sub(bytes.len() as u64).ok_or("too many rows")?;
                pixels.write_all(bytes).map_err(text)?;
            }
            Portion::End(is_complete) => break is_complete && left == 0,
        }
    };
    std::io::copy(&mut std::io::repeat(0).take(left), &mut pixels).map_err(text)?;
    pixels.finish().map_err(text)?;
    let note = png::text_metadata::ITXtChunk::new(COMPLETE, word(is_complete).trim());
    writer.write_text_chunk(&note).map_err(text)?;
    writer.finish().map_err(text)?;
    Ok(file)
}

/// As long as its opposite, so that one can be written over the other.
fn word(is_complete: bool) -> &'static str {
    if is_complete { "yes" } else { "no " }
}

fn exr(
    mut file: NamedTempFile,
    size: [u32; 2],
    channels: Vec<(String, bool)>,
    notes: &[(String, String)],
    portions: &Receiver<Portion>,
) -> Result<NamedTempFile, String> {
    // The file has its channels by name.
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
    written.map_err(|error| cause.unwrap_or_else(|| text(error)))?;
    let is_complete = match queue.end {
        Some(end) => end,
        None => match portions.recv().map_err(|_| GIVEN_UP)? {
            Portion::End(is_complete) => is_complete,
            Portion::Rows(_) => return Err("too many rows".to_owned()),
        },
    };
    if !is_complete {
        say_incomplete(file.as_file_mut()).map_err(text)?;
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
    let complete = (COMPLETE.to_owned(), word(true).to_owned());
    for (name, note) in notes.iter().chain([&complete]) {
        if let (Some(name), Some(note)) = (Text::new_or_none(name), Text::new_or_none(note)) {
            header.own_attributes.other.insert(name, AttributeValue::Text(note));
        }
    }
    header
}

/// Writes over the note that the header began with: only at the end is it known.
fn say_incomplete(file: &mut std::fs::File) -> std::io::Result<()> {
    let mark = format!("{COMPLETE}\0string\0");
    let mut head = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    (&mut *file).take(1 << 16).read_to_end(&mut head)?;
    let found = head.windows(mark.len()).position(|bytes| bytes == mark.as_bytes());
    let at = found.ok_or_else(|| std::io::Error::other("the header has no note of completeness"))?;
    // Behind the name and the type stands the length of the text.
    file.seek(SeekFrom::Start((at + mark.len() + size_of::<u32>()) as u64))?;
    file.write_all(word(false).as_bytes())
}

/// Rows as they come, and as blocks of the file want them.
struct RowQueue<'a> {
    portions: &'a Receiver<Portion>,
    /// Which of the channels given comes first, second, ... in the file.
    order: Vec<usize>,
    /// Each with its channels one after the other.
    rows: VecDeque<Vec<u8>>,
    width: usize,
    end: Option<bool>,
}

impl RowQueue<'_> {
    /// The next rows; zeros where no more come.
    fn take(&mut self, count: usize) -> Result<Vec<u8>, String> {
        while self.rows.len() < count && self.end.is_none() {
            match self.portions.recv().map_err(|_| GIVEN_UP)? {
                Portion::Rows(Rows::Channels(channels)) => self.add(&channels)?,
                Portion::Rows(_) => return Err("an OpenEXR file takes channels of numbers".to_owned()),
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

    fn add(&mut self, channels: &[ChannelValues]) -> Result<(), String> {
        let width = self.width.max(1);
        let count = channels.first().map_or(0, |c| c.len() / width);
        if channels.len() != self.order.len() || channels.iter().any(|c| c.len() != count * width) {
            return Err("a channel has not one value per pixel".to_owned());
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
