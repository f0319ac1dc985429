//! The files in which windows keep their sessions in case of a crash.
//!
//! Each window holds a lock on a file of its own, next to its session. The system releases the lock
//! however the program ends, so that a session without a locked file was left behind. The number of
//! the process would not do: in a container every start may have the same one.

use super::{EXTENSION, SessionFile, modified};
use crate::window::rendering::TaskError;
use afterimage::raster::save::write_atomically;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// Beginning of the names of kept sessions; a number follows.
const PREFIX: &str = "recovery-";

/// Largest number in such a name: more windows are not open at once.
const MOST: u32 = 999;

/// The file in which a window keeps its session.
pub(super) struct Recovery {
    file: PathBuf,
    /// Held as long as the window is open.
    _lock: File,
}

impl Recovery {
    /// Takes the first name of a folder that no window has, and under which nothing was left.
    ///
    /// # Errors
    /// A message for the user, if the folder or the lock's file cannot be made.
    pub(super) fn begin(folder: &Path) -> Result<Self, TaskError> {
        let failed = |error| TaskError::Failed(format!("cannot write in {}: {error}", folder.display()));
        std::fs::create_dir_all(folder).map_err(failed)?;
        for number in 1..=MOST {
            let file = folder.join(format!("{PREFIX}{number}.{EXTENSION}"));
            let lock = File::options().write(true).create(true).truncate(false).open(lock_of(&file));
            let lock = lock.map_err(failed)?;
            if !is_held(&lock) && !file.exists() {
                return Ok(Self { file, _lock: lock });
            }
        }
        Err(TaskError::Failed(format!("{} holds {MOST} sessions that were left behind", folder.display())))
    }

    /// The file of the session. It may not exist yet.
    pub(super) fn file(&self) -> &Path {
        &self.file
    }
}

/// Tries to lock a file. True where another window has locked it; on file systems without locks
/// none counts as locked.
fn is_held(lock: &File) -> bool {
    matches!(lock.try_lock(), Err(TryLockError::WouldBlock))
}

fn lock_of(session: &Path) -> PathBuf {
    session.with_extension("lock")
}

/// Writes a session for the case of a crash.
///
/// # Errors
/// A message for the user.
pub(super) fn keep_session(session: &SessionFile, file: &Path) -> Result<(), TaskError> {
    let text = session.text(None).map_err(TaskError::failed)?;
    write_atomically(file, text.as_bytes()).map_err(TaskError::failed)
}

/// True for a session that a window has kept in a folder, which may be none.
pub(super) fn is_recovery(path: &Path, folder: Option<&Path>) -> bool {
    let has_name = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PREFIX));
    has_name && path.parent() == folder
}

/// Returns the newest session of a window that has ended without removing it.
pub(super) fn left_behind(folder: &Path) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.filter_map(|e| e.ok().map(|e| e.path()));
    let is_orphan = |path: &PathBuf| {
        let is_session = path.to_string_lossy().ends_with(&format!(".{EXTENSION}"));
        is_recovery(path, Some(folder)) && is_session && !File::open(lock_of(path)).is_ok_and(|l| is_held(&l))
    };
    entries.filter(is_orphan).max_by_key(|path| modified(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_have_files_of_their_own_and_only_what_a_closed_one_left_is_offered() {
        let folder = tempfile::tempdir().unwrap();
        let first = Recovery::begin(folder.path()).unwrap();
        std::fs::write(first.file(), "one").unwrap();
        let second = Recovery::begin(folder.path()).unwrap();
        assert_ne!(first.file(), second.file());
        assert_eq!(left_behind(folder.path()), None, "both windows are open");
        let left = first.file().to_owned();
        drop(first);
        assert_eq!(left_behind(folder.path()), Some(left.clone()));
        let third = Recovery::begin(folder.path()).unwrap();
        assert!(third.file() != left && third.file() != second.file(), "what was left is not overwritten");
    }
}
