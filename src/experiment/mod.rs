//! Runs that are recorded: the measured walk, the speed of the parts, and the experiments of [`run`], which also tells
//! how to add one.
//!
//! One record, many exporters: CSV, JSON, plots and the report derive from the same structures.

mod error_time;
pub mod errors;
pub mod measure;
mod placement;
pub mod record;
pub mod run;
mod scaling;
mod soak;
pub mod stability;
pub mod statistics;
mod table1;
pub mod throughput;
pub mod tour;
pub mod trial;
pub mod truth;

pub use measure::{MeasureSettings, Measurement};
pub use record::{FrameRecord, ReferenceRecord, Summary, TourRecord};
pub use throughput::{Throughput, ThroughputSettings};
pub use tour::{TourEvent, TourSettings, run_tour};
