//! Picture files: rendering and writing them, and restoring a view from one. The command line and
//! the window share this module, so that both write the same bits.

pub mod film;
mod film_writer;
mod job;
pub(crate) mod memory;
mod metadata;
mod numbered;
pub mod panorama;
pub mod pose_text;
pub mod restore;
pub mod sequence;
mod timed;

pub use job::{MadePicture, Output, PictureJob, Shows};
pub use memory::{LONGEST_SIDE, TooLarge};
pub(crate) use metadata::{PictureOrigin, metadata};
pub use timed::TimedState;
pub(crate) use timed::check_timed;
