//! Packed light of a reference: RGB9E5, with one word set aside for "no light is stored".

use crate::raster::rgb9e5::Rgb9e5Scale;
use glam::Vec3;

/// Word of a pixel whose light was not traced.
pub const UNLIT: u32 = u32::MAX;

/// Packs light; the result is never [`UNLIT`]. White at the top of the range would be that word and
/// loses one step of blue.
pub fn pack_light(scale: Rgb9e5Scale, light: Vec3) -> u32 {
    let word = scale.pack(light);
    if word == UNLIT { word - (1 << 18) } else { word }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_light_packs_to_the_word_for_unlit() {
        let scale = Rgb9e5Scale::for_largest(1.0);
        for light in [Vec3::ONE, Vec3::splat(1e30), Vec3::splat(f32::INFINITY), Vec3::NAN, Vec3::NEG_ONE] {
            assert_ne!(pack_light(scale, light), UNLIT);
        }
        assert_eq!(scale.unpack(pack_light(scale, Vec3::ZERO)), Vec3::ZERO);
    }
}
