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

    /// Returns the largest value of a channel.
    pub fn largest(self) -> f32 {
        MAX_MANTISSA * self.step(MAX_EXPONENT)
    }

    /// Packs a colour that is not negative, as a sum of colours is. Differs from [`Self::pack`] in
    /// the rounding of some halves, and takes a quarter of the time.
    #[inline(always)]
    pub fn pack_sum(self, color: Vec3) -> u32 {
        let largest = color.max_element().min(f32::MAX);
        let first = self.first_exponent(largest);
        let is_full = largest / self.step(first) + 0.5 >= MAX_MANTISSA + 1.0;
        let exponent = (first + u32::from(is_full)).min(MAX_EXPONENT);
        // A step is a power of two.
        let color = color * (1.0 / self.step(exponent)) + 0.5;
        let mantissa = |x: f32| x.min(MAX_MANTISSA) as u32;
        mantissa(color.x) | mantissa(color.y) << 9 | mantissa(color.z) << 18 | exponent << 27
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
