//! Rays and random numbers. Imports nothing of ours.

pub mod key;
pub mod ray;
pub mod sampling;
pub mod simd;
pub mod whole;

pub use ray::Ray;
