//! Files written so that a reader never meets half of one.
//!
//! The bytes go to a temporary file in the folder that the file belongs to, are flushed to the disk, and only then get the
//! file's name. A full disk, a crash or a missing permission leaves the old file as it was.

use std::fs::File;
use std::io::Write;
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
