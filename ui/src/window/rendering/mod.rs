//! Everything that runs beside the window's thread: rendering, references, background tasks, and the data
//! that they exchange with the window.

pub mod depth_ranges;
pub mod exchange;
pub(crate) mod full_trace;
pub(crate) mod lock;
pub mod plan;
pub(crate) mod pool;
mod references;
pub mod render_thread;
pub mod request;
pub mod scene_loading;
mod shared;
pub mod task;
pub mod thumbnails;
mod worker;
