//! Afterimage as a program: everything a person touches.

pub mod window;
