//! Sampling of the scene's light sources: which of them matter where (`grid`), how many samples
//! each gets (`share`), points on them (`sample`, `quad`), what passes on the way (`shadow`), and
//! the irradiance that arrives (`direct`), and what rough lobes scatter of it (`lobe`).

mod direct;
mod grid;
mod lobe;
mod near;
mod quad;
mod sample;
mod shadow;
mod share;

pub(crate) use direct::{GroupLight, LightKinds};
pub use grid::{LightCuts, LightGrid};
pub(in crate::trace) use lobe::{LitLobe, LobeRay};
pub(in crate::trace) use share::CellLights;
