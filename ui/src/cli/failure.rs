//! How a command ends when it does not end well.

use afterimage::scene::SceneError;

/// Why a command did not end well. Its text is one message for people.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The flags do not make sense together, or with this scene.
    Usage(String),
    /// The scene cannot be imported.
    Import(String),
    /// It did not work.
    Failed(String),
    /// It worked, but `--strict` was given and the scene has so many warnings.
    Warnings(usize),
    /// The user stopped it; what was done is kept.
    Interrupted,
}

impl Failure {
    /// What the program returns.
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
            Self::Interrupted => f.write_str("interrupted; what was done is kept"),
        }
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

impl From<afterimage::raster::save::SaveError> for Failure {
    fn from(error: afterimage::raster::save::SaveError) -> Self {
        Self::Failed(error.to_string())
    }
}
