//! Random numbers as a function of a key: the same at any thread count and in any order of
//! evaluation.

/// Key of a random number. Numbers of different keys are independent for our purposes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key(u64);

impl Key {
    /// Creates the key of one pixel of one image.
    pub fn of_pixel(seed: u64, pixel: u32) -> Self {
        Self(mix(seed ^ mix(u64::from(pixel) | 1 << 40)))
    }

    /// Derives the key of one more dimension, such as a bounce, a light or a purpose.
    #[must_use]
    pub fn with(self, dimension: u32) -> Self {
        Self(mix(self.0 ^ (u64::from(dimension) << 32 | 0x9e37_79b9)))
    }

    /// Returns the key itself: 64 random bits.
    pub fn bits(self) -> u64 {
        self.0
    }

    /// Returns two random numbers in [0, 1).
    pub fn pair(self) -> [f32; 2] {
        let bits = mix(self.0);
        [unit_interval((bits >> 32) as u32), unit_interval(bits as u32)]
    }
}

/// Maps 32 random bits to [0, 1). Keeps the upper 24 bits, as many as an f32 can hold.
pub(super) fn unit_interval(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// The finalizer of SplitMix64 (Steele, Lea, Flood 2014): a bijection on 64 bits that passes the
/// usual tests.
pub(crate) fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
