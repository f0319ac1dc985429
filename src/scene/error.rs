//! Errors and warnings of importing and building a scene.

use serde::Serialize;
use std::path::PathBuf;

/// Why a scene could not be made. Each message says what happened, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file could not be read or written.
    #[error("{file}: {cause}; {remedy}", file = file.display())]
    Read {
        /// Path of the file.
        file: PathBuf,
        /// Message of the operating system or the decoder.
        cause: String,
        /// What the user can do.
        remedy: String,
    },
    /// A line of a file makes the rest of the file meaningless.
    #[error("{file}, line {line}: {cause}; {remedy}", file = file.display())]
    Line {
        /// Path of the file.
        file: PathBuf,
        /// Line number, from 1.
        line: u64,
        /// What is wrong with the line.
        cause: String,
        /// What the user can do.
        remedy: String,
    },
    /// The model has no triangle that can be shown.
    #[error("{name}: no triangle is left to show: {cause}; correct the file or export it again")]
    Empty {
        /// Name of the scene.
        name: String,
        /// Why the triangles were dropped.
        cause: String,
    },
    /// The model is larger than the indices of the engine can address.
    #[error("{name}: {count} {what}, at most {limit} are supported; split the model")]
    TooLarge {
        /// Name of the scene.
        name: String,
        /// What there is too much of, in the plural.
        what: &'static str,
        /// The number in the model.
        count: usize,
        /// The largest supported number.
        limit: usize,
    },
    /// There is no embedded scene of this name.
    #[error("there is no embedded scene '{name}'; use one of {known}")]
    UnknownBuiltin {
        /// The name that was requested.
        name: String,
        /// The names that exist, separated by commas.
        known: String,
    },
    /// The user cancelled the import.
    #[error("loading was cancelled")]
    Cancelled,
}

/// A problem of a model that did not stop its import.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// The file, relative to the folder of the scene where possible, or the name of the scene.
    /// Empty if the warning concerns no file.
    pub file: String,
    /// Line number, from 1; 0 if the warning concerns no line.
    pub line: u64,
    /// What was found, and what was done about it.
    pub message: String,
}
