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
