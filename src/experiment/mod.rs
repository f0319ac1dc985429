//! Runs that are recorded: the measured walk, and the speed of the parts.
//!
//! One record, many exporters: CSV and JSON derive from the same structures.

pub mod measure;
pub mod record;
pub mod statistics;
pub mod throughput;
pub mod tour;
pub mod truth;
pub mod warp_speed;

pub use measure::{MeasureSettings, Measurement};
pub use record::{FrameRecord, ReferenceRecord, Summary, TourRecord};
pub use throughput::{Throughput, ThroughputSettings};
pub use tour::{TourEvent, TourSettings, run_tour};
