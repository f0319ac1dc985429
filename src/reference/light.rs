//! Packed light of a reference: RGB9E5, with one word set aside for "no light is stored".

use crate::raster::rgb9e5::Rgb9e5Scale;
use glam::Vec3;

/// Word of a pixel whose light was not traced.
pub const UNLIT: u32 = u32::MAX;

/// Packs light; the result is never [`UNLIT`]. White at the top of the range would be that word and
/// loses one step of blue.
pub fn pack_light(scale: Rgb9e5Scale, light: Vec3) -> u32 {
    not_unlit(scale.pack(light))
}

/// A packed word of light, with another one in the place of [`UNLIT`].
#[inline(always)]
pub(crate) fn not_unlit(word: u32) -> u32 {
    if word == UNLIT { word - (1 << 18) } else { word }
}
