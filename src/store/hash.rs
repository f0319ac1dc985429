//! Hashes of bytes and words: checksums of records, and identities of what a scene consists of.
//!
//! Not cryptographic: a checksum finds accidents, not forgeries. A change within one word of eight
//! bytes is always found, because every step maps different states to different states; any other
//! change goes unnoticed with a probability of 2^-64.

/// Odd multipliers of the four lanes: the digits of the golden ratio and of square roots.
const FACTORS: [u64; 4] =
    [0x9e37_79b9_7f4a_7c15, 0x6a09_e667_f3bc_c909, 0xbb67_ae85_84ca_a73b, 0x3c6e_f372_fe94_f82b];

/// Bytes that the four lanes take together.
const BLOCK: usize = 32;

/// Hashes a sequence of words of eight bytes.
#[derive(Clone, Debug)]
pub(crate) struct ContentHasher {
    lanes: [u64; 4],
    words: u64,
}

impl ContentHasher {
    /// Starts a hash; different purposes have different hashes of the same content.
    pub(crate) fn new(purpose: u64) -> Self {
        Self { lanes: FACTORS.map(|factor| purpose.wrapping_mul(factor) ^ factor), words: 0 }
    }

    /// Adds a word.
    #[inline(always)]
    pub(crate) fn word(&mut self, word: u64) {
        let lane = &mut self.lanes[(self.words & 3) as usize];
        *lane = (*lane ^ word).wrapping_mul(FACTORS[(self.words & 3) as usize]).rotate_left(29);
        self.words += 1;
    }

    /// Adds numbers of four bytes, each as a word.
    pub(crate) fn floats(&mut self, values: &[f32]) {
        values.iter().for_each(|value| self.word(value.to_bits().into()));
    }

    /// Adds bytes, with their number.
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.word(bytes.len() as u64);
        let (blocks, rest) = bytes.as_chunks::<BLOCK>();
        for block in blocks {
            block.as_chunks::<8>().0.iter().for_each(|word| self.word(u64::from_le_bytes(*word)));
        }
        for part in rest.chunks(8) {
            let mut word = [0; 8];
            word[..part.len()].copy_from_slice(part);
            self.word(u64::from_le_bytes(word));
        }
    }

    /// The hash in 64 bits.
    pub(crate) fn finish64(&self) -> u64 {
        self.lanes.iter().fold(self.words, |hash, lane| mix(hash ^ lane))
    }

    /// The hash in 128 bits.
    pub(crate) fn finish(&self) -> u128 {
        let low = self.finish64();
        let high = self.lanes.iter().rev().fold(!self.words, |hash, lane| mix(hash ^ lane.rotate_left(32)));
        u128::from(high) << 64 | u128::from(low)
    }
}

/// Maps words to words one to one, so that every bit depends on all.
///
/// Source: the finaliser of `SplitMix64` (Steele, Lea and Flood 2014).
fn mix(word: u64) -> u64 {
    let word = (word ^ word >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ word >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ word >> 31
}

/// Returns the checksum of bytes.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let mut hasher = ContentHasher::new(0);
    hasher.bytes(bytes);
    hasher.finish64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flipped_bit_changes_the_checksum() {
        for length in [1, 7, 8, 31, 32, 33, 100] {
            let mut bytes: Vec<u8> = (0..length).map(|i| (i * 37) as u8).collect();
            let right = checksum(&bytes);
            for bit in 0..8 * bytes.len() {
                bytes[bit / 8] ^= 1 << (bit % 8);
                assert_ne!(checksum(&bytes), right, "bit {bit} of {length} bytes");
                bytes[bit / 8] ^= 1 << (bit % 8);
            }
        }
    }

    #[test]
    fn zeros_of_different_lengths_have_different_checksums() {
        let sums: std::collections::BTreeSet<u64> = (0..100).map(|n| checksum(&vec![0; n])).collect();
        assert_eq!(sums.len(), 100);
    }
}
