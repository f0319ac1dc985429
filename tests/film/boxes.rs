//! A reader of the boxes of a film, written from the standard and not from the writer.

use std::ops::Range;

/// What the boxes of a film say.
pub(super) struct Boxes {
    pub(super) size: [u32; 2],
    pub(super) sizes: Vec<u32>,
    /// Numbers of the key frames, from 1.
    pub(super) keys: Vec<u32>,
    /// Offset in the file, and number of samples, of each chunk.
    pub(super) chunks: Vec<(usize, usize)>,
    /// Where the coded frames lie in the file.
    pub(super) data: Range<usize>,
    pub(super) sequence_header: Vec<u8>,
    pub(super) colour: [u8; 11],
    /// Units of time in a second, duration of a sample, and of everything in them.
    times: [u64; 3],
}

fn u16_at(bytes: &[u8], at: usize) -> u32 {
    u16::from_be_bytes(bytes[at..at + 2].try_into().unwrap()).into()
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_be_bytes(bytes[at..at + 8].try_into().unwrap())
}

/// The boxes in some bytes: names, and where their contents lie.
fn list(bytes: &[u8]) -> Vec<(String, Range<usize>)> {
    let (mut at, mut found) = (0, Vec::new());
    while at < bytes.len() {
        let name = String::from_utf8(bytes[at + 4..at + 8].to_vec()).unwrap();
        let (head, size) = match u32_at(bytes, at) {
            1 => (16, u64_at(bytes, at + 8) as usize),
            size => (8, size as usize),
        };
        assert!(size >= head && at + size <= bytes.len(), "{name} ends outside its parent");
        found.push((name, at + head..at + size));
        at += size;
    }
    found
}

/// The contents of the only box of a name.
fn only<'a>(bytes: &'a [u8], name: &str) -> &'a [u8] {
    let found: Vec<_> = list(bytes).into_iter().filter(|(found, _)| found == name).collect();
    assert_eq!(found.len(), 1, "{name}");
    &bytes[found[0].1.clone()]
}

/// The numbers of a table: version and flags, their count, and `columns` for each row.
fn table(bytes: &[u8], columns: usize) -> Vec<Vec<u32>> {
    let count = u32_at(bytes, 4) as usize;
    assert_eq!(bytes.len(), 8 + 4 * columns * count);
    (0..count).map(|row| (0..columns).map(|c| u32_at(bytes, 8 + 4 * (row * columns + c))).collect()).collect()
}

impl Boxes {
    pub(super) fn read(file: &[u8]) -> Self {
        let top = list(file);
        assert_eq!(top.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["ftyp", "mdat", "moov"]);
        let moov = only(file, "moov");
        let trak = only(moov, "trak");
        let mdia = only(trak, "mdia");
        let stbl = only(only(mdia, "minf"), "stbl");
        assert_eq!(&only(mdia, "hdlr")[8..12], b"vide");
        let av01 = only(&only(stbl, "stsd")[8..], "av01");
        let (fields, inner) = av01.split_at(78);
        let av1c = only(inner, "av1C");
        // Marker and version 1; then 8 bits and 4:2:0.
        assert_eq!((av1c[0], av1c[2] & 0xfc), (0x81, 0b1100));
        let stts = table(only(stbl, "stts"), 2);
        assert_eq!(stts.len(), 1, "all frames take the same time");
        let stsz = only(stbl, "stsz");
        let sizes: Vec<u32> = (0..u32_at(stsz, 8) as usize).map(|i| u32_at(stsz, 12 + 4 * i)).collect();
        assert_eq!((u32_at(stsz, 4), stts[0][0] as usize), (0, sizes.len()));
        let mdhd = only(mdia, "mdhd");
        assert_eq!(mdhd[0], 1, "times have 64 bits");
        assert_eq!(u64_at(only(moov, "mvhd"), 24), u64_at(mdhd, 24));
        let tkhd = only(trak, "tkhd");
        let size = [u16_at(fields, 24), u16_at(fields, 26)];
        assert_eq!([u32_at(tkhd, 88) >> 16, u32_at(tkhd, 92) >> 16], size);
        Self {
            size,
            sizes,
            keys: table(only(stbl, "stss"), 1).concat(),
            chunks: chunks(stbl),
            data: top[1].1.clone(),
            sequence_header: av1c[4..].to_vec(),
            colour: only(inner, "colr").try_into().unwrap(),
            times: [u32_at(mdhd, 20).into(), stts[0][1].into(), u64_at(mdhd, 24)],
        }
    }

    pub(super) fn frames(&self) -> usize {
        self.sizes.len()
    }

    pub(super) fn secs(&self) -> f64 {
        let [scale, sample, all] = self.times;
        assert_eq!(sample * self.frames() as u64, all);
        all as f64 / scale as f64
    }
}

fn chunks(stbl: &[u8]) -> Vec<(usize, usize)> {
    let co64 = only(stbl, "co64");
    let runs = table(only(stbl, "stsc"), 3);
    let count = u32_at(co64, 4) as usize;
    let samples = |chunk: u32| runs.iter().rev().find(|run| run[0] <= chunk).unwrap()[1] as usize;
    (0..count).map(|i| (u64_at(co64, 8 + 8 * i) as usize, samples(i as u32 + 1))).collect()
}
