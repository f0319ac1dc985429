//! RGB9E5: a colour in four bytes, three mantissas of 9 bits with a shared exponent of 5 bits.
//!
//! Source: the OpenGL extension `EXT_texture_shared_exponent`. We differ: [`Rgb9e5Scale`] has an
//! exponent bias of its own, so that any scene's brightest light fits, whatever its units. The
//! error is at most 2^-9 of the largest channel, a twentieth of the noise of sixteen shadow rays.

use glam::Vec3;

const MANTISSA_BITS: i32 = 9;
const MAX_MANTISSA: f32 = 511.0;
const MAX_EXPONENT: u32 = 31;

/// Exponent bias of a set of packed colours. Needed to pack and to unpack them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb9e5Scale {
    /// Added to the exponent of a packed word, this gives the exponent field of the f32 that is
    /// worth one step of the mantissa.
    pub exponent_offset: u32,
}

impl Rgb9e5Scale {
    /// Bias of the format as the GPU reads it (`Rgb9e5Ufloat`): colours from 2^-24 to 65408.
    pub const STANDARD: Self = Self { exponent_offset: 127 - 24 };

    /// Returns the scale with the finest steps that still holds `largest`, the largest channel of
    /// all colours.
    pub fn for_largest(largest: f32) -> Self {
        // largest <= 2^k; word exponent 31 means mantissas in units of 2^(k - 9).
        let k = if largest > 0.0 && largest.is_finite() { largest.log2().ceil() as i32 } else { 0 };
        let offset = k - MAX_EXPONENT as i32 - MANTISSA_BITS + 127;
        Self { exponent_offset: offset.clamp(1, 254 - MAX_EXPONENT as i32) as u32 }
    }

    /// Returns the value of one step of the mantissa for a word's exponent.
    fn step(self, exponent: u32) -> f32 {
        f32::from_bits((exponent + self.exponent_offset) << 23)
    }

    /// Returns the smallest exponent with which `largest` may fit: with the one below, it would be
    /// 512 steps or more.
    fn first_exponent(self, largest: f32) -> u32 {
        let power = (largest.to_bits() >> 23) as i32;
        (power - (MANTISSA_BITS - 1) - self.exponent_offset as i32).clamp(0, MAX_EXPONENT as i32) as u32
    }

    /// Packs a colour. Values above the range are clamped to it; negative channels and NaN become
    /// 0.
    pub fn pack(self, color: Vec3) -> u32 {
        self.pack_with(color, f32::round)
    }

    #[inline(always)]
    fn pack_with(self, color: Vec3, round: impl Fn(f32) -> f32) -> u32 {
        let color = color.max(Vec3::ZERO);
        let largest = color.max_element();
        if largest.is_nan() || largest <= 0.0 {
            return 0;
        }
        let mut exponent = self.first_exponent(largest);
        while exponent < MAX_EXPONENT && round(largest / self.step(exponent)) > MAX_MANTISSA {
            exponent += 1;
        }
        let mantissa = |x: f32| round(x / self.step(exponent)).clamp(0.0, MAX_MANTISSA) as u32;
        mantissa(color.x) | mantissa(color.y) << 9 | mantissa(color.z) << 18 | exponent << 27
    }

    /// Returns the colour of a packed word.
    #[inline(always)]
    pub fn unpack(self, word: u32) -> Vec3 {
        let mantissa = |shift: u32| ((word >> shift) & 0x1ff) as f32;
        Vec3::new(mantissa(0), mantissa(9), mantissa(18)) * self.step(word >> 27)
    }
}

/// Packs a colour in the standard format, for the GPU. Values above 65408 are clamped; negative
/// channels and NaN become 0.
///
/// Rounds by adding a half, without the call that `f32::round` is. The two differ for one mantissa,
/// the largest f32 below 0.5, which becomes 1 here and 0 in [`Rgb9e5Scale::pack`]. Both are kept so
/// that no picture changes.
pub fn pack(color: Vec3) -> u32 {
    Rgb9e5Scale::STANDARD.pack_with(color, |x| (x + 0.5).trunc())
}

/// Returns the colour of a word in the standard format.
pub fn unpack(word: u32) -> Vec3 {
    Rgb9e5Scale::STANDARD.unpack(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_color_survives_packing_to_a_512th_of_its_largest_channel() {
        for brightest in [1e-20f32, 1e-3, 1.0, 37.5, 65_000.0, 3e30] {
            let scale = Rgb9e5Scale::for_largest(brightest);
            for i in 0..2000u32 {
                let share =
                    |k: u32| (i.wrapping_mul(2_654_435_761).wrapping_add(k * 977) % 1009) as f32 / 1008.0;
                let fall = 2f32.powi(-((i % 20) as i32));
                let color = Vec3::new(share(1), share(2), share(3)) * brightest * fall;
                let error = (scale.unpack(scale.pack(color)) - color).abs().max_element();
                assert!(error <= color.max_element() / 512.0, "{color} of {brightest}: {error}");
            }
        }
    }

    #[test]
    fn no_exponent_below_the_first_fits() {
        for brightest in [1e-38f32, 1e-20, 1.0, 65_000.0, 3e38] {
            let scale = Rgb9e5Scale::for_largest(brightest);
            for i in 0..40_000u32 {
                let largest = f32::from_bits(i.wrapping_mul(107_374) % f32::INFINITY.to_bits());
                let first = scale.first_exponent(largest);
                let fits = |e: u32| (largest / scale.step(e)).round() <= MAX_MANTISSA;
                assert!((0..first).all(|e| !fits(e)), "{largest:e} of {brightest:e}: {first}");
                assert!(first == MAX_EXPONENT || fits(first) || fits(first + 1), "{largest:e}");
            }
        }
    }

    /// Packing as the format's specification has it, channel by channel.
    fn pack_by_the_specification(color: Vec3) -> u32 {
        let c = color.to_array().map(|v| if v.is_nan() { 0.0 } else { v.clamp(0.0, 65408.0) });
        let largest = c[0].max(c[1]).max(c[2]);
        let floor_log2 = ((largest.to_bits() >> 23) as i32 - 127).max(-16);
        let mut exponent = floor_log2 + 16;
        let scale = |exponent: i32| f32::from_bits(((127 + 24 - exponent) as u32) << 23);
        if (largest * scale(exponent) + 0.5) as u32 == 512 {
            exponent += 1;
        }
        let [r, g, b] = c.map(|v| (v * scale(exponent) + 0.5) as u32);
        r | g << 9 | b << 18 | (exponent as u32) << 27
    }

    #[test]
    fn the_standard_format_has_the_bits_of_its_specification() {
        let random = |i: u32, k: u32| i.wrapping_mul(2_654_435_761).wrapping_add(k.wrapping_mul(977_777_777));
        let channel = |i: u32, k: u32| f32::from_bits(random(i, k).rotate_left(k));
        let near_one = |i: u32, k: u32| (random(i, k) % 2048) as f32 / 1024.0;
        let below_half = 0.5 - f32::EPSILON / 4.0;
        let mut colors = vec![
            Vec3::ZERO,
            Vec3::new(-1.0, f32::NAN, 0.0),
            Vec3::new(2.0, f32::NAN, -1.0),
            Vec3::splat(f32::INFINITY),
            Vec3::splat(65408.0),
            Vec3::new(300.0, below_half, below_half) / 256.0,
        ];
        colors.extend((0..200_000).map(|i| Vec3::new(channel(i, 1), channel(i, 2), channel(i, 3))));
        colors.extend((0..20_000).map(|i| Vec3::new(near_one(i, 1), near_one(i, 2), near_one(i, 3))));
        for color in colors {
            assert_eq!(pack(color), pack_by_the_specification(color), "{color:?}");
        }
        assert_eq!(unpack(pack(Vec3::splat(f32::INFINITY))), Vec3::splat(65408.0));
    }

    #[test]
    fn the_two_roundings_differ_just_below_a_half() {
        let color = Vec3::new(300.0, 0.5 - f32::EPSILON / 4.0, 0.0);
        let scale = Rgb9e5Scale { exponent_offset: 127 };
        assert_eq!(
            (scale.pack(color) >> 9 & 511, scale.pack_with(color, |x| (x + 0.5).trunc()) >> 9 & 511),
            (0, 1)
        );
    }
}
