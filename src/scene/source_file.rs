//! The files that a scene was read from.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// A file that belongs to a scene, as it was when it was read. Whoever looks at it again knows
/// whether it has changed since.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SourceFile {
    /// Path of the file. A file that was not found stands where it was looked for first.
    pub path: PathBuf,
    /// When the file was written last, and its length in bytes; `None` where there is no file.
    pub stamp: Option<(SystemTime, u64)>,
}

impl SourceFile {
    /// Returns the state that a file has now.
    pub fn now(path: &Path) -> Self {
        let stamp = std::fs::metadata(path).ok().and_then(|data| Some((data.modified().ok()?, data.len())));
        Self { path: path.to_owned(), stamp }
    }
}
