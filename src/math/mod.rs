//! Rays, random numbers, sampling, SIMD levels. Imports no other module of the crate.

pub mod key;
pub mod ray;
pub mod sampling;
pub mod simd;
pub mod whole;

pub use ray::Ray;
