//! The embedded scenes: a gallery to walk through, and small scenes with known pictures.

mod cornell;
mod furnace;
#[cfg(feature = "pictures")]
mod gallery;
#[cfg(feature = "pictures")]
mod gallery_bench;
mod mirrors;
#[cfg(feature = "pictures")]
mod parts;
#[cfg_attr(
    not(feature = "pictures"),
    allow(dead_code, unused_imports, reason = "the gallery uses most of the shapes")
)]
mod shapes;
#[cfg(feature = "pictures")]
mod statue_hall;
mod studio;
mod varnished_hall;
mod views;

#[cfg(feature = "pictures")]
pub use statue_hall::statue_hall;

use super::{Scene, SceneBuilder, SceneError};
use crate::raster::exposure::Exposure;

/// Names of the embedded scenes. The first is the default. The textures of the galleries
/// are PNG files, so they exist only with the feature `pictures`.
pub const NAMES: &[&str] = &[
    #[cfg(feature = "pictures")]
    "gallery",
    #[cfg(feature = "pictures")]
    BENCH,
    "cornell",
    "cornell-glass",
    "mirrors",
    "furnace",
    "studio",
    "varnished-hall",
];

/// Name of the gallery on which speed is measured. It never changes, so that measurements of
/// different builds can be compared.
#[cfg(feature = "pictures")]
pub const BENCH: &str = "gallery-bench";

/// Builds the embedded scene `name`.
///
/// # Errors
/// [`SceneError::UnknownBuiltin`] if there is no embedded scene of that name.
pub fn build(name: &str) -> Result<Scene, SceneError> {
    let mut b = SceneBuilder::new(&format!("builtin:{name}"));
    // Their lamps were chosen for this; a scene may choose another.
    b.exposure = Exposure::Stops(0.0);
    match name {
        #[cfg(feature = "pictures")]
        "gallery" => gallery::add_to(&mut b)?,
        #[cfg(feature = "pictures")]
        BENCH => gallery_bench::add_to(&mut b)?,
        "cornell" => cornell::add_to(&mut b, cornell::Contents::Boxes),
        "cornell-glass" => cornell::add_to(&mut b, cornell::Contents::Spheres),
        "mirrors" => mirrors::add_to(&mut b),
        "furnace" => furnace::add_to(&mut b),
        "studio" => studio::add_to(&mut b),
        "varnished-hall" => varnished_hall::add_to(&mut b),
        _ => return Err(SceneError::UnknownBuiltin { name: name.to_owned(), known: NAMES.join(", ") }),
    }
    b.finish()
}
