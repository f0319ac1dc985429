//! The paper's Table 1, row by row, from our scenes, and its figures 2 to 4.
//!
//! Source: the paper, section 4. We differ: wall time of all threads instead of one processor's; 16
//! shadow rays per light; the look-up modes `fast` and `exact` are added.

mod report;
mod run;
mod views;

pub(super) use report::report;
pub(super) use run::{BOUNCES, cells, run_cell, settings};
