//! What the window shows of a view that does not change, after given times: the same schedule, and
//! the error against the converged picture.

mod report;
mod run;

pub(super) use report::report;
pub(super) use run::{cells, run_cell, settings};
