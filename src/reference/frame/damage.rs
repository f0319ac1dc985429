//! Simulated memory corruption of a reference, for tests that its effect stays local.

use super::ReferenceFrame;
use crate::math::key::Key;

impl ReferenceFrame {
    /// Flips one random bit of disparity, triangle, light or bounce count in a random share (0..1)
    /// of the pixels. Returns the indices of these pixels. For robustness tests.
    pub fn flip_bits(&mut self, share: f32, seed: u64) -> Vec<u32> {
        let damaged: Vec<u32> = (0..self.view.pixel_count() as u32)
            .filter(|&pixel| Key::of_pixel(seed, pixel).pair()[0] < share)
            .collect();
        for &pixel in &damaged {
            let [which, bit] = Key::of_pixel(seed, pixel).with(1).pair();
            let (at, bit) = (pixel as usize, 1u32 << (bit * 32.0) as u32);
            match (which * 4.0) as u32 {
                0 => self.disparity[at] = f32::from_bits(self.disparity[at].to_bits() ^ bit),
                1 => self.triangle[at] ^= bit,
                2 => self.light[at] ^= bit,
                _ => self.reflections.iter_mut().skip(at).take(1).for_each(|count| *count ^= bit as u8),
            }
        }
        damaged
    }
}
