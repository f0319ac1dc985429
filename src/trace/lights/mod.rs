//! Sampling of the scene's light sources: which of them matter where (`grid`), points on them
//! (`sample`, `quad`), what passes on the way (`shadow`), and the irradiance that arrives
//! (`direct`).

mod direct;
mod grid;
mod quad;
mod sample;
mod shadow;

pub use grid::{LightCuts, LightGrid};
