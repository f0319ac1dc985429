//! Hours of use in minutes: walking, changing mode and size, adding and clearing references, and
//! editing the scene, long enough to reveal a leak or a slowdown.

mod report;
mod run;

pub(super) use report::report;
pub(super) use run::{cells, run_cell, settings};
