//! Merges the folders of shards into the folder of the whole run.

use super::folder::{RunFolder, read_manifest};
use super::manifest::{Manifest, Session};
use super::{error::ExperimentError, journal::Journal, shard::Shard};
use crate::raster::{load::read_bounded, save::write_atomically};
use std::path::{Path, PathBuf};

/// Merges run folders into a new one. Cells that are missing in all folders stay missing; running
/// the experiment without `--shard` into the new folder completes it. A cell of two folders is
/// taken from the first.
///
/// # Errors
/// [`ExperimentError`] if a folder is not a run folder, if two folders belong to different runs, or
/// if `into` holds something else.
pub fn merge(folders: &[PathBuf], into: &Path, session: Session) -> Result<RunFolder, ExperimentError> {
    let manifests = folders.iter().map(|f| read_manifest(f)).collect::<Result<Vec<Manifest>, _>>()?;
    let first = manifests.first().ok_or(ExperimentError::NothingToMerge)?;
    for (manifest, path) in manifests.iter().zip(folders) {
        if let Some(difference) = first.identity.difference(&manifest.identity) {
            let cause = format!("it belongs to another run than {} ({difference})", folders[0].display());
            return Err(ExperimentError::folder(path, cause));
        }
    }
    let sessions: Vec<Session> = manifests.iter().flat_map(|m| m.sessions.iter().cloned()).collect();
    let mut merged = RunFolder::open(into, first.identity.clone(), Shard::ALL, first.cells, session)?;
    merged.add_sessions(sessions);
    for folder in folders {
        for done in Journal::read(folder)? {
            if !merged.has(&done.key) {
                merged.add(done)?;
            }
        }
        copy_images(&folder.join("images"), &into.join("images"))?;
    }
    Ok(merged)
}

/// Maximum size of a picture in bytes. A float picture of 8192 x 8192 pixels is smaller.
const MAX_PICTURE_BYTES: u64 = 2 << 30;

fn copy_images(from: &Path, to: &Path) -> Result<(), ExperimentError> {
    let entries = match std::fs::read_dir(from) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(ExperimentError::at(from, error)),
    };
    for entry in entries {
        let entry = entry.map_err(|e| ExperimentError::at(from, e))?;
        let to = to.join(entry.file_name());
        if entry.path().is_file() && !to.exists() {
            let bytes = read_bounded(&entry.path(), MAX_PICTURE_BYTES)
                .map_err(|e| ExperimentError::folder(&e.path, e.cause.to_string()))?;
            write_atomically(&to, &bytes)?;
        }
    }
    Ok(())
}
