//! How far a frame is from the converged picture of its view, and how long it takes.

pub mod errors;
pub mod measurement;
mod references;
pub mod trial;
pub mod truth;

pub use errors::Errors;
pub use measurement::{MeasureError, MeasureSettings, Measurement, Measurer};
pub use references::References;
pub use trial::{Trial, truth_of};
