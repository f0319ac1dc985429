//! Opening the files that a model names: only regular files, only inside the scene's folder, never
//! more than a limit.

use super::progress::{Phase, Steps};
use crate::scene::SceneError;
use std::path::{Component, Path, PathBuf};
use std::{fs::File, io::Read};

/// The folder that a scene's files must lie in.
#[derive(Clone, Debug)]
pub(super) struct Jail {
    /// Canonical path.
    pub(super) folder: PathBuf,
    /// The user allows files outside the folder.
    pub(super) allow_outside: bool,
}

/// Why a path is not opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    Missing,
    Outside,
    NotAFile,
}

/// Why a file is not used, and what the user can do.
#[derive(Debug, thiserror::Error)]
#[error("{cause}; {remedy}")]
pub(super) struct FileError {
    pub(super) cause: String,
    pub(super) remedy: String,
}

impl Jail {
    /// Returns the canonical path of a regular file that may be opened. Opens nothing itself.
    pub(super) fn admit(&self, candidate: &Path) -> Result<PathBuf, Refusal> {
        if !self.may_look_at(candidate) {
            return Err(Refusal::Outside);
        }
        let real = candidate.canonicalize().map_err(|_| Refusal::Missing)?;
        if !self.allow_outside && !real.starts_with(&self.folder) {
            return Err(Refusal::Outside);
        }
        let is_file = real.metadata().is_ok_and(|m| m.is_file());
        if is_file { Ok(real) } else { Err(Refusal::NotAFile) }
    }

    /// False for a path whose text alone leaves the folder. The system is not asked whether it
    /// exists: on some systems that question about `\\server\share` already sends the user's
    /// credentials there.
    pub(super) fn may_look_at(&self, candidate: &Path) -> bool {
        self.allow_outside || without_dots(candidate).is_some_and(|p| p.starts_with(&self.folder))
    }

    /// Returns the path for messages: relative to the scene's folder where it lies inside.
    pub(super) fn shown(&self, path: &Path) -> String {
        path.strip_prefix(&self.folder).unwrap_or(path).display().to_string()
    }
}

/// Resolves `.` and `..` in the text of a path; `None` where it climbs above the root.
fn without_dots(path: &Path) -> Option<PathBuf> {
    let mut clean = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if clean.pop() => {}
            Component::ParentDir => return None,
            other => clean.push(other),
        }
    }
    Some(clean)
}

/// Returns the error for a file that is not used.
pub(super) fn unreadable(file: &Path, cause: impl Into<String>, remedy: impl Into<String>) -> SceneError {
    SceneError::Read { file: file.to_owned(), cause: cause.into(), remedy: remedy.into() }
}

/// Returns the error for a model that does not fit in memory. `what` says which part.
pub(super) fn no_memory(name: &str, what: String) -> SceneError {
    unreadable(
        name.as_ref(),
        format!("there is no memory for {what}"),
        "close other programs or split the model",
    )
}

/// Reads a regular file of at most `limit` bytes.
pub(super) fn read_limited(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    read_in_steps(path, limit, &Steps { progress: &|_, _| true }).map_err(|error| match error {
        SceneError::Read { cause, remedy, .. } => FileError { cause, remedy },
        other => FileError { cause: other.to_string(), remedy: "try again".to_owned() },
    })
}

/// Reads a regular file of at most `limit` bytes, in steps between which the user can cancel.
pub(super) fn read_in_steps(path: &Path, limit: u64, steps: &Steps) -> Result<Vec<u8>, SceneError> {
    /// Bytes between two looks at the progress: few enough that a slow disk does not delay a
    /// cancellation.
    const STEP_BYTES: u64 = 4 << 20;
    let failed = |cause: String, remedy: &str| unreadable(path, cause, remedy);
    let refused = |e: std::io::Error| failed(e.to_string(), "check the path and its permissions");
    let metadata = path.metadata().map_err(refused)?;
    if !metadata.is_file() {
        return Err(failed("this is not a regular file".to_owned(), "name a file"));
    }
    let size = metadata.len();
    if size > limit {
        let cause = format!("it has {size} bytes, at most {limit} are read");
        return Err(failed(cause, "split the model"));
    }
    let mut file = File::open(path).map_err(refused)?;
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(size as usize + 1)
        .map_err(|_| failed(format!("there is no memory for its {size} bytes"), "close other programs"))?;
    loop {
        let read = (&mut file).take(STEP_BYTES).read_to_end(&mut bytes).map_err(refused)?;
        steps.at(Phase::Reading, bytes.len() as f32 / size.max(1) as f32)?;
        if read == 0 {
            return Ok(bytes);
        }
        if bytes.len() as u64 > limit {
            return Err(failed("it grew while it was read".to_owned(), "try again"));
        }
    }
}
