//! Where the next reference should stand.
//!
//! # Adding a rule
//! Write one file with a `pub const NAME: PlacementRule` and add it to [`RULES`]: command line, window and the experiment
//! `placement` take it from there.

mod extrapolate;
mod greedy;
mod grid;
mod none;
mod predictive;
mod threshold;
mod walkable;

pub use greedy::GREEDY;
pub use grid::GRID;
pub use none::NONE;
pub use predictive::PREDICTIVE;
pub use threshold::THRESHOLD;
pub use walkable::{Standing, walkable};

use crate::camera::Camera;
use crate::trace::Tracer;
use glam::Vec2;

/// All rules, in the order in which people see them.
pub const RULES: &[PlacementRule] = &[PREDICTIVE, THRESHOLD, GREEDY, GRID, NONE];

/// A rule for adding references, as data: what it decides depends on the situation alone.
#[derive(Clone, Copy, Debug)]
pub struct PlacementRule {
    /// On the command line and in records.
    pub name: &'static str,
    /// What it does, in a few words.
    pub about: &'static str,
    /// Whether the percentage of the policy means something to it.
    pub has_threshold: bool,
    /// Poses whose references are made before the first frame is needed, and never again; most have none.
    pub poses_ahead: fn(&Tracer, &AheadRequest) -> Vec<Camera>,
    /// The pose at which a new reference is wanted after a frame, if any.
    pub decide: fn(&mut Situation<'_>) -> Option<Camera>,
    /// Whether a frame that lit so many percent of its pixels itself is kept as a sparse reference, by the policy's own
    /// percentage.
    pub keeps: fn(lit_percent: f64, percent: f64) -> bool,
}

/// A rule and the percentage of open pixels at which it acts.
#[derive(Clone, Copy, Debug)]
pub struct PlacementPolicy {
    /// Which one.
    pub rule: &'static PlacementRule,
    /// Of the pixels.
    pub percent: f64,
}

impl Default for PlacementPolicy {
    fn default() -> Self {
        Self::new(&PREDICTIVE, 5.0)
    }
}

impl PartialEq for PlacementPolicy {
    fn eq(&self, other: &Self) -> bool {
        (self.rule.name, self.percent) == (other.rule.name, other.percent)
    }
}

/// What a policy sees of the last frame.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
    /// The frame's camera.
    pub camera: Camera,
    /// The camera one frame before; the same where there was none.
    pub previous: Camera,
    /// Pixels in percent that a reference here would have to light: Type 3 for the paper's references, for sparse ones
    /// only what no reference knows.
    pub open_percent: f64,
    /// Whether references light only what older ones do not know.
    pub is_sparse: bool,
    /// The frame was stopped before its end, so that what it lit is not kept.
    pub was_cut: bool,
    /// References held.
    pub held: usize,
}

/// A piece of a picture that no reference knows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenSpot {
    /// Its middle, in pixels.
    pub point: Vec2,
    /// Of all pixels of the picture, in percent.
    pub percent: f64,
}

/// Foretells what percentage of a pose's pixels is open, from the references held; tells where too if a list is given.
pub type Foresight<'a> = &'a mut dyn FnMut(&Camera, Option<&mut Vec<OpenSpot>>) -> f64;

/// All that a rule may ask.
pub struct Situation<'a> {
    /// The last frame.
    pub seen: &'a Observation,
    /// Of the policy.
    pub percent: f64,
    /// Of the pictures.
    pub size: [u32; 2],
    /// The scene.
    pub tracer: &'a Tracer,
    /// What is open elsewhere.
    pub foresee: Foresight<'a>,
}

impl std::fmt::Debug for Situation<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Situation").field("seen", self.seen).finish_non_exhaustive()
    }
}

/// What references that are made ahead must keep to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AheadRequest {
    /// Of the pictures.
    pub size: [u32; 2],
    /// Vertical field of view in radians.
    pub fov_y: f64,
    /// References at most.
    pub most: usize,
}

impl PlacementPolicy {
    /// A rule that acts above a percentage of open pixels.
    pub const fn new(rule: &'static PlacementRule, percent: f64) -> Self {
        Self { rule, percent }
    }

    /// The rule of a name.
    pub fn named(name: &str, percent: f64) -> Option<Self> {
        RULES.iter().find(|rule| rule.name == name).map(|rule| Self { rule, percent })
    }

    /// The pose at which a new reference is wanted, if any.
    pub fn decide(
        &self,
        seen: &Observation,
        size: [u32; 2],
        tracer: &Tracer,
        foresee: Foresight<'_>,
    ) -> Option<Camera> {
        (self.rule.decide)(&mut Situation { seen, percent: self.percent, size, tracer, foresee })
    }

    /// Whether a frame that lit this percentage of its pixels itself is kept as a sparse reference.
    pub fn keeps(&self, lit_percent: f64) -> bool {
        (self.rule.keeps)(lit_percent, self.percent)
    }
}

impl PlacementRule {
    /// Makes nothing ahead.
    pub(crate) fn none_ahead(_: &Tracer, _: &AheadRequest) -> Vec<Camera> {
        Vec::new()
    }
}

/// A reference costs what tracing a whole frame does. While the viewer moves, one is worth it only where at least this
/// percentage of the picture would be open, whatever the threshold: on the gallery's walk 71 references with 5.7 % Type 3
/// in the median, against 102 with 4.0 % where 5 % open ahead suffice.
const WORTH_PERCENT: f64 = 20.0;

/// A sparse reference costs little more than the pixels it lights, and those would be shaded in frame after frame. So
/// one is worth it where this percentage of the picture ahead is not known.
const SPARSE_WORTH_PERCENT: f64 = 1.0;

impl Observation {
    /// True where the viewer has not moved.
    pub fn is_still(&self) -> bool {
        self.camera == self.previous
    }

    /// Above which percentage of open pixels a reference is worth what it costs.
    fn worth_percent(&self, percent: f64) -> f64 {
        match (self.is_sparse, self.is_still() || self.held == 0) {
            (true, _) => SPARSE_WORTH_PERCENT.min(percent),
            (false, true) => percent,
            (false, false) => percent.max(WORTH_PERCENT),
        }
    }
}
