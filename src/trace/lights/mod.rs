//! Sampling of the scene's light sources: which of them matter where (`grid`, `region`, `cut`), in
//! which order many lamps lie (`tree`, `emission`, `arrays`), how many samples each gets (`share`),
//! points on them (`sample`, `quad`), which of those are left to paths (`near`), what passes on the
//! way (`shadow`), the irradiance that arrives (`direct`, `many`), and what rough lobes scatter of
//! it (`lobe`).

mod arrays;
mod cut;
mod direct;
mod emission;
mod grid;
mod lobe;
mod many;
mod near;
mod quad;
mod region;
mod sample;
mod shadow;
mod share;
mod tree;

pub(crate) use direct::{GroupLight, LightKinds};
pub use grid::{LightCuts, LightGrid};
pub(in crate::trace) use lobe::{LitLobe, LobeRay};
pub(in crate::trace) use share::CellLights;

#[cfg(test)]
mod tests;
