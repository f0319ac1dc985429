//! Whole numbers near a number, without the calls that `f32::floor` and `f32::round` are where a program must run on any processor of
//! its kind.

/// The largest whole number not above `t`; saturates, and is 0 for what is not a number.
#[inline(always)]
pub fn floor(t: f32) -> i32 {
    let toward_zero = t as i32;
    toward_zero.saturating_sub(i32::from(toward_zero as f32 > t))
}

/// The whole number nearest to `t`, away from zero where two are. The number just below a half is taken for a half.
#[inline(always)]
pub fn round(t: f32) -> i32 {
    (t + 0.5f32.copysign(t)) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_those_of_the_standard_library() {
        for i in -4000i32..4000 {
            let t = i as f32 * 0.125 + 1e-3 * (i % 7) as f32;
            assert_eq!(floor(t), t.floor() as i32, "{t}");
            assert_eq!(round(t), t.round() as i32, "{t}");
        }
        for t in [1e30f32, -1e30, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, -0.0, 2_147_483_000.0] {
            assert_eq!(floor(t), t.floor() as i32, "{t}");
            assert_eq!(round(t), t.round() as i32, "{t}");
        }
    }
}
