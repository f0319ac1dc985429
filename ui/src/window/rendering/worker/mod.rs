//! The work of the render thread.

mod inbox;
mod references;
mod render_loop;
mod snapshot;
mod state;

pub(super) use state::Worker;
