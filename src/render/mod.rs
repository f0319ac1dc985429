//! The stages in order, timed: from a pose and the references at hand to a finished frame.

#[cfg(feature = "pictures")]
pub mod aov;
pub mod audit;
pub mod bands;
mod finish;
pub mod frame;
mod look_up;
mod placeholders;
mod prefetch;
mod reference_job;
pub mod refine;
pub mod renderer;
mod temporal_stability;
pub mod walkthrough;

pub use audit::statistics::AuditEstimate;
pub use frame::{Frame, FrameStats, StageSecs};
pub use reference_job::ReferenceJob;
pub use refine::{RefineState, render_antialiased};
pub use renderer::Renderer;
pub use temporal_stability::TemporalStability;
pub use walkthrough::{Walkthrough, WalkthroughSettings};

use crate::trace::TraceSettings;
use serde::{Deserialize, Serialize};

/// How a frame is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// The ordinary ray tracer: the baseline, and the truth at many samples.
    Full,
    /// The paper to the letter, for comparison; never improved.
    Paper,
    /// The primary ray's surface at every pixel, its light looked up in the one best reference and never doubted.
    Fast,
    /// The primary ray's surface at every pixel, its light averaged over references, and checked where it is a guess.
    #[default]
    Exact,
}

impl Mode {
    /// True where every pixel is shaded as in `full`, to the bit. Without references only `fast` does otherwise: it
    /// shades with fewer samples.
    pub fn traces_all(self, has_no_references: bool) -> bool {
        self == Self::Full || has_no_references && self != Self::Fast
    }

    /// The name used on the command line and in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Paper => "paper",
            Self::Fast => "fast",
            Self::Exact => "exact",
        }
    }

    /// True for the modes whose picture is refined at rest: the paper's stays as the paper has it.
    pub fn refines(self) -> bool {
        self != Self::Paper
    }

    /// True for the modes that look light up surface point by surface point, and whose references are sparse.
    pub fn looks_up(self) -> bool {
        matches!(self, Self::Fast | Self::Exact)
    }
}

/// What a frame is made with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderSettings {
    /// Which stages.
    pub mode: Mode,
    /// Samples, bounces, seed.
    pub trace: TraceSettings,
}
