//! The journal of finished cells, one line per cell: appended, flushed and synced, so that a killed
//! run loses at most the cell in progress.

use super::{error::ExperimentError, record::RunRecord};
use crate::raster::{load::read_bounded, save::write_atomically};
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::{io::Write, path::Path};

/// A finished cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Done {
    /// Position in the list of cells.
    pub place: usize,
    /// Key of the cell; see [`super::Identity::key`].
    pub key: String,
    /// Records that the cell returned, with the cell's own settings.
    pub records: Vec<RunRecord>,
    /// Wall time of the cell in seconds.
    pub cell_secs: f64,
}

/// The open journal of a run folder.
#[derive(Debug)]
pub struct Journal {
    file: File,
    done: Vec<Done>,
}

impl Journal {
    /// Name of the file in a run folder.
    pub const NAME: &str = "journal.jsonl";

    /// Opens the journal of a folder, or creates it. A line that was not written completely is
    /// removed, also from the file.
    ///
    /// # Errors
    /// [`ExperimentError`] if the file cannot be read or written.
    pub fn open(folder: &Path) -> Result<Self, ExperimentError> {
        let path = folder.join(Self::NAME);
        let (done, is_whole) = read(&path)?;
        if !is_whole {
            write_atomically(&path, lines(&done).as_bytes())?;
        }
        let file = OpenOptions::new().create(true).append(true).open(&path);
        Ok(Self { file: file.map_err(|e| ExperimentError::at(&path, e))?, done })
    }

    /// Reads the finished cells of a folder without locking it.
    ///
    /// # Errors
    /// [`ExperimentError`] if the file cannot be read.
    pub fn read(folder: &Path) -> Result<Vec<Done>, ExperimentError> {
        Ok(read(&folder.join(Self::NAME))?.0)
    }

    /// All finished cells.
    pub fn done(&self) -> &[Done] {
        &self.done
    }

    /// Appends a finished cell and waits until it is on the disk.
    ///
    /// # Errors
    /// [`ExperimentError`] if it cannot be written.
    pub fn add(&mut self, done: Done) -> Result<(), ExperimentError> {
        let line = lines(std::slice::from_ref(&done));
        let length = self.file.metadata().map(|m| m.len());
        let write = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        if let Err(error) = write {
            // Remove the incomplete line, or the next one would be joined to it.
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

/// Maximum size of a journal in bytes. A journal of a million cells is smaller.
const MAX_BYTES: u64 = 4 << 30;

/// Reads the cells of a journal, and whether every byte of it was valid.
fn read(path: &Path) -> Result<(Vec<Done>, bool), ExperimentError> {
    if std::fs::symlink_metadata(path).is_err_and(|e| e.kind() == std::io::ErrorKind::NotFound) {
        return Ok((Vec::new(), true));
    }
    let bytes =
        read_bounded(path, MAX_BYTES).map_err(|e| ExperimentError::folder(path, e.cause.to_string()))?;
    // A line without its end was being written when the run was killed, even if it happens to
    // parse.
    let ended = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
    let lines: Vec<&[u8]> = bytes[..ended].split(|b| *b == b'\n').filter(|l| !l.is_empty()).collect();
    let done: Vec<Done> = lines.iter().filter_map(|l| serde_json::from_slice(l).ok()).collect();
    let is_whole = ended == bytes.len() && done.len() == lines.len();
    Ok((done, is_whole))
}
