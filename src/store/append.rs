//! Writing segments.
//!
//! A segment is written by one process from its first byte to its last. Every process creates
//! segments of its own, under the next free number, and holds an advisory lock on the one that it
//! writes. So no writer waits for another, and no lock is held for the sake of readers: what they
//! find is whole records, or is left out.

use super::record::VERSION;
use super::segment::{segment_paths, segment_start};
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Size of a segment from which on the next record begins another one, bytes: what is removed at
/// once when the store is full.
pub(super) const SEGMENT_BYTES: u64 = 64 << 20;

/// Appends records to segments of a folder. Files are created with the first record.
pub(super) struct Appender {
    folder: PathBuf,
    /// Size of a segment from which on the next record begins another one, bytes.
    segment_bytes: u64,
    segment: Option<SegmentWriter>,
}

impl Appender {
    pub(super) fn new(folder: &Path, segment_bytes: u64) -> Self {
        Self { folder: folder.to_owned(), segment_bytes, segment: None }
    }

    /// The segment that is being written.
    pub(super) fn path(&self) -> Option<&Path> {
        self.segment.as_ref().map(|segment| &*segment.path)
    }

    /// Appends a record. After an error nothing more can be appended to the same segment.
    pub(super) fn append(&mut self, record: &[u8]) -> io::Result<()> {
        let open = self.segment.take().filter(|segment| segment.bytes < self.segment_bytes);
        let mut segment = match open {
            Some(segment) => segment,
            None => SegmentWriter::create(&self.folder)?,
        };
        segment.append(record)?;
        self.segment = Some(segment);
        Ok(())
    }

    /// Makes sure that the system has written everything to the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.segment.as_ref().map_or(Ok(()), |segment| segment.file.sync())
    }
}

/// A file that grows, and can be cut to a length again.
pub(super) trait GrowingFile: Write + Send {
    /// Cuts the file.
    fn cut(&mut self, length: u64) -> io::Result<()>;

    /// Waits until the disk has all bytes.
    fn sync(&self) -> io::Result<()>;
}

impl GrowingFile for File {
    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::End(0)).map(drop)
    }

    fn sync(&self) -> io::Result<()> {
        self.sync_data()
    }
}

/// A segment that this process writes.
pub(super) struct SegmentWriter {
    path: PathBuf,
    file: Box<dyn GrowingFile>,
    /// Bytes of whole records so far.
    bytes: u64,
}

impl SegmentWriter {
    /// Creates the segment with the next free number, and locks it.
    pub(super) fn create(folder: &Path) -> io::Result<Self> {
        const TRIES: u32 = 1000;
        std::fs::create_dir_all(folder)?;
        let last = segment_paths(folder)?.iter().filter_map(|path| number_of(path)).max().unwrap_or(0);
        for number in (1..=TRIES).map(|step| last.saturating_add(step)) {
            let path = folder.join(format!("{number:08}.seg"));
            match File::options().create_new(true).write(true).open(&path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
                Ok(file) => {
                    // Where the system has no locks, only clearing away knows less.
                    let _ = file.try_lock();
                    return Self::begin(path, Box::new(file));
                }
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    /// Begins a segment in an empty file.
    pub(super) fn begin(path: PathBuf, file: Box<dyn GrowingFile>) -> io::Result<Self> {
        let mut writer = Self { path, file, bytes: 0 };
        writer.append(&segment_start(VERSION))?;
        Ok(writer)
    }

    /// Appends a record. After an error the segment is as it was, unless the system refuses even
    /// that; then it ends in bytes that readers skip.
    pub(super) fn append(&mut self, record: &[u8]) -> io::Result<()> {
        match self.file.write_all(record).and_then(|()| self.file.flush()) {
            Ok(()) => {
                self.bytes += record.len() as u64;
                Ok(())
            }
            Err(error) => {
                let _ = self.file.cut(self.bytes);
                Err(error)
            }
        }
    }
}

fn number_of(path: &Path) -> Option<u32> {
    path.file_stem()?.to_str()?.parse().ok()
}
