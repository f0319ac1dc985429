//! Which pixels a reference of a plan lights, kept at the coarse size of the plan.

use crate::math::key::Key;

/// Most pixels of a coarse picture: 320 by 180.
const MAX_PIXELS: u64 = 320 * 180;

/// The coarse size of a plan for references of a size, and how many pixels one of its pixels is
/// wide.
pub(super) fn coarse_size(size: [u32; 2]) -> ([u32; 2], u32) {
    let coarse = |step: u32| size.map(|edge| edge.div_ceil(step).max(2));
    let fits = |step: &u32| coarse(*step).map(u64::from).iter().product::<u64>() <= MAX_PIXELS;
    let step = (1..=u32::from(u16::MAX)).find(fits).unwrap_or(1);
    (coarse(step), step)
}

/// A set of pixels of a coarse picture, one bit each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PixelMask {
    size: [u32; 2],
    words: Vec<u64>,
}

impl PixelMask {
    /// A set of listed pixels.
    pub(super) fn of(pixels: &[u32], size: [u32; 2]) -> Self {
        let count = size[0] as usize * size[1] as usize;
        let mut words = vec![0; count.div_ceil(64)];
        for &pixel in pixels {
            words[pixel as usize / 64] |= 1 << (pixel % 64);
        }
        Self { size, words }
    }

    /// Number of pixels.
    pub(super) fn count(&self) -> u64 {
        self.words.iter().map(|word| u64::from(word.count_ones())).sum()
    }

    /// The share of the picture, 0..1.
    pub(super) fn share(&self) -> f64 {
        self.count() as f64 / self.size.map(f64::from).iter().product::<f64>()
    }

    fn has(&self, x: i64, y: i64) -> bool {
        let [width, height] = self.size.map(i64::from);
        let at = (y * width + x) as usize;
        x >= 0 && y >= 0 && x < width && y < height && self.words[at / 64] >> (at % 64) & 1 == 1
    }

    /// True where a place of the picture, as shares of width and height, belongs to the set: to one
    /// of its pixels, or to one whose centre is less than `reach` pixels away along both axes.
    ///
    /// The border of what earlier references light lies somewhere between two centres. With a reach
    /// of one, the pixels on both sides are lit up to the other centre.
    pub(super) fn covers(&self, [x, y]: [f64; 2], reach: f64) -> bool {
        let [x, y] = [x * f64::from(self.size[0]) - 0.5, y * f64::from(self.size[1]) - 0.5];
        let near = |at: f64| {
            let (first, last) = ((at - reach).floor() as i64 + 1, (at + reach).ceil() as i64 - 1);
            first..=last
        };
        near(y).any(|row| near(x).any(|column| self.has(column, row)))
    }

    /// 64 random bits of the set.
    pub(super) fn hash(&self) -> u64 {
        let word = |key: Key, word: &u64| key.with(*word as u32).with((*word >> 32) as u32);
        self.words.iter().fold(Key::of_pixel(u64::from(self.size[0]), self.size[1]), word).bits()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mask_covers_its_pixels_and_what_lies_between_them_and_the_next() {
        let mask = PixelMask::of(&[5, 6], [4, 3]); // columns 1 and 2 of row 1
        assert_eq!(mask.count(), 2);
        let at = |x: f64, y: f64| mask.covers([x / 4.0, y / 3.0], 1.0);
        assert!(at(1.5, 1.5) && at(2.5, 1.5) && at(2.0, 1.01));
        assert!(at(0.6, 1.5) && !at(0.5, 1.5) && !at(3.5, 1.5) && at(3.4, 2.4) && !at(2.5, 2.5));
    }

    #[test]
    fn coarse_pictures_have_the_shape_of_large_ones() {
        assert_eq!(coarse_size([1280, 720]), ([320, 180], 4));
        assert_eq!(coarse_size([640, 360]), ([320, 180], 2));
        assert_eq!(coarse_size([64, 48]), ([64, 48], 1));
        assert_eq!(coarse_size([1, 1]), ([2, 2], 1));
        let ([width, height], _) = coarse_size([8192, 4096]);
        assert!(width * height <= 57_600 && width == 2 * height);
    }
}
