//! What runs beside the window: the threads that make frames, references, comparisons and thumbnails, and what they exchange with it.

pub mod comparison;
pub mod depth_ranges;
pub mod exchange;
pub mod full_trace;
pub mod plan;
pub mod references;
pub mod render_thread;
pub mod request;
pub mod scene_loading;
pub mod thumbnails;
pub mod worker;
