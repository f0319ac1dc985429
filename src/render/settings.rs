//! The settings of a frame, which are the mode and what the tracer is run with, and those of a
//! walk.

use crate::lookup::LookupQuality;
use crate::reference::PlacementPolicy;
use crate::store::Purpose;
use crate::trace::TraceSettings;
use serde::{Deserialize, Serialize};

/// The method that makes a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// The ordinary ray tracer: the baseline, and the ground truth at a high sample count.
    Full,
    /// The paper's method exactly as published, for comparison.
    Paper,
    /// A primary ray for every pixel, with light looked up in the one best reference and not
    /// checked.
    Fast,
    /// A primary ray for every pixel, with light averaged over references and checked where it is
    /// a guess.
    #[default]
    Exact,
}

impl Mode {
    /// True where every pixel is shaded as in mode `full`, with the same bits. Without references,
    /// and so without a cache that paths may end in, only `fast` differs: it shades with fewer
    /// samples.
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

    /// True for the modes whose picture is refined while the camera is stationary. Mode `paper`
    /// shows the paper's picture unchanged.
    pub fn refines(self) -> bool {
        self != Self::Paper
    }

    /// True for the modes that look up light per surface point, and whose references are sparse.
    pub fn looks_up(self) -> bool {
        self.lookup_quality().is_some()
    }

    /// What the references of a mode are traced for.
    pub fn purpose(self) -> Purpose {
        if self == Self::Paper { Purpose::Warp } else { Purpose::LookUp }
    }

    /// How carefully a mode looks light up; `None` for the modes that do not.
    pub fn lookup_quality(self) -> Option<LookupQuality> {
        match self {
            Self::Full | Self::Paper => None,
            Self::Fast => Some(LookupQuality::FAST),
            Self::Exact => Some(LookupQuality::EXACT),
        }
    }
}

/// The settings of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderSettings {
    /// The method.
    pub mode: Mode,
    /// Sample count, bounces and seed of the tracer.
    pub trace: TraceSettings,
}

impl RenderSettings {
    /// The trace settings for shading the pixels that no reference knows.
    pub(super) fn unseen_trace(&self) -> TraceSettings {
        self.mode.lookup_quality().map_or(self.trace, |quality| quality.unseen_trace(&self.trace))
    }
}

/// The settings of a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkthroughSettings {
    /// Mode, sample count, bounces and seed.
    pub render: RenderSettings,
    /// The policy that decides where references are added.
    pub placement: PlacementPolicy,
    /// References that a frame of mode `paper` warps at most.
    pub max_references: usize,
    /// Memory for references, bytes.
    pub cache_bytes: usize,
    /// Whether a few pixels of every looked-up frame are audited: traced in full as well, to
    /// estimate the error and to find references that are wrong. How many depends on the clock.
    pub audits: bool,
    /// Whether every frame is compared with the previous one, to measure flicker.
    pub measures_stability: bool,
}

impl Default for WalkthroughSettings {
    fn default() -> Self {
        Self {
            render: RenderSettings::default(),
            placement: PlacementPolicy::default(),
            max_references: 8,
            cache_bytes: 1024 << 20,
            audits: false,
            measures_stability: false,
        }
    }
}
