//! The set bits of a mask.

/// Iterates over the indices of the set bits, lowest first.
pub(in crate::trace) struct Bits(pub(in crate::trace) u32);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}
