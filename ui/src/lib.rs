//! Everything a person touches: the command line and the window. No ray and no triangle is handled here.

pub mod cli;
pub mod picture;
pub mod settings;
pub mod window;
