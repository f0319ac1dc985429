//! What is done, a line a cell: appended, flushed and synced, so that a killed run loses at most the cell it was at.

use super::error::ExperimentError;
use super::record::RunRecord;
use crate::raster::load::read_bounded;
use crate::raster::save::write_atomically;
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;

/// A finished cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Done {
    /// Its place in the plan.
    pub place: usize,
    /// [`super::Identity::key`].
    pub key: String,
    /// What it left.
    pub records: Vec<RunRecord>,
    /// How long it took.
    pub cell_secs: f64,
}

/// The file.
#[derive(Debug)]
pub struct Journal {
    file: File,
    done: Vec<Done>,
}

impl Journal {
    /// The name of the file in a run folder.
    pub const NAME: &str = "journal.jsonl";

    /// Opens the journal of a folder, made where there is none. A line that was not written to its end is dropped, from
    /// the file too.
    ///
    /// # Errors
    /// [`ExperimentError`] where the file cannot be read or written.
    pub fn open(folder: &Path) -> Result<Self, ExperimentError> {
        let path = folder.join(Self::NAME);
        let (done, is_whole) = read(&path)?;
        if !is_whole {
            write_atomically(&path, lines(&done).as_bytes())?;
        }
        let file = OpenOptions::new().create(true).append(true).open(&path);
        Ok(Self { file: file.map_err(|e| ExperimentError::at(&path, e))?, done })
    }

    /// The finished cells of a folder, without a claim to write there.
    ///
    /// # Errors
    /// [`ExperimentError`] where the file cannot be read.
    pub fn read(folder: &Path) -> Result<Vec<Done>, ExperimentError> {
        Ok(read(&folder.join(Self::NAME))?.0)
    }

    /// All finished cells.
    pub fn done(&self) -> &[Done] {
        &self.done
    }

    /// Adds a finished cell; afterwards it is on the disk.
    ///
    /// # Errors
    /// [`ExperimentError`] where it cannot be written.
    pub fn add(&mut self, done: Done) -> Result<(), ExperimentError> {
        let line = lines(std::slice::from_ref(&done));
        let length = self.file.metadata().map(|m| m.len());
        let write = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        if let Err(error) = write {
            // What was begun is taken back, or the next line would be joined to it.
            let _ = length.and_then(|length| self.file.set_len(length));
            return Err(ExperimentError::at(Path::new(Self::NAME), error));
        }
        self.done.push(done);
        Ok(())
    }
}

fn lines(done: &[Done]) -> String {
    done.iter().filter_map(|d| serde_json::to_string(d).ok()).map(|line| line + "\n").collect()
}

/// A million cells have less.
const MAX_BYTES: u64 = 4 << 30;

/// The cells of a journal, and whether every byte of it was of use.
fn read(path: &Path) -> Result<(Vec<Done>, bool), ExperimentError> {
    if std::fs::symlink_metadata(path).is_err_and(|e| e.kind() == std::io::ErrorKind::NotFound) {
        return Ok((Vec::new(), true));
    }
    let bytes = read_bounded(path, MAX_BYTES)
        .map_err(|e| ExperimentError::Folder { path: path.to_owned(), cause: e.cause })?;
    // A line without its end was being written when the run was killed, even if it happens to parse.
    let ended = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
    let lines: Vec<&[u8]> = bytes[..ended].split(|b| *b == b'\n').filter(|l| !l.is_empty()).collect();
    let done: Vec<Done> = lines.iter().filter_map(|l| serde_json::from_slice(l).ok()).collect();
    let is_whole = ended == bytes.len() && done.len() == lines.len();
    Ok((done, is_whole))
}
