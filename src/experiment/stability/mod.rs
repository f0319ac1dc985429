//! Ill-conditioned and extreme cases, each with what must hold, what was measured and the bound:
//! scale, camera, geometry, materials, cache, theorems of rays, the known artefacts of warping, and
//! stores.
//!
//! A case is data and a function that measures; the program decides, not a person. A case that
//! cannot hold states why.

mod artefacts;
mod cache;
mod camera;
mod case;
mod geometry;
mod lamps;
mod light;
mod materials;
mod pictures;
mod relief;
mod report;
mod rooms;
mod rough;
mod run;
mod scale;
mod stored;
mod theorems;

pub use case::{Case, Measured, Trial};
pub(super) use report::report;
pub use run::cases;
pub(super) use run::{cells, run_cell, settings};
