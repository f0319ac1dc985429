//! Opening files that a model names: only regular files, only inside the scene's folder, never more than a limit.

use crate::import::{Phase, Steps};
use crate::scene::SceneError;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

/// The folder that a scene's files must lie in.
#[derive(Clone, Debug)]
pub(crate) struct Jail {
    /// Canonical.
    pub(crate) folder: PathBuf,
    /// The user trusts this model with other folders too.
    pub(crate) allow_outside: bool,
}

/// Why a candidate is not opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Refusal {
    Missing,
    Outside,
    NotAFile,
}

impl Jail {
    /// The canonical path of a regular file that may be opened. Opens nothing itself.
    pub(crate) fn admit(&self, candidate: &Path) -> Result<PathBuf, Refusal> {
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

    /// False for a path that leaves the folder by its very letters. It is not even asked whether it exists: on some
    /// systems asking for `\\server\share` already sends the user's credentials there.
    pub(crate) fn may_look_at(&self, candidate: &Path) -> bool {
        self.allow_outside || without_dots(candidate).is_some_and(|p| p.starts_with(&self.folder))
    }

    /// The path as people should see it: relative to the scene's folder where it lies inside.
    pub(crate) fn shown(&self, path: &Path) -> String {
        path.strip_prefix(&self.folder).unwrap_or(path).display().to_string()
    }
}

/// The path with `.` and `..` worked out by letters alone; `None` where it climbs above the root.
fn without_dots(path: &Path) -> Option<PathBuf> {
    let mut clean = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                if !clean.pop() {
                    return None;
                }
            }
            other => clean.push(other),
        }
    }
    Some(clean)
}

/// A regular file's bytes, at most `limit`. The error is a cause and a remedy.
pub(crate) fn read_limited(path: &Path, limit: u64) -> Result<Vec<u8>, (String, String)> {
    let steps = Steps { progress: &|_, _| true };
    match read_in_steps(path, limit, &steps) {
        Err(SceneError::Read { cause, remedy, .. }) => Err((cause, remedy)),
        Err(other) => Err((other.to_string(), "try again".to_owned())),
        Ok(bytes) => Ok(bytes),
    }
}

/// A regular file's bytes, at most `limit`, read in steps between which the user may cancel.
pub(crate) fn read_in_steps(path: &Path, limit: u64, steps: &Steps) -> Result<Vec<u8>, SceneError> {
    /// Small enough that a slow disk does not delay a cancel.
    const STEP_BYTES: u64 = 4 << 20;
    let failed = |cause: String, remedy: &str| SceneError::Read {
        file: path.to_owned(),
        cause,
        remedy: remedy.to_owned(),
    };
    let unreadable = |e: std::io::Error| failed(e.to_string(), "check the path and its permissions");
    let metadata = path.metadata().map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(failed("this is not a regular file".to_owned(), "name a file"));
    }
    let size = metadata.len();
    if size > limit {
        let cause = format!("it has {size} bytes, at most {limit} are read");
        return Err(failed(cause, "split the model"));
    }
    let mut file = File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(size as usize + 1)
        .map_err(|_| failed(format!("there is no memory for its {size} bytes"), "close other programs"))?;
    loop {
        let read = (&mut file).take(STEP_BYTES).read_to_end(&mut bytes).map_err(unreadable)?;
        steps.at(Phase::Reading, bytes.len() as f32 / size.max(1) as f32)?;
        if read == 0 {
            return Ok(bytes);
        }
        if bytes.len() as u64 > limit {
            return Err(failed("it grew while it was read".to_owned(), "try again"));
        }
    }
}
