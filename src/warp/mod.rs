//! The paper's steps 1 to 3: references are warped into a view, and every pixel gets its type. Pure functions of
//! buffers: nothing here traces a ray.

mod band;
pub mod classify;
mod reach;
pub mod splat;

pub use classify::classify;
pub use splat::{SampleId, WarpBuffer};
