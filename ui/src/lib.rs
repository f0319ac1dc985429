//! Everything a person touches: the command line and the window. No ray and no triangle is handled here.

pub mod cli;
mod memory;
mod notes;
pub mod window;
