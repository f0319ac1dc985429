//! The function that hashes the parts of a scene.

use crate::math::key::mix;
use glam::{Vec2, Vec3};

/// Hash of the content of a part of a scene, 64 bits.
///
/// Among ten million different parts, two have the same hash with a probability of 3 in a million.
/// It is no protection against a file that was made to have a certain hash.
pub type ContentHash = u64;

/// Version of the hashed bytes. Any change of what is hashed, or how, needs a new number.
const VERSION: u64 = 1;

/// Odd factor that spreads the state before the next word is added: 2^64 over the golden ratio.
const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;

/// Hashes 64-bit words one after the other. For a given state, different words give different
/// states, because each step is a bijection.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContentHasher(u64);

impl ContentHasher {
    /// Starts the hash of a kind of part, given by its name, so that parts of different kinds have
    /// different hashes.
    pub(super) fn new(kind: &[u8; 8]) -> Self {
        let mut hasher = Self(mix(VERSION));
        hasher.word(u64::from_le_bytes(*kind));
        hasher
    }

    /// Adds a word.
    #[inline(always)]
    pub(super) fn word(&mut self, word: u64) {
        self.0 = mix(self.0.wrapping_mul(SPREAD) ^ word);
    }

    /// Adds a number by its bits. The two zeros are equal.
    #[inline(always)]
    pub(super) fn number(&mut self, number: f32) {
        self.word(u64::from((number + 0.0).to_bits()));
    }

    /// Adds two numbers.
    pub(super) fn pair(&mut self, pair: Vec2) {
        pair.to_array().into_iter().for_each(|number| self.number(number));
    }

    /// Adds three numbers.
    pub(super) fn triple(&mut self, triple: Vec3) {
        triple.to_array().into_iter().for_each(|number| self.number(number));
    }

    /// The hash of what was added so far.
    pub(super) fn finish(self) -> ContentHash {
        self.0
    }
}
