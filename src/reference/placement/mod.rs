//! Placement: at which poses new references are traced.
//!
//! # Adding a rule
//! Write one file with a `pub const NAME: PlacementRule`, declare the file here and add the
//! constant to [`RULES`]. The command line and the window read that table.
//! `docs/how_to_add/placement_rule.md` shows each step with an example.

mod extrapolate;
mod greedy;
mod grid;
mod none;
mod predictive;
mod rule;
mod threshold;
mod walkable;

pub use greedy::GREEDY;
pub use grid::{GRID, directions};
pub use none::NONE;
pub use predictive::PREDICTIVE;
pub use rule::{Observation, OpenPrediction, OpenSpot, PlacementRule, PrefetchRequest, Situation};
pub use threshold::THRESHOLD;
pub use walkable::{Standing, walkable};

use crate::camera::Camera;
use crate::trace::Tracer;

/// All placement rules, in the order in which the interfaces list them.
pub const RULES: &[PlacementRule] = &[PREDICTIVE, THRESHOLD, GREEDY, GRID, NONE];

/// A placement rule together with its threshold.
#[derive(Clone, Copy, Debug)]
pub struct PlacementPolicy {
    /// Rule that decides.
    pub rule: &'static PlacementRule,
    /// Threshold of the rule: open pixels in percent of the picture, 0..100.
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

impl PlacementPolicy {
    /// Combines a rule with the percentage of open pixels above which it acts.
    pub const fn new(rule: &'static PlacementRule, percent: f64) -> Self {
        Self { rule, percent }
    }

    /// Returns the policy with the rule called `name`, or `None` if there is no such rule.
    pub fn named(name: &str, percent: f64) -> Option<Self> {
        RULES.iter().find(|rule| rule.name == name).map(|rule| Self { rule, percent })
    }

    /// Returns the pose at which a new reference should be traced after a frame, if any.
    pub fn decide(
        &self,
        seen: &Observation,
        size: [u32; 2],
        tracer: &Tracer,
        predict_open: OpenPrediction<'_>,
    ) -> Option<Camera> {
        (self.rule.decide)(&mut Situation { seen, percent: self.percent, size, tracer, predict_open })
    }

    /// Returns true if a frame that had to light `lit_percent` of its pixels is kept as a sparse
    /// reference.
    pub fn keeps(&self, lit_percent: f64) -> bool {
        (self.rule.keeps_frame)(lit_percent, self.percent)
    }
}
