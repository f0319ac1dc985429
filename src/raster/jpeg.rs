//! JPEG files, written from the top in portions of rows, with notes as comments.
//!
//! Source: ITU-T T.81 (1992), annex B: segments begin with a marker of two bytes and their length.

use image::codecs::jpeg::{JpegDecoder, JpegEncoder};
use image::{DynamicImage, GenericImageView, ImageDecoder, Rgb};
use std::cell::{Cell, RefCell};
use std::error::Error;
use std::io::{BufRead, BufWriter, Seek, SeekFrom, Write};
use std::rc::Rc;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Returns the next rows of 8-bit sRGB; `None` after the last ones.
pub(super) type NextRows<'a> = &'a mut dyn FnMut() -> Outcome<Option<Vec<[u8; 3]>>>;

/// Default of the quality, 1 to 100: no difference is seen at usual sizes.
pub const DEFAULT_QUALITY: u8 = 90;

/// First bytes of a JPEG file.
pub(super) const MAGIC: [u8; 3] = [0xFF, 0xD8, 0xFF];

/// Marker of a segment that holds a comment.
const COMMENT: u8 = 0xFE;

/// Marker of the segment after which the pixels follow.
const SCAN: u8 = 0xDA;

/// Maximum number of bytes of a note in one segment: its length has two bytes. Longer ones go on in
/// the next segment of their name.
const MAX_NOTE_PART: usize = 60_000;

/// Maximum number of bytes of all comments that are read.
const MAX_COMMENTS: usize = 4 << 20;

/// Writes a JPEG file with a quality from 1 to 100. The last of `notes` is `last`, one of two texts
/// of the same length: which one, is known after the last row. Missing rows are black.
///
/// # Errors
/// The error of the file, of `next`, or of the encoder.
pub(super) fn write<F: Write + Seek>(
    file: &mut F,
    size: [u32; 2],
    quality: u8,
    notes: &[(String, String)],
    next: NextRows<'_>,
    last: &dyn Fn(bool) -> (&'static str, &'static str),
) -> Outcome<()> {
    let comments = comments(notes, last(true));
    let has_failed = Rc::new(Cell::new(false));
    let rows = RowsView::new(size, next, has_failed.clone());
    let mut output = WithComments {
        to: BufWriter::new(&mut *file),
        head: Vec::new(),
        comments,
        written: None,
        has_failed,
    };
    let encoded = JpegEncoder::new_with_quality(&mut output, quality.clamp(1, 100)).encode_image(&rows);
    let is_complete = rows.finish()?;
    encoded?;
    output.to.flush()?;
    let end = output.written.ok_or("the encoder wrote no header")?;
    drop(output);
    if !is_complete {
        let text = last(false).1;
        file.seek(SeekFrom::Start(end - text.len() as u64))?;
        file.write_all(text.as_bytes())?;
    }
    Ok(())
}

/// Returns the segments of all notes, as `name: text`.
fn comments(notes: &[(String, String)], last: (&str, &str)) -> Vec<u8> {
    let mut bytes = Vec::new();
    let notes = notes.iter().map(|(name, text)| (name.as_str(), text.as_str()));
    for (name, text) in notes.chain([last]) {
        for part in parts(text) {
            let comment = format!("{name}: {part}");
            let length = u16::try_from(comment.len() + 2).unwrap_or(u16::MAX);
            bytes.extend([0xFF, COMMENT]);
            bytes.extend(length.to_be_bytes());
            bytes.extend(comment.bytes().take(usize::from(length) - 2));
        }
    }
    bytes
}

/// Splits a text between characters.
fn parts(text: &str) -> Vec<&str> {
    let (mut parts, mut rest) = (Vec::new(), text);
    while rest.len() > MAX_NOTE_PART {
        let mut at = MAX_NOTE_PART;
        while !rest.is_char_boundary(at) {
            at -= 1;
        }
        let (part, after) = rest.split_at(at);
        parts.push(part);
        rest = after;
    }
    parts.push(rest);
    parts
}

/// Puts comments after the first segment, where readers look for them, and ends the encoder where
/// the rows have failed.
struct WithComments<W> {
    to: W,
    head: Vec<u8>,
    comments: Vec<u8>,
    /// Number of bytes up to the end of the comments, once these are written.
    written: Option<u64>,
    has_failed: Rc<Cell<bool>>,
}

impl<W: Write> Write for WithComments<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if self.has_failed.get() {
            return Err(std::io::ErrorKind::Other.into());
        }
        if self.written.is_some() {
            return self.to.write(bytes);
        }
        self.head.extend(bytes);
        // The start of the picture, the marker of a segment, and its length.
        if let [_, _, _, _, high, low, ..] = self.head[..] {
            let end = 4 + usize::from(u16::from_be_bytes([high, low]));
            if self.head.len() >= end {
                let after = self.head.split_off(end);
                self.to.write_all(&self.head)?;
                self.to.write_all(&self.comments)?;
                self.written = Some((end + self.comments.len()) as u64);
                self.to.write_all(&after)?;
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.to.flush()
    }
}

/// Rows that arrive while the encoder asks for them, in blocks of eight.
struct RowsView<'a> {
    size: [u32; 2],
    rows: RefCell<Rows<'a>>,
    has_failed: Rc<Cell<bool>>,
}

struct Rows<'a> {
    next: NextRows<'a>,
    /// The first row that is kept, and the pixels from there on.
    first: u32,
    kept: Vec<[u8; 3]>,
    /// Number of pixels that have not arrived.
    missing: u64,
    has_ended: bool,
    error: Option<Box<dyn Error + Send + Sync>>,
}

impl<'a> RowsView<'a> {
    fn new(size: [u32; 2], next: NextRows<'a>, has_failed: Rc<Cell<bool>>) -> Self {
        let missing = size.map(u64::from).iter().product();
        let rows = Rows { next, first: 0, kept: Vec::new(), missing, has_ended: false, error: None };
        Self { size, rows: RefCell::new(rows), has_failed }
    }

    /// True where every row has arrived.
    fn finish(&self) -> Outcome<bool> {
        let mut rows = self.rows.borrow_mut();
        while !rows.has_ended {
            rows.take_next();
        }
        match rows.error.take() {
            Some(error) => Err(error),
            None => Ok(rows.missing == 0),
        }
    }
}

impl Rows<'_> {
    fn take_next(&mut self) {
        match (self.next)() {
            Ok(Some(pixels)) => {
                match self.missing.checked_sub(pixels.len() as u64) {
                    Some(missing) => self.missing = missing,
                    None => (self.has_ended, self.error) = (true, Some("it was given too many rows".into())),
                }
                self.kept.extend(pixels);
            }
            Ok(None) => self.has_ended = true,
            Err(error) => (self.has_ended, self.error) = (true, Some(error)),
        }
    }

    fn pixel(&mut self, [x, y]: [u32; 2], width: usize) -> [u8; 3] {
        if x == 0 && y.is_multiple_of(8) && y > self.first {
            let gone = (y - self.first) as usize * width;
            self.kept.drain(..gone.min(self.kept.len()));
            self.first = y;
        }
        let at = (y - self.first) as usize * width + x as usize;
        while at >= self.kept.len() && !self.has_ended {
            self.take_next();
        }
        self.kept.get(at).copied().unwrap_or_default()
    }
}

impl GenericImageView for RowsView<'_> {
    type Pixel = Rgb<u8>;

    fn dimensions(&self) -> (u32, u32) {
        self.size.into()
    }

    fn get_pixel(&self, x: u32, y: u32) -> Rgb<u8> {
        let mut rows = self.rows.borrow_mut();
        let pixel = rows.pixel([x, y], self.size[0] as usize);
        if rows.error.is_some() {
            self.has_failed.set(true);
        }
        Rgb(pixel)
    }
}

/// Reads the notes of a file, without its pixels.
///
/// # Errors
/// Where a segment is cut, or there are more comments than any picture of this program has.
pub(super) fn read_notes<R: BufRead + Seek>(mut file: R) -> Outcome<Vec<(String, String)>> {
    let mut notes: Vec<(String, String)> = Vec::new();
    let (mut start, mut left) = ([0; 2], MAX_COMMENTS);
    file.read_exact(&mut start)?;
    loop {
        let mut head = [0; 4];
        file.read_exact(&mut head)?;
        let [0xFF, marker, high, low] = head else { return Err("it is damaged".into()) };
        if marker == SCAN {
            return Ok(notes);
        }
        let length = u16::from_be_bytes([high, low]).checked_sub(2).ok_or("it is damaged")?;
        if marker != COMMENT {
            file.seek_relative(length.into())?;
            continue;
        }
        left = left.checked_sub(length.into()).ok_or("its comments are too long")?;
        let mut bytes = vec![0; length.into()];
        file.read_exact(&mut bytes)?;
        let text = String::from_utf8_lossy(&bytes);
        if let Some((name, text)) = text.split_once(": ") {
            match notes.last_mut().filter(|(before, _)| before == name) {
                Some((_, before)) => before.push_str(text),
                None => notes.push((name.to_owned(), text.to_owned())),
            }
        }
    }
}

/// Reads the size of a file, which `check` may refuse, and its pixels as 8-bit sRGB.
///
/// # Errors
/// The error of `check`, or of the decoder.
pub(super) fn read<R: BufRead + Seek>(
    file: R,
    check: &dyn Fn(u64, u64) -> Outcome<()>,
) -> Outcome<([u32; 2], Vec<[u8; 3]>)> {
    let decoder = JpegDecoder::new(file)?;
    let (width, height) = decoder.dimensions();
    check(width.into(), height.into())?;
    let pixels = DynamicImage::from_decoder(decoder)?.into_rgb8();
    Ok(([width, height], pixels.as_chunks::<3>().0.to_vec()))
}
