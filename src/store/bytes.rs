//! Explicit little-endian bytes. Reading trusts nothing: every length is checked against the bytes
//! that are there, before anything is allocated for it.

use glam::DVec3;

/// Bytes to be written.
#[derive(Debug, Default)]
pub(super) struct ByteWriter(pub(super) Vec<u8>);

impl ByteWriter {
    pub(super) fn u16(&mut self, value: u16) {
        self.0.extend(value.to_le_bytes());
    }

    pub(super) fn u32(&mut self, value: u32) {
        self.0.extend(value.to_le_bytes());
    }

    pub(super) fn u64(&mut self, value: u64) {
        self.0.extend(value.to_le_bytes());
    }

    pub(super) fn u128(&mut self, value: u128) {
        self.0.extend(value.to_le_bytes());
    }

    pub(super) fn f64(&mut self, value: f64) {
        self.u64(value.to_bits());
    }

    pub(super) fn point(&mut self, point: DVec3) {
        point.to_array().iter().for_each(|value| self.f64(*value));
    }

    /// Writes the lowest bytes of all words, then the second lowest, and so on: bytes of the same
    /// weight resemble each other, which the compression can use.
    pub(super) fn planes(&mut self, words: &[u32]) {
        for plane in 0..4 {
            self.0.extend(words.iter().map(|word| (word >> (8 * plane)) as u8));
        }
    }

    /// Writes one bit per value.
    pub(super) fn bits(&mut self, bits: &[bool]) {
        let byte = |bits: &[bool]| bits.iter().rev().fold(0, |byte, &bit| byte << 1 | u8::from(bit));
        self.0.extend(bits.chunks(8).map(byte));
    }
}

/// Bytes being read. Every method returns `None` where there are too few.
#[derive(Clone, Debug)]
pub(super) struct ByteReader<'b>(pub(super) &'b [u8]);

impl<'b> ByteReader<'b> {
    pub(super) fn take(&mut self, count: usize) -> Option<&'b [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn u128(&mut self) -> Option<u128> {
        self.array().map(u128::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Option<f64> {
        self.u64().map(f64::from_bits)
    }

    pub(super) fn point(&mut self) -> Option<DVec3> {
        Some(DVec3::new(self.f64()?, self.f64()?, self.f64()?))
    }

    /// Reads words that [`ByteWriter::planes`] has written.
    pub(super) fn planes(&mut self, count: usize) -> Option<Vec<u32>> {
        let bytes = self.take(count.checked_mul(4)?)?;
        let plane = |index: usize| &bytes[index * count..][..count];
        let [a, b, c, d] = [plane(0), plane(1), plane(2), plane(3)];
        Some((0..count).map(|i| u32::from_le_bytes([a[i], b[i], c[i], d[i]])).collect())
    }

    /// Reads values that [`ByteWriter::bits`] has written.
    pub(super) fn bits(&mut self, count: usize) -> Option<Vec<bool>> {
        let bytes = self.take(count.div_ceil(8))?;
        Some((0..count).map(|i| bytes[i / 8] >> (i % 8) & 1 == 1).collect())
    }
}

/// Reads a list with its length before it. The length is checked against the bytes that follow
/// before memory is allocated.
pub(super) fn list<'b, T>(
    from: &mut ByteReader<'b>,
    most: usize,
    bytes: usize,
    read: impl Fn(&mut ByteReader<'b>) -> Option<T>,
) -> Option<Vec<T>> {
    let count = from.u32()? as usize;
    (count <= most && count * bytes <= from.0.len()).then_some(())?;
    (0..count).map(|_| read(from)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_bits_are_read_as_they_were_written() {
        let words: Vec<u32> = (0..37u32).map(|i| i.wrapping_mul(0x9e37_79b9)).collect();
        let bits: Vec<bool> = words.iter().map(|word| word & 4 != 0).collect();
        let mut bytes = ByteWriter::default();
        bytes.planes(&words);
        bytes.bits(&bits);
        let mut reader = ByteReader(&bytes.0);
        assert_eq!(reader.planes(37), Some(words));
        assert_eq!(reader.bits(37), Some(bits));
        assert!(reader.0.is_empty());
    }

    #[test]
    fn what_is_not_there_is_not_read_however_long_it_claims_to_be() {
        let bytes = [0; 100];
        assert!(ByteReader(&bytes).planes(usize::MAX / 2).is_none());
        assert!(ByteReader(&bytes).planes(26).is_none());
        assert!(ByteReader(&bytes).bits(usize::MAX).is_none());
        assert!(ByteReader(&bytes[..7]).u64().is_none());
    }
}
