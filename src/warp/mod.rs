//! The forward warp of mode `paper`: choice of references, then the paper's steps 1 to 3.
//! Traces no ray.
//!
//! | File | Paper, section 3 |
//! |---|---|
//! | `select` | several references: which of them are warped |
//! | `splat` | step 1, transform to the new view, and step 2, the nearest sample wins |
//! | `source`, `band` | how `splat` is fast: it skips tiles that cannot reach a band; vectors |
//! | `classify` | step 3, the type of each pixel |

mod band;
mod classify;
mod select;
mod source;
mod splat;

pub use classify::classify;
pub use select::ReferenceSelector;
pub use splat::{MAX_REFERENCE_PIXELS, MAX_REFERENCES, SampleId, WarpBuffer};
