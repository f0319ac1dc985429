//! The embedded scenes: a gallery to walk through, and small scenes with known pictures.

mod cornell;
mod furnace;
#[cfg(feature = "pictures")]
mod gallery;
mod mirrors;
#[cfg_attr(
    not(feature = "pictures"),
    allow(dead_code, unused_imports, reason = "the gallery uses most of the shapes")
)]
mod shapes;
mod views;

#[cfg(feature = "pictures")]
pub use gallery::statue_hall;

use super::{Scene, SceneBuilder, SceneError};

/// Names of the embedded scenes. The first is the default. The textures of the gallery are PNG
/// files, so it exists only with the feature `pictures`.
pub const NAMES: &[&str] = &[
    #[cfg(feature = "pictures")]
    "gallery",
    "cornell",
    "cornell-glass",
    "mirrors",
    "furnace",
];

/// Builds the embedded scene `name`.
///
/// # Errors
/// [`SceneError::UnknownBuiltin`] if there is no embedded scene of that name.
pub fn build(name: &str) -> Result<Scene, SceneError> {
    let mut b = SceneBuilder::new(&format!("builtin:{name}"));
    match name {
        #[cfg(feature = "pictures")]
        "gallery" => gallery::add_to(&mut b)?,
        "cornell" => cornell::add_to(&mut b, cornell::Contents::Boxes),
        "cornell-glass" => cornell::add_to(&mut b, cornell::Contents::Spheres),
        "mirrors" => mirrors::add_to(&mut b),
        "furnace" => furnace::add_to(&mut b),
        _ => return Err(SceneError::UnknownBuiltin { name: name.to_owned(), known: NAMES.join(", ") }),
    }
    b.finish()
}
