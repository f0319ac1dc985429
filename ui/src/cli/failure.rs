//! Failures of a command and their exit codes.

use crate::picture::TooLarge;
use afterimage::experiment::run::ExperimentError;
use afterimage::{raster::save::SaveError, render::bake::BakeError, scene::SceneError, store::StoreError};

/// Why a command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The flags contradict each other or the scene.
    Usage(String),
    /// The scene cannot be imported.
    Import(String),
    /// The command could not do its work.
    Failed(String),
    /// The command succeeded, but `--strict` was given and the scene has this number of warnings.
    Warnings(usize),
    /// The user interrupted the command; finished results are kept.
    Interrupted,
}

impl Failure {
    /// Exit code of the program.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Failed(_) => 1,
            Self::Usage(_) => 2,
            Self::Import(_) => 3,
            Self::Warnings(_) => 4,
            Self::Interrupted => 130,
        }
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Usage(text) | Self::Import(text) | Self::Failed(text) => write!(f, "error: {text}"),
            Self::Warnings(1) => f.write_str("error: the scene has a warning, and --strict was given"),
            Self::Warnings(n) => write!(f, "error: the scene has {n} warnings, and --strict was given"),
            Self::Interrupted => f.write_str("interrupted; finished results are kept"),
        }
    }
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::Failed(format!("{error:#}"))
    }
}

impl From<TooLarge> for Failure {
    fn from(error: TooLarge) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<SaveError> for Failure {
    fn from(error: SaveError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Cancelled => Self::Interrupted,
            other => Self::Import(other.to_string()),
        }
    }
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<BakeError> for Failure {
    fn from(error: BakeError) -> Self {
        match error {
            BakeError::Stopped => Self::Interrupted,
            BakeError::NoPlace | BakeError::EmptyPath => Self::Usage(error.to_string()),
            BakeError::NothingSeen | BakeError::NoLight => Self::Failed(error.to_string()),
        }
    }
}

impl From<ExperimentError> for Failure {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Scene(error) => error.into(),
            other => Self::Failed(other.to_string()),
        }
    }
}
