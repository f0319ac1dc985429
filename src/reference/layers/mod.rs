//! The light of a reference by groups of lights.
//!
//! Light is linear in what the lights emit. Where the light of each group is known, that of any
//! setting of the groups is a sum, and takes no ray. Look-ups still read one word of direct and one
//! of smooth light for each pixel; these words are summed again when a setting changes.
//!
//! | File | Contents |
//! |---|---|
//! | `packed` | the light of a group in the tiles that it reaches, and its sum |
//! | `trace` | tracing the light of all groups with one set of rays |

mod packed;
mod trace;

pub(crate) use packed::{LightLayers, LightWords};
pub(crate) use trace::GroupTracer;
