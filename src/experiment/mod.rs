//! Recorded runs: the measured walk, and the experiments that produce the figures of the
//! documentation.
//!
//! [`run`] is the framework: cells, a journal of finished cells, shards, merging, and reports as
//! data. [`registry`] lists the experiments; each has a folder of its own. [`measure`] compares
//! frames with converged pictures. How to add an experiment: `docs/how_to_add/experiment.md`.

mod at_rest;
mod error_time;
pub mod measure;
mod placement;
pub mod registry;
pub mod run;
mod scaling;
mod soak;
pub mod stability;
pub mod statistics;
mod table1;
pub mod throughput;
pub mod tour;

pub use measure::{MeasureSettings, Measurement};
pub use throughput::{Throughput, ThroughputSettings};
pub use tour::{FrameRecord, ReferenceRecord, Summary, TourEvent, TourRecord, TourSettings, run_tour};
