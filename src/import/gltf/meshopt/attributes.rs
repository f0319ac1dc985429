//! Mode 0: elements as differences from the element before, stored byte by byte.

use super::bytes::{Bytes, unzigzag};

/// Number of elements of a group.
const GROUP: usize = 16;

/// Bits per difference by the code of a group, for the two control modes of version 1 that store
/// groups, and for version 0.
const BITS_LOW: [u32; 4] = [0, 1, 2, 4];
const BITS_HIGH: [u32; 4] = [1, 2, 4, 8];
const BITS_OLD: [u32; 4] = [0, 2, 4, 8];

/// How the four bytes of a channel follow from those of the element before.
#[derive(Clone, Copy, Debug)]
enum Channel {
    Bytes,
    Words,
    Xor { rotate: u32 },
}

impl Channel {
    fn of(code: u8) -> Option<Self> {
        match (code & 0xF, code >> 4) {
            (0, 0) => Some(Self::Bytes),
            (1, 0) => Some(Self::Words),
            (2, rotate) => Some(Self::Xor { rotate: rotate.into() }),
            _ => None,
        }
    }

    fn next(self, previous: [u8; 4], delta: [u8; 4]) -> [u8; 4] {
        match self {
            Self::Bytes => {
                let byte = |i: usize| previous[i].wrapping_add(unzigzag(delta[i].into()) as u8);
                [byte(0), byte(1), byte(2), byte(3)]
            }
            Self::Words => {
                let word = |of: [u8; 4], i: usize| u16::from_le_bytes([of[i], of[i + 1]]);
                let next = |i| word(previous, i).wrapping_add(unzigzag(word(delta, i).into()) as u16);
                let ([a, b], [c, d]) = (next(0).to_le_bytes(), next(2).to_le_bytes());
                [a, b, c, d]
            }
            Self::Xor { rotate } => {
                // The text gives the rotation of the encoder, which is to the left.
                let delta = u32::from_le_bytes(delta).rotate_right(rotate);
                (u32::from_le_bytes(previous) ^ delta).to_le_bytes()
            }
        }
    }
}

/// Decodes `count` elements of `stride` bytes. The result grows with what has been decoded.
pub(super) fn decode(data: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (header, data) = data.split_first()?;
    let (is_new, tail, tail_at_least) = match header {
        0xA0 => (false, stride, 32),
        0xA1 => (true, stride + stride / 4, 24),
        _ => return None,
    };
    let (body, tail_block) = data.split_at_checked(data.len().checked_sub(tail.max(tail_at_least))?)?;
    let (baseline, modes) = tail_block[tail_block.len() - tail..].split_at(stride);
    let channels: Vec<Channel> = match is_new {
        true => modes.iter().map(|mode| Channel::of(*mode)).collect::<Option<_>>()?,
        false => vec![Channel::Bytes; stride / 4],
    };
    let mut decoder = Decoder { bytes: Bytes(body), is_new, stride, previous: baseline.to_vec() };
    let mut decoded = Vec::new();
    let mut left = count;
    while left > 0 {
        let block = left.min(256).min((8192 / stride) & !(GROUP - 1));
        decoder.block(block, &channels, &mut decoded)?;
        left -= block;
    }
    decoder.bytes.0.is_empty().then_some(decoded)
}

struct Decoder<'a> {
    bytes: Bytes<'a>,
    /// Version 1.
    is_new: bool,
    stride: usize,
    previous: Vec<u8>,
}

impl Decoder<'_> {
    /// Decodes a block of elements.
    fn block(&mut self, elements: usize, channels: &[Channel], decoded: &mut Vec<u8>) -> Option<()> {
        let aligned = elements.next_multiple_of(GROUP);
        let controls = if self.is_new { self.bytes.take(self.stride / 4)? } else { &[] };
        let mut deltas = vec![0; aligned * self.stride];
        for (i, deltas) in deltas.chunks_exact_mut(aligned).enumerate() {
            match controls.get(i / 4).map(|control| (control >> (i % 4 * 2)) & 3) {
                None => self.groups(BITS_OLD, deltas)?,
                Some(0) => self.groups(BITS_LOW, deltas)?,
                Some(1) => self.groups(BITS_HIGH, deltas)?,
                Some(2) => {}
                Some(_) => deltas[..elements].copy_from_slice(self.bytes.take(elements)?),
            }
        }
        decoded.try_reserve(elements * self.stride).ok()?;
        for element in 0..elements {
            for (i, channel) in channels.iter().enumerate() {
                let four = &mut self.previous[i * 4..i * 4 + 4];
                let delta = [0, 1, 2, 3].map(|byte| deltas[(i * 4 + byte) * aligned + element]);
                four.copy_from_slice(&channel.next([four[0], four[1], four[2], four[3]], delta));
            }
            decoded.extend_from_slice(&self.previous);
        }
        Some(())
    }

    /// Reads the differences of one byte of all elements of a block.
    fn groups(&mut self, bits: [u32; 4], deltas: &mut [u8]) -> Option<()> {
        let codes = self.bytes.take((deltas.len() / GROUP).div_ceil(4))?;
        for (i, group) in deltas.chunks_exact_mut(GROUP).enumerate() {
            let code = (codes[i / 4] >> (i % 4 * 2)) & 3;
            match bits[usize::from(code)] {
                0 => {}
                8 => group.copy_from_slice(self.bytes.take(GROUP)?),
                bits => self.packed(bits, group)?,
            }
        }
        Some(())
    }

    /// Reads a group of differences of few bits. One whose bits are all set follows as a byte.
    fn packed(&mut self, bits: u32, group: &mut [u8]) -> Option<()> {
        let packed = self.bytes.take(GROUP * bits as usize / 8)?;
        let (per_byte, sentinel) = (8 / bits as usize, (1u8 << bits) - 1);
        for (i, delta) in group.iter_mut().enumerate() {
            let place = (i % per_byte) as u32 * bits;
            // Single bits begin with the lowest, others with the highest.
            let shift = if bits == 1 { place } else { 8 - bits - place };
            let short = (packed[i / per_byte] >> shift) & sentinel;
            *delta = if short == sentinel { self.bytes.byte()? } else { short };
        }
        Some(())
    }
}
