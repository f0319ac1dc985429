//! Rays, random numbers, sampling, SIMD levels. Imports no other module of the crate.

pub mod key;
pub mod ray;
pub mod rounding;
pub mod sampling;
pub mod sequence;
pub mod simd;

pub use ray::Ray;
