//! Error against run time: every mode over references and samples, full tracing over samples.
//!
//! References are placed in two ways. *Still*: they stand at equal distances along the walk, and
//! views are taken midway between two of them, where they help least. *Flown*: the camera moves
//! along the walk with the cache and its placement policy. Only the first allows any number of
//! references; only the second is what a user sees.

mod aggregate;
mod charts;
mod compare;
mod headline;
mod pictures;
mod plan;
mod report;
mod run;

pub(super) use plan::{cells, settings};
pub(super) use report::report;
pub(super) use run::run_cell;
