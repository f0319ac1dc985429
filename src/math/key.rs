//! Random numbers that are a function of what they are for: the same at any thread count and in any order.

/// A stream of random numbers named by a key. Two streams with different keys are independent for our purposes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key(u64);

impl Key {
    /// The key of one pixel of one image.
    pub fn of_pixel(seed: u64, pixel: u32) -> Self {
        Self(mix(seed ^ mix(u64::from(pixel) | 1 << 40)))
    }

    /// The key for one more dimension: a bounce, a light, a purpose.
    #[must_use]
    pub fn with(self, dimension: u32) -> Self {
        Self(mix(self.0 ^ (u64::from(dimension) << 32 | 0x9e37_79b9)))
    }

    /// The name itself: 64 random bits.
    pub fn bits(self) -> u64 {
        self.0
    }

    /// Two numbers in [0, 1).
    pub fn pair(self) -> [f32; 2] {
        let bits = mix(self.0);
        [unit_interval((bits >> 32) as u32), unit_interval(bits as u32)]
    }
}

/// Maps 32 random bits to [0, 1), keeping the 24 that an f32 can hold.
fn unit_interval(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// The finalizer of SplitMix64 (Steele, Lea, Flood 2014): a bijection on 64 bits that passes the usual tests.
fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
