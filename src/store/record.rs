//! A record as bytes: header, summary, compressed payload.
//!
//! The header names the lengths of what follows and has a checksum of its own, so a scan finds the
//! next record without reading this one.

use super::bytes::{ByteReader, ByteWriter};
use super::hash::checksum;

/// Version of the format of records. A change of the format, or of what stored light means, needs
/// a new number.
pub(super) const VERSION: u16 = 2;

/// First bytes of a record.
pub(super) const MAGIC: [u8; 4] = *b"AREC";

/// Bytes of a header.
pub(super) const HEADER_BYTES: usize = 64;

/// Kind of a record that holds a reference image.
pub(super) const REFERENCE: u16 = 1;

/// Largest summary that is read, bytes.
const MAX_SUMMARY: u32 = 4 << 20;

/// Largest payload that is read, bytes, compressed and inflated.
const MAX_PAYLOAD: u64 = 1 << 30;

/// LZ4 inflates to at most 255 times the size.
const MAX_RATIO: u64 = 255;

/// The header of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RecordHeader {
    pub(super) version: u16,
    pub(super) kind: u16,
    pub(super) summary_bytes: u32,
    /// Bytes of the payload in the file.
    pub(super) payload_bytes: u64,
    /// Bytes of the payload once it is inflated.
    pub(super) inflated_bytes: u64,
    pub(super) summary_checksum: u64,
    pub(super) payload_checksum: u64,
    /// Time of writing, seconds since 1970.
    pub(super) written_at: u64,
}

impl RecordHeader {
    fn write(&self, to: &mut ByteWriter) {
        let start = to.0.len();
        to.0.extend(MAGIC);
        to.u16(self.version);
        to.u16(self.kind);
        to.u32(self.summary_bytes);
        to.u32(0);
        to.u64(self.payload_bytes);
        to.u64(self.inflated_bytes);
        to.u64(self.summary_checksum);
        to.u64(self.payload_checksum);
        to.u64(self.written_at);
        to.u64(checksum(&to.0[start..]));
    }

    /// Reads a header. `None` where the bytes are none, or name lengths that no record has.
    pub(super) fn read(bytes: &[u8; HEADER_BYTES]) -> Option<Self> {
        let mut from = ByteReader(bytes);
        (from.take(4)? == MAGIC).then_some(())?;
        let (version, kind, summary_bytes) = (from.u16()?, from.u16()?, from.u32()?);
        from.u32()?;
        let header = Self {
            version,
            kind,
            summary_bytes,
            payload_bytes: from.u64()?,
            inflated_bytes: from.u64()?,
            summary_checksum: from.u64()?,
            payload_checksum: from.u64()?,
            written_at: from.u64()?,
        };
        (from.u64()? == checksum(&bytes[..HEADER_BYTES - 8]) && header.is_sound()).then_some(header)
    }

    fn is_sound(&self) -> bool {
        let is_small = self.summary_bytes <= MAX_SUMMARY && self.payload_bytes <= MAX_PAYLOAD;
        is_small && self.inflated_bytes <= MAX_PAYLOAD.min(self.payload_bytes * MAX_RATIO)
    }

    /// Bytes of the whole record.
    pub(super) fn record_bytes(&self) -> u64 {
        HEADER_BYTES as u64 + u64::from(self.summary_bytes) + self.payload_bytes
    }

    /// Identity of what the record holds.
    pub(super) fn identity(&self) -> (u64, u64, u64) {
        (self.summary_checksum, self.payload_checksum, self.inflated_bytes)
    }
}

/// Makes the bytes of a record of a reference. `None` where it is larger than what is read.
pub(super) fn write_record(summary: &[u8], payload: &[u8], written_at: u64) -> Option<Vec<u8>> {
    let packed = lz4_flex::block::compress(payload);
    let header = RecordHeader {
        version: VERSION,
        kind: REFERENCE,
        summary_bytes: u32::try_from(summary.len()).ok()?,
        payload_bytes: packed.len() as u64,
        inflated_bytes: payload.len() as u64,
        summary_checksum: checksum(summary),
        payload_checksum: checksum(&packed),
        written_at,
    };
    header.is_sound().then_some(())?;
    let mut to = ByteWriter(Vec::with_capacity(HEADER_BYTES + summary.len() + packed.len()));
    header.write(&mut to);
    to.0.extend_from_slice(summary);
    to.0.extend_from_slice(&packed);
    Some(to.0)
}

/// Inflates a payload whose bytes were read from a file. `None` where they were damaged.
pub(super) fn inflate(header: &RecordHeader, packed: &[u8]) -> Option<Vec<u8>> {
    (checksum(packed) == header.payload_checksum).then_some(())?;
    let size = usize::try_from(header.inflated_bytes).ok()?;
    let mut payload = vec![0; size];
    let written = lz4_flex::block::decompress_into(packed, &mut payload).ok()?;
    (written == size).then_some(payload)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header_of(record: &[u8]) -> RecordHeader {
        RecordHeader::read(record[..HEADER_BYTES].first_chunk().unwrap()).unwrap()
    }

    #[test]
    fn a_payload_is_inflated_to_its_own_bytes() {
        let payload: Vec<u8> = (0..10_000u32).map(|i| (i * i / 1000) as u8).collect();
        let record = write_record(b"summary", &payload, 5).unwrap();
        let header = header_of(&record);
        assert_eq!(header.record_bytes(), record.len() as u64);
        assert_eq!(inflate(&header, &record[HEADER_BYTES + 7..]), Some(payload));
        let empty = write_record(b"", b"", 5).unwrap();
        assert_eq!(inflate(&header_of(&empty), &empty[HEADER_BYTES..]), Some(Vec::new()));
    }

    #[test]
    fn hostile_lengths_are_refused_before_anything_is_allocated() {
        let record = write_record(b"summary", &[7; 1000], 5).unwrap();
        let header = header_of(&record);
        for length in [1 << 63, u64::MAX, MAX_PAYLOAD + 1, header.payload_bytes * MAX_RATIO + 1] {
            for hostile in [
                RecordHeader { inflated_bytes: length, ..header },
                RecordHeader { payload_bytes: length.max(MAX_PAYLOAD + 1), ..header },
                RecordHeader { summary_bytes: u32::MAX, ..header },
            ] {
                let mut bytes = ByteWriter::default();
                hostile.write(&mut bytes);
                assert_eq!(RecordHeader::read(bytes.0.first_chunk().unwrap()), None, "{length}");
            }
        }
        // A length within the limits that is not the right one.
        let wrong = RecordHeader { inflated_bytes: 999, ..header };
        assert_eq!(inflate(&wrong, &record[HEADER_BYTES + 7..]), None);
    }
}
