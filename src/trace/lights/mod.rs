//! Light arriving from the scene's light sources: points on them, what passes on the way, and which can matter where.

pub(crate) mod grid;
pub(crate) mod quad;
pub(crate) mod sample;
pub(crate) mod shadow;
