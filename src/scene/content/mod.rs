//! Hashes of the parts of a scene by their content, so that light that was traced in one state of a
//! scene can be recognised as right in another, whatever the files are called and however they
//! number their triangles.
//!
//! | File | Contents |
//! |---|---|
//! | `hasher` | the function, with a version |
//! | `geometry` | each triangle in world space |
//! | `light` | materials by what they reflect, let through and emit; lights, sun, sky |

mod geometry;
mod hasher;
mod light;

pub use geometry::hashes_of_triangles;
pub use hasher::ContentHash;
pub(crate) use light::materials_of_both;
pub use light::{LightContent, MaterialContent};
