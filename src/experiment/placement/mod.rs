//! Where references should stand: every placement rule on the same walks.
//!
//! A cell is a walk in a mode with one rule and one threshold. Rules are compared by the pixels
//! that no reference knows, for which the viewer waits, at no more tracing in frames and references
//! together: a rule that traces more may well know more.
//!
//! Further cells repeat a walk with a store: a second time, and after a bake along the walk.

mod floor_plan;
mod policies;
mod reference_usage;
mod report;
mod run;
mod stored;
mod summary;
mod walks;

pub(super) use report::report;
pub(super) use run::{cells, run_cell, settings};
