//! Arriving light in four bytes.
//!
//! Source: the RGB9E5 shared-exponent format (OpenGL extension `EXT_texture_shared_exponent`). We differ: the exponent's
//! bias belongs to the reference, so that any scene's brightest light fits, whatever its units; and the word of all
//! ones says that no light is known. The error is at most 2^-9 of the largest channel, a twentieth of the noise of
//! sixteen shadow rays.

use glam::Vec3;

/// The word of a pixel whose light was not traced.
pub const UNLIT: u32 = u32::MAX;

const MANTISSA_BITS: u32 = 9;
const LARGEST_MANTISSA: f32 = 511.0;
const LARGEST_EXPONENT: i32 = 31;

/// The exponent's bias of one reference: what turns words into light and back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightScale {
    /// Added to a word's exponent it gives the exponent field of an f32 that one step of the mantissa is worth.
    pub exponent_offset: u32,
}

impl LightScale {
    /// The scale under which `largest`, the brightest channel of all, just fits.
    pub fn for_largest(largest: f32) -> Self {
        // largest <= 2^k; word exponent 31 means mantissas in units of 2^(k - 9).
        let k = if largest > 0.0 && largest.is_finite() { largest.log2().ceil() as i32 } else { 0 };
        let offset = k - LARGEST_EXPONENT - MANTISSA_BITS as i32 + 127;
        Self { exponent_offset: offset.clamp(1, 254 - LARGEST_EXPONENT) as u32 }
    }

    /// What one step of the mantissa is worth under a word's exponent.
    fn step(self, exponent: u32) -> f32 {
        f32::from_bits((exponent + self.exponent_offset) << 23)
    }

    /// The first under which a mantissa may fit: with the one before, `largest` would be 512 steps or more.
    fn first_exponent(self, largest: f32) -> u32 {
        let power = (largest.to_bits() >> 23) as i32;
        (power - (MANTISSA_BITS as i32 - 1) - self.exponent_offset as i32).clamp(0, LARGEST_EXPONENT) as u32
    }

    /// Packs light; what is above the range is cut to it, what is not a number is black.
    pub fn pack(self, light: Vec3) -> u32 {
        let light = light.max(Vec3::ZERO);
        let largest = light.max_element();
        if largest.is_nan() || largest <= 0.0 {
            return 0;
        }
        let mut exponent = self.first_exponent(largest);
        while exponent < LARGEST_EXPONENT as u32 && (largest / self.step(exponent)).round() > LARGEST_MANTISSA
        {
            exponent += 1;
        }
        let mantissa = |x: f32| (x / self.step(exponent)).round().clamp(0.0, LARGEST_MANTISSA) as u32;
        let word = mantissa(light.x) | mantissa(light.y) << 9 | mantissa(light.z) << 18 | exponent << 27;
        // One step less blue where white at the top of the range would read as unlit.
        if word == UNLIT { word - (1 << 18) } else { word }
    }

    /// The light of a word that is not [`UNLIT`].
    #[inline(always)]
    pub fn unpack(self, word: u32) -> Vec3 {
        let mantissa = |shift: u32| ((word >> shift) & 0x1ff) as f32;
        Vec3::new(mantissa(0), mantissa(9), mantissa(18)) * self.step(word >> 27)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_survives_packing_to_a_five_hundredth_of_its_largest_channel() {
        for brightest in [1e-20f32, 1e-3, 1.0, 37.5, 65_000.0, 3e30] {
            let scale = LightScale::for_largest(brightest);
            for i in 0..2000u32 {
                let share =
                    |k: u32| (i.wrapping_mul(2_654_435_761).wrapping_add(k * 977) % 1009) as f32 / 1008.0;
                let fall = 2f32.powi(-((i % 20) as i32));
                let light = Vec3::new(share(1), share(2), share(3)) * brightest * fall;
                let error = (scale.unpack(scale.pack(light)) - light).abs().max_element();
                assert!(error <= light.max_element() / 512.0, "{light} of {brightest}: {error}");
            }
        }
    }

    #[test]
    fn no_exponent_before_the_first_would_do() {
        for brightest in [1e-38f32, 1e-20, 1.0, 65_000.0, 3e38] {
            let scale = LightScale::for_largest(brightest);
            for i in 0..40_000u32 {
                let largest = f32::from_bits(i.wrapping_mul(107_374) % f32::INFINITY.to_bits());
                let first = scale.first_exponent(largest);
                let does = |e: u32| (largest / scale.step(e)).round() <= LARGEST_MANTISSA;
                assert!((0..first).all(|e| !does(e)), "{largest:e} of {brightest:e}: {first}");
                assert!(first == LARGEST_EXPONENT as u32 || does(first) || does(first + 1), "{largest:e}");
            }
        }
    }

    #[test]
    fn no_light_packs_to_the_word_for_unlit() {
        let scale = LightScale::for_largest(1.0);
        for light in [Vec3::ONE, Vec3::splat(1e30), Vec3::splat(f32::INFINITY), Vec3::NAN, Vec3::NEG_ONE] {
            assert_ne!(scale.pack(light), UNLIT);
        }
        assert_eq!(scale.unpack(scale.pack(Vec3::ZERO)), Vec3::ZERO);
    }
}
