//! References that last: a store of reference images on disk.
//!
//! A store is a folder of *segments*, files that are only ever appended to. A segment is a sequence
//! of *records*, one reference each: a header with the lengths of what follows and checksums, a
//! summary, and the compressed pixels. The index is rebuilt by a scan of headers and summaries, so
//! nothing but whole records is ever trusted, and a kill at any byte loses at most the record that
//! is being written. `docs/STORE.md` describes the format.
//!
//! A [`StoreSession`] is a store in use by a walk: it reads the references that serve a view, and
//! hands new ones to a thread that writes them. A [`StoreBuilder`] adds references one by one and
//! removes none.

mod append;
mod budget;
mod builder;
mod bytes;
mod cells;
mod codec;
mod content;
mod coverage;
mod hash;
mod index;
mod maintain;
mod record;
mod segment;
mod serving;
mod session;
mod state;
mod states;
mod summary;
#[cfg(test)]
mod tests;
mod writer;

pub use builder::StoreBuilder;
pub use content::SceneContent;
pub use coverage::StoreCoverage;
pub use index::StoreIndex;
pub use maintain::{MaintenanceReport, merge, prune, verify};
pub use session::{StoreReport, StoreSession};
pub use summary::{Purpose, RecordSummary};
pub use writer::WriteReport;

use std::path::PathBuf;

/// Where a store is, and how large it may become.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoreSettings {
    /// The folder; created with the first record.
    pub folder: PathBuf,
    /// Largest size of all segments together, bytes.
    pub max_bytes: u64,
}

/// A store cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The folder cannot be listed.
    #[error("cannot read the store {path}: {cause}", path = path.display())]
    Folder {
        /// Path of the folder.
        path: PathBuf,
        /// Error of the system.
        cause: std::io::Error,
    },
    /// The folder, or a file in it, cannot be written.
    #[error("cannot write to the store {path}: {cause}", path = path.display())]
    Write {
        /// Path of the folder.
        path: PathBuf,
        /// Error of the system.
        cause: std::io::Error,
    },
    /// The store has its largest size.
    #[error(
        "the store {path} is full: it has its limit of {} MB; --store-mb sets a larger one",
        max_bytes >> 20,
        path = path.display()
    )]
    Full {
        /// Path of the folder.
        path: PathBuf,
        /// The limit, bytes.
        max_bytes: u64,
    },
}
