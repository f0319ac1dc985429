//! A segment: a file of records. What of it is no whole record is found and left out.

use super::hash::checksum;
use super::record::{HEADER_BYTES, MAGIC, RecordHeader, VERSION};
use super::summary::RecordSummary;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Name at the beginning of a segment.
const SEGMENT_MAGIC: [u8; 8] = *b"AFTIMSEG";

/// Bytes before the first record.
pub(super) const SEGMENT_HEADER_BYTES: u64 = 16;

/// Largest number of records that the index of a segment has.
const MAX_RECORDS: usize = 1 << 16;

/// A record in a segment.
#[derive(Clone, Debug)]
pub(super) struct StoredRecord {
    pub(super) header: RecordHeader,
    pub(super) summary: RecordSummary,
    /// Where the record begins in the file, bytes.
    pub(super) offset: u64,
}

/// The records of a segment, and what of it is no record.
#[derive(Debug, Default)]
pub(super) struct Segment {
    pub(super) path: PathBuf,
    /// Size of the file in bytes.
    pub(super) bytes: u64,
    pub(super) records: Vec<StoredRecord>,
    /// Damage, one line each.
    pub(super) problems: Vec<String>,
    /// True if another version of the program has written it.
    pub(super) is_foreign: bool,
}

/// The first bytes of a segment: a name, the version of the format, and a checksum of both.
pub(super) fn segment_start(version: u16) -> [u8; SEGMENT_HEADER_BYTES as usize] {
    let mut start = [0; SEGMENT_HEADER_BYTES as usize];
    start[..8].copy_from_slice(&SEGMENT_MAGIC);
    start[8..10].copy_from_slice(&version.to_le_bytes());
    let sum = checksum(&start[..10]) as u32;
    start[12..].copy_from_slice(&sum.to_le_bytes());
    start
}

/// Lists the segments of a folder, by name. A folder that does not exist has none.
pub(super) fn segment_paths(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let paths = entries.filter_map(Result::ok).map(|entry| entry.path());
    let mut paths: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|e| e == "seg")).collect();
    paths.sort();
    Ok(paths)
}

impl Segment {
    /// Reads the headers and summaries of a segment. Bytes that are no record are skipped up to the
    /// next one.
    pub(super) fn scan(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        let bytes = file.metadata()?.len();
        let mut segment = Self { path: path.to_owned(), bytes, ..Self::default() };
        let mut file = BufReader::with_capacity(1 << 16, file);
        let mut start = [0; SEGMENT_HEADER_BYTES as usize];
        if bytes == 0 {
            return Ok(segment); // another process has just created it
        }
        if bytes < SEGMENT_HEADER_BYTES {
            segment.problems.push(format!("has only {bytes} bytes, an interrupted write; nothing is lost"));
            return Ok(segment);
        }
        file.read_exact(&mut start)?;
        if segment_start(u16::from_le_bytes([start[8], start[9]])) != start {
            segment.problems.push("is no segment of a store, or its first bytes are damaged".to_owned());
        } else if start != segment_start(VERSION) {
            let version = u16::from_le_bytes([start[8], start[9]]);
            let line = format!("has format {version}; this program reads {VERSION}; it is left as it is");
            segment.problems.push(line);
            segment.is_foreign = true;
            return Ok(segment);
        }
        segment.scan_records(&mut file)?;
        Ok(segment)
    }

    fn scan_records(&mut self, file: &mut BufReader<File>) -> io::Result<()> {
        let mut at = SEGMENT_HEADER_BYTES;
        while at < self.bytes && self.records.len() < MAX_RECORDS {
            match read_header(file, at, self.bytes)? {
                Some(header) => {
                    self.add(header, at, file)?;
                    at += header.record_bytes();
                }
                None => {
                    let next = next_header(file, at + 1, self.bytes)?.unwrap_or(self.bytes);
                    let count = next - at;
                    self.problems.push(match next == self.bytes {
                        true => format!("ends in {count} bytes of an interrupted write; they are ignored"),
                        false => format!("has {count} damaged bytes at {at}; they are skipped"),
                    });
                    at = next;
                }
            }
        }
        Ok(())
    }

    /// Adds a record whose header is whole, if its summary is as well.
    fn add(&mut self, header: RecordHeader, offset: u64, file: &mut BufReader<File>) -> io::Result<()> {
        if header.version != VERSION || header.kind != super::record::REFERENCE {
            self.problems.push(format!("has a record of another version at {offset}; it is skipped"));
            return Ok(());
        }
        let mut summary = vec![0; header.summary_bytes as usize];
        file.read_exact(&mut summary)?;
        let is_whole = checksum(&summary) == header.summary_checksum;
        match RecordSummary::read(&summary).filter(|_| is_whole) {
            Some(summary) => self.records.push(StoredRecord { header, summary, offset }),
            None => self.problems.push(format!("has a damaged record at {offset}; it is skipped")),
        }
        Ok(())
    }
}

/// Reads the header at an offset. `None` where there is none, or where the record that it begins
/// goes beyond the end of the file.
fn read_header(file: &mut BufReader<File>, at: u64, end: u64) -> io::Result<Option<RecordHeader>> {
    let mut bytes = [0; HEADER_BYTES];
    if end - at < HEADER_BYTES as u64 {
        return Ok(None);
    }
    seek_to(file, at)?;
    file.read_exact(&mut bytes)?;
    Ok(RecordHeader::read(&bytes).filter(|header| header.record_bytes() <= end - at))
}

/// Seeks without dropping what is read ahead.
fn seek_to(file: &mut BufReader<File>, to: u64) -> io::Result<()> {
    let at = file.stream_position()?;
    file.seek_relative(to as i64 - at as i64)
}

/// Finds the next whole header from an offset on.
fn next_header(file: &mut BufReader<File>, from: u64, end: u64) -> io::Result<Option<u64>> {
    const CHUNK: usize = 1 << 16;
    let mut at = from;
    while at < end {
        seek_to(file, at)?;
        let mut chunk = Vec::new();
        file.take(CHUNK as u64).read_to_end(&mut chunk)?;
        let starts = chunk.windows(MAGIC.len()).enumerate().filter(|(_, bytes)| **bytes == MAGIC);
        for start in starts.map(|(index, _)| at + index as u64).collect::<Vec<_>>() {
            if read_header(file, start, end)?.is_some() {
                return Ok(Some(start));
            }
        }
        if chunk.len() < CHUNK {
            return Ok(None);
        }
        // A header may begin in the last bytes of a chunk.
        at += (CHUNK - MAGIC.len() + 1) as u64;
    }
    Ok(None)
}

impl StoredRecord {
    /// Reads the payload and inflates it. `None` where it is damaged.
    pub(super) fn payload(&self, segment: &Path) -> io::Result<Option<Vec<u8>>> {
        let mut file = File::open(segment)?;
        let start = self.offset + HEADER_BYTES as u64 + u64::from(self.header.summary_bytes);
        if file.metadata()?.len() < start + self.header.payload_bytes {
            return Ok(None);
        }
        file.seek(SeekFrom::Start(start))?;
        let mut packed = vec![0; self.header.payload_bytes as usize];
        file.read_exact(&mut packed)?;
        Ok(super::record::inflate(&self.header, &packed))
    }

    /// Reads all bytes of the record, as they are.
    pub(super) fn bytes(&self, segment: &Path) -> io::Result<Vec<u8>> {
        let mut file = File::open(segment)?;
        file.seek(SeekFrom::Start(self.offset))?;
        let mut bytes = Vec::new();
        file.take(self.header.record_bytes()).read_to_end(&mut bytes)?;
        Ok(bytes)
    }
}
