//! Why a run cannot be started or continued.

use crate::raster::{metrics::CompareError, save::SaveError};
use crate::scene::SceneError;
use std::path::{Path, PathBuf};

/// Why a run cannot be started or continued.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// A folder or a file of a run does not hold the expected data.
    #[error("{path}: {cause}", path = path.display())]
    Folder {
        /// Path of the folder or file.
        path: PathBuf,
        /// What is wrong, and what to do.
        cause: String,
    },
    /// The operating system refused to read or write a file.
    #[error("{path}: {cause}", path = path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        cause: std::io::Error,
    },
    /// A picture or a table cannot be written.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// Two pictures cannot be compared.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// A scene that the experiment generates is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The camera path has no key frames.
    #[error("the walk has no key frames; it needs at least one")]
    EmptyWalk,
    /// The experiment has no cell with these settings.
    #[error("{experiment} has no cell '{cell}'")]
    UnknownCell {
        /// Name of the experiment.
        experiment: &'static str,
        /// Settings of the cell.
        cell: String,
    },
    /// The experiment cannot run with this scene, these settings or on this machine.
    #[error("{0}")]
    Unsuitable(String),
    /// `merge` was called without folders.
    #[error("there is no folder to merge; give the folders of the shards")]
    NothingToMerge,
}

impl ExperimentError {
    /// An error of the operating system at a path.
    pub(crate) fn at(path: &Path, cause: std::io::Error) -> Self {
        Self::File { path: path.to_owned(), cause }
    }

    /// A folder or file that does not hold the expected data.
    pub(super) fn folder(path: &Path, cause: impl Into<String>) -> Self {
        Self::Folder { path: path.to_owned(), cause: cause.into() }
    }
}
