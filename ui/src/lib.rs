//! The user interfaces: the command line and the window. The crate `afterimage` does the rendering.

pub mod cli;
pub mod picture;
pub mod settings;
pub mod window;
pub mod work_plane;
