//! Files that are written completely or not at all.
//!
//! The bytes go to a temporary file in the target folder, are flushed to the disk, and only then
//! get the file's name. A full disk, a crash or a missing permission leaves the old file as it was.

use std::error::Error;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file was not written.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The system refused to write it.
    #[error("cannot write {path}: {cause}", path = path.display())]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        cause: std::io::Error,
    },
    /// The picture cannot be encoded in the format.
    #[error("cannot encode {path}: {cause}", path = path.display())]
    Encode {
        /// Path of the file.
        path: PathBuf,
        /// Error of the encoder.
        cause: Box<dyn Error + Send + Sync>,
    },
}

/// Name of a file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// A given path. An existing file is replaced; a device or a pipe is written to.
    File(PathBuf),
    /// The first of `stem-0001.extension`, `stem-0002.extension`, ... that does not exist yet.
    Next {
        /// Folder of the file.
        folder: PathBuf,
        /// Part of the name before the number.
        stem: String,
        /// Extension of the name, without a dot.
        extension: &'static str,
    },
}

/// Writes a file atomically: afterwards `path` holds all of `bytes`, or what it held before.
///
/// A device or a pipe is written to directly. A symbolic link is followed.
///
/// # Errors
/// [`SaveError::Write`] with the path and the system's reason.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), SaveError> {
    Target::File(path.to_owned()).write(bytes).map(drop)
}

impl Target {
    /// Path of the file, or the first path that is tried.
    pub fn path(&self) -> PathBuf {
        match self {
            Self::File(path) => path.clone(),
            Self::Next { folder, stem, extension } => numbered(folder, stem, extension, 1),
        }
    }

    /// Checks that the folder can be written to, before a long computation.
    ///
    /// # Errors
    /// [`SaveError::Write`] with the system's reason.
    pub fn probe(&self) -> Result<(), SaveError> {
        temporary_in(&self.temporary_folder()).map(drop).map_err(|cause| self.failed(cause))
    }

    /// Writes all bytes to the file. Returns its path.
    ///
    /// # Errors
    /// [`SaveError::Write`] with the path and the system's reason.
    pub fn write(&self, bytes: &[u8]) -> Result<PathBuf, SaveError> {
        if let Self::File(path) = self
            && self.is_device()
        {
            write_to_device(path, bytes).map_err(|cause| self.failed(cause))?;
            return Ok(path.clone());
        }
        let mut file = self.begin()?;
        file.write_all(bytes).map_err(|cause| self.failed(cause))?;
        self.finish(file)
    }

    /// Creates the temporary file. Dropping it removes it.
    pub(super) fn begin(&self) -> Result<NamedTempFile, SaveError> {
        if matches!(self, Self::File(path) if path.is_dir()) {
            return Err(self.failed(std::io::ErrorKind::IsADirectory.into()));
        }
        temporary_in(&self.temporary_folder()).map_err(|cause| self.failed(cause))
    }

    /// Flushes the temporary file to the disk and gives it its name. Returns its path. For a device
    /// or a pipe, the finished file is copied to it: encoders may seek, which these cannot.
    pub(super) fn finish(&self, file: NamedTempFile) -> Result<PathBuf, SaveError> {
        let failed = |cause| self.failed(cause);
        file.as_file().sync_all().map_err(failed)?;
        match self {
            Self::File(path) if self.is_device() => copy_to_device(&file, path).map_err(failed)?,
            Self::File(path) => {
                file.persist(behind_link(path)).map_err(|e| failed(e.error))?;
                sync_folder(&self.temporary_folder());
            }
            Self::Next { folder, stem, extension } => return persist_numbered(file, folder, stem, extension),
        }
        Ok(self.path())
    }

    fn failed(&self, cause: std::io::Error) -> SaveError {
        SaveError::Write { path: self.path(), cause }
    }

    /// Returns true for an existing device or pipe, which must not be replaced by a file.
    fn is_device(&self) -> bool {
        let Self::File(path) = self else { return false };
        std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
    }

    /// Folder of the temporary file: the folder of the target, so that it can be renamed. A device
    /// or a pipe uses the system's folder of temporary files.
    fn temporary_folder(&self) -> PathBuf {
        match self {
            Self::File(_) if self.is_device() => std::env::temp_dir(),
            Self::File(path) => {
                let path = behind_link(path);
                let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
                parent.map_or_else(|| PathBuf::from("."), Path::to_owned)
            }
            Self::Next { folder, .. } => folder.clone(),
        }
    }
}

/// Follows symbolic links, so that the file behind a link is replaced and the link stays.
fn behind_link(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

fn write_to_device(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut to = std::fs::OpenOptions::new().write(true).open(path)?;
    to.write_all(bytes)?;
    to.flush()
}

fn copy_to_device(file: &NamedTempFile, path: &Path) -> std::io::Result<()> {
    let mut to = std::fs::OpenOptions::new().write(true).open(path)?;
    std::io::copy(&mut file.reopen()?, &mut to)?;
    to.flush()
}

fn numbered(folder: &Path, stem: &str, extension: &str, number: u32) -> PathBuf {
    folder.join(format!("{stem}-{number:04}.{extension}"))
}

/// Gives a file the first numbered name that is free.
fn persist_numbered(
    mut file: NamedTempFile,
    folder: &Path,
    stem: &str,
    extension: &str,
) -> Result<PathBuf, SaveError> {
    const MAX_NUMBER: u32 = 100_000;
    for number in 1..MAX_NUMBER {
        let path = numbered(folder, stem, extension, number);
        match file.persist_noclobber(&path) {
            Ok(_) => {
                sync_folder(folder);
                return Ok(path);
            }
            Err(error) if error.error.kind() == std::io::ErrorKind::AlreadyExists => file = error.file,
            Err(error) => return Err(SaveError::Write { path, cause: error.error }),
        }
    }
    let path = numbered(folder, stem, extension, MAX_NUMBER);
    Err(SaveError::Write { path, cause: std::io::ErrorKind::AlreadyExists.into() })
}

fn temporary_in(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".afterimage-");
    // Temporary files are private by default. A picture gets the permissions that the user's umask
    // grants.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Flushes the name of a file to the disk. Some systems cannot sync a folder; the file is complete
/// all the same.
fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
}
