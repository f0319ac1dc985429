//! How frame time grows with pixels, triangles, references, lights, samples and threads, one at a
//! time.
//!
//! Triangles and lights are varied in a generated hall of statues, whose view stays the same
//! however many statues stand behind the viewer. Everything else is measured in the given scene.

mod report;
mod run;

pub(super) use report::report;
pub(super) use run::{cells, run_cell, settings};
