//! The measured walk: one frame after another, with a record of each.

mod record;
mod walk;

pub use record::{FrameRecord, MeasuredSummary, Pose, ReferenceRecord, StoreRecord, Summary, TourRecord};
pub use walk::{TourEvent, TourSettings, cameras, fly, run_tour};
