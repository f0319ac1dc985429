//! Rounding to integers without function calls. `f32::floor` and `f32::round` are calls where a
//! program is built for the baseline of its processor family.

/// Returns the largest integer not above `t`. Saturates; NaN gives 0.
#[inline(always)]
pub fn floor(t: f32) -> i32 {
    let toward_zero = t as i32;
    toward_zero.saturating_sub(i32::from(toward_zero as f32 > t))
}

/// Returns the integer nearest to `t`, halves away from zero. The largest f32 below a half rounds
/// to one.
#[inline(always)]
pub fn round(t: f32) -> i32 {
    (t + 0.5f32.copysign(t)) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_agree_with_the_standard_library() {
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
