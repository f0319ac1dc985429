//! How far a frame is from the converged picture of its view, and how long it takes.

mod errors;
mod measurement;
mod pictures;
mod references;
mod trial;
mod truth;

pub use errors::Errors;
pub use measurement::{DEPTH_TOLERANCE, MeasureSettings, Measurement, Measurer, see_through_percent};
pub use pictures::FramePictures;
pub use references::References;
pub use trial::{Trial, antialiased_truth_of, spread_over_passes, truth_of};
pub use truth::{TruthRequest, truth};
