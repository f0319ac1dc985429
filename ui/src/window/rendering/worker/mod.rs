//! The work of the render thread.

mod inbox;
mod owner;
mod references;
mod render_loop;
mod snapshot;

pub(super) use owner::Worker;
