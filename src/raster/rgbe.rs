//! RGBE: a colour in four bytes, three mantissas of 8 bits with a shared exponent of 8 bits.
//!
//! Source: Ward, "Real Pixels", Graphics Gems II, 1991. It holds any scale, with an error of at
//! most 2^-8 of the largest channel. We differ: one word is set aside for "no colour".

use glam::Vec3;

/// The word of no colour.
pub const NONE: u32 = u32::MAX;

/// Packs a colour. Negative channels and NaN become 0; [`NONE`] is never returned.
pub fn pack(color: Vec3) -> u32 {
    let color = color.max(Vec3::ZERO).min(Vec3::splat(f32::MAX / 4.0));
    let largest = color.max_element();
    let field = largest.to_bits() >> 23;
    if largest.is_nan() || field < 8 {
        return 0;
    }
    // The largest channel lies below two to the power of `field - 126`. Rounding up to 256 would
    // need one more.
    let exponent = if largest * power(134 - field as i32) >= 255.5 { field + 1 } else { field };
    let scale = power(134 - exponent as i32);
    let mantissa = |x: f32| (x * scale).round().min(255.0) as u32;
    mantissa(color.x) | mantissa(color.y) << 8 | mantissa(color.z) << 16 | exponent << 24
}

/// Returns the colour of a word; `None` for [`NONE`].
pub fn unpack(word: u32) -> Option<Vec3> {
    if word == NONE {
        return None;
    }
    let mantissa = |shift: u32| (word >> shift & 0xff) as f32;
    let step = power((word >> 24) as i32 - 134);
    Some(Vec3::new(mantissa(0), mantissa(8), mantissa(16)) * step)
}

/// Two to the power of an exponent, within the range of normal numbers.
fn power(exponent: i32) -> f32 {
    f32::from_bits(((exponent.clamp(-126, 127) + 127) as u32) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_any_scale_come_back_within_a_256th_of_the_largest_channel() {
        for exponent in -110..120 {
            for i in 0..64 {
                let scale = 2f32.powi(exponent);
                let color = Vec3::new(1.0 + i as f32 / 64.0, 0.3 * i as f32 / 64.0, 0.999) * scale;
                let back = unpack(pack(color)).unwrap();
                let error = (back - color).abs().max_element() / color.max_element();
                assert!(error <= 1.001 / 256.0, "{color} came back as {back}");
            }
        }
        assert_eq!(unpack(pack(Vec3::ZERO)), Some(Vec3::ZERO));
        assert!(unpack(pack(Vec3::splat(f32::MAX))).unwrap().is_finite());
        assert_eq!(unpack(NONE), None);
    }
}
