//! The modes, rules and thresholds that are compared.

use crate::render::Mode;

pub(super) const MODES: [Mode; 2] = [Mode::Paper, Mode::Exact];

/// A placement rule and the percentages at which it is measured. Above 20 %, and for sparse
/// references below 1 %, the percentage alone decides whether a reference is worth tracing.
pub(super) struct Policy {
    pub(super) rule: &'static str,
    /// Percentages for the dense references of the paper; the quick effort takes the first.
    dense: &'static [f64],
    /// Percentages for the sparse references of the look-up; the quick effort takes the first.
    sparse: &'static [f64],
}

impl Policy {
    /// The percentages for the references of a mode.
    pub(super) fn percents(&self, mode: Mode) -> &'static [f64] {
        if mode.looks_up() { self.sparse } else { self.dense }
    }
}

/// The rules and thresholds that are compared.
pub(super) const POLICIES: &[Policy] = &[
    Policy { rule: "threshold", dense: &[5.0, 2.0, 10.0, 20.0, 40.0], sparse: &[1.0, 0.25, 4.0, 16.0] },
    Policy { rule: "predictive", dense: &[5.0, 30.0, 50.0], sparse: &[1.0, 0.25, 0.0625] },
    Policy { rule: "greedy", dense: &[5.0, 30.0, 50.0], sparse: &[1.0, 0.25, 0.0625] },
    Policy { rule: "grid", dense: &[0.0], sparse: &[0.0] },
    Policy { rule: "none", dense: &[0.0], sparse: &[0.0] },
];
