//! Watching the files of a model.

use crate::window::rendering::{Task, TaskError, Wake, locked, spawn_task};
use afterimage::scene::SourceFile;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

/// Interval at which the files of a model are checked.
const INTERVAL: Duration = Duration::from_secs(1);

/// The files that the program itself has written: they are no reason to load a model again.
#[derive(Clone, Default)]
pub(super) struct OwnWrites(Arc<Mutex<Vec<SourceFile>>>);

impl OwnWrites {
    /// Writes a file; `write` returns its path. Meanwhile no watch looks at files.
    pub(super) fn write<E>(&self, write: impl FnOnce() -> Result<PathBuf, E>) -> Result<PathBuf, E> {
        let mut written = locked(&self.0);
        let path = write()?;
        written.retain(|file| file.path != path);
        written.push(SourceFile::now(&path));
        Ok(path)
    }

    /// Returns the files of `known` as they are now. Those that the program has written are entered
    /// in `known`.
    fn look(&self, known: &mut [SourceFile]) -> Vec<SourceFile> {
        let written = locked(&self.0);
        let now = look_again(known);
        for (file, now) in known.iter_mut().zip(&now) {
            if written.contains(now) {
                file.clone_from(now);
            }
        }
        now
    }
}

/// Returns the files as they are now.
pub(super) fn look_again(files: &[SourceFile]) -> Vec<SourceFile> {
    files.iter().map(|file| SourceFile::now(&file.path)).collect()
}

/// Starts a task that ends with the model's path when one of its files is no longer as it is in
/// `known`, and then has stayed the same for an interval: programs do not write a file in one step.
pub(super) fn watch(model: PathBuf, mut known: Vec<SourceFile>, own: OwnWrites, wake: Wake) -> Task<PathBuf> {
    spawn_task("watch", wake, move |task| {
        let mut is_changing = false;
        while !task.is_cancelled() {
            std::thread::sleep(INTERVAL);
            let now = own.look(&mut known);
            let has_changed = std::mem::replace(&mut known, now) != known;
            if is_changing && !has_changed {
                return Ok(model);
            }
            is_changing = has_changed;
        }
        Err(TaskError::Cancelled)
    })
}

/// Returns when a file was written last.
pub(super) fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_program_writes_itself_is_no_change_and_what_others_write_is() {
        let folder = tempfile::tempdir().unwrap();
        let [model, sidecar, texture] =
            ["a.obj", "a.afterimage.toml", "a.png"].map(|name| folder.path().join(name));
        std::fs::write(&model, "v 0 0 0").unwrap();
        let own = OwnWrites::default();
        let mut known: Vec<SourceFile> =
            [&model, &sidecar, &texture].map(|path| SourceFile::now(path)).to_vec();
        for text in ["unit = 'm'", "unit = 'mm'"] {
            let write = || std::fs::write(&sidecar, text).map(|()| sidecar.clone());
            own.write(write).unwrap();
            let now = own.look(&mut known);
            assert_eq!(now, known);
        }
        std::fs::write(&sidecar, "# by hand").unwrap();
        let now = own.look(&mut known);
        assert_ne!(now, known);
        known = now;
        std::fs::remove_file(&sidecar).unwrap();
        assert_ne!(own.look(&mut known), known);
        known = own.look(&mut known);
        std::fs::write(&texture, "a picture that was missing").unwrap();
        assert_ne!(own.look(&mut known), known);
    }
}
