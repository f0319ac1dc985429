//! The size of a store: whole segments are removed, the longest unused first.
//!
//! A segment counts as used when it is written and when a reference is read from it; its time of
//! modification says when. Records that serve one view lie together, because a walk wrote them one
//! after the other, so whole segments are not much coarser than single records, and removing one
//! takes no time. Segments that another process is writing are locked and stay.

use super::segment::segment_paths;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Removes segments until the others have at most `max_bytes` together. Keeps `own`. Returns their
/// size afterwards, bytes.
pub(super) fn shrink(folder: &Path, max_bytes: u64, own: Option<&Path>) -> u64 {
    let mut segments: Vec<(SystemTime, PathBuf, u64)> =
        segment_paths(folder).unwrap_or_default().into_iter().filter_map(with_age).collect();
    segments.sort();
    let mut total: u64 = segments.iter().map(|segment| segment.2).sum();
    for (_, path, bytes) in segments {
        if total <= max_bytes {
            break;
        }
        if own != Some(&*path) && remove(&path) {
            total -= bytes;
        }
    }
    total
}

fn with_age(path: PathBuf) -> Option<(SystemTime, PathBuf, u64)> {
    let metadata = path.metadata().ok()?;
    Some((metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH), path, metadata.len()))
}

/// Removes a segment unless a process is writing it.
pub(super) fn remove(path: &Path) -> bool {
    let is_written = |file: &File| matches!(file.try_lock(), Err(std::fs::TryLockError::WouldBlock));
    let is_free = File::open(path).is_ok_and(|file| !is_written(&file));
    is_free && std::fs::remove_file(path).is_ok()
}
