//! The work of the render thread.

mod frames;
mod layers;
mod references;
mod replies;
mod run_loop;
mod state;
mod store;

pub(super) use state::Worker;
