//! Choosing files: folders as lists, paths as they are typed, and the dialog of the system.

pub mod listing;
pub mod system;
pub mod typed;

pub use listing::{Entry, Listing, Reached};
pub use system::{Asked, ask_system};
pub use typed::{completed, home, path_of};
