//! The container of a film: an MP4 file with one track of AV1.
//!
//! The samples are written as they come, in one `mdat`; what says where they are, `moov`, follows
//! when the file is closed. Source: ISO/IEC 14496-12 (boxes) and "AV1 Codec ISO Media File Format
//! Binding" (`av01`, `av1C`).

use super::settings::FilmSettings;
use std::fs::File;
use std::io::{Seek, SeekFrom, Write};

/// Units of time in a second for each frame in a second: players expect finer units than frames.
const UNITS_PER_FRAME: u32 = 1000;

/// Length in bytes of the header of `mdat`, whose size has 64 bits.
const MDAT_HEADER: u64 = 16;

/// Samples of a film from one key frame to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Group {
    /// Coded frames in the order of display, each without its temporal delimiter. The first is a
    /// key frame.
    pub(super) samples: Vec<Vec<u8>>,
}

/// Where a group lies in the file.
#[derive(Debug)]
struct Chunk {
    offset: u64,
    sizes: Vec<u32>,
}

/// A file that is being written.
#[derive(Debug)]
pub(super) struct Mp4 {
    file: File,
    settings: FilmSettings,
    mdat: u64,
    end: u64,
    chunks: Vec<Chunk>,
    /// The sequence header of the first key frame, as an OBU.
    sequence_header: Vec<u8>,
}

impl Mp4 {
    /// Begins a file.
    pub(super) fn begin(mut file: File, settings: FilmSettings) -> std::io::Result<Self> {
        let brands = [&b"isom"[..], &512_u32.to_be_bytes(), b"isomiso2av01mp41"].concat();
        let head = atom(b"ftyp", &brands);
        file.write_all(&head)?;
        file.write_all(&mdat_header(MDAT_HEADER))?;
        let mdat = head.len() as u64;
        Ok(Self {
            file,
            settings,
            mdat,
            end: mdat + MDAT_HEADER,
            chunks: Vec::new(),
            sequence_header: Vec::new(),
        })
    }

    /// Number of frames in the file.
    pub(super) fn frames(&self) -> u32 {
        self.chunks.iter().map(|chunk| chunk.sizes.len() as u32).sum()
    }

    /// Appends a group. If it cannot be written, the file holds what it held before.
    pub(super) fn append(&mut self, group: &Group) -> std::io::Result<()> {
        if self.sequence_header.is_empty() {
            let first = group.samples.first();
            self.sequence_header = first.and_then(|sample| sequence_header(sample)).unwrap_or_default();
        }
        let bytes = group.samples.concat();
        if let Err(error) = self.file.write_all(&bytes) {
            self.cut()?;
            return Err(error);
        }
        let sizes = group.samples.iter().map(|sample| sample.len() as u32).collect();
        self.chunks.push(Chunk { offset: self.end, sizes });
        self.end += bytes.len() as u64;
        Ok(())
    }

    /// Cuts the file behind the last whole group.
    fn cut(&mut self) -> std::io::Result<()> {
        self.file.set_len(self.end)?;
        self.file.seek(SeekFrom::Start(self.end)).map(drop)
    }

    /// Closes the file and returns the number of its frames. Where the disk is full, groups at the
    /// end make room for what must be written last; then the first error is returned as well.
    pub(super) fn finish(mut self) -> std::io::Result<(u32, Option<std::io::Error>)> {
        let mut problem = None;
        while let Err(error) = self.close() {
            let dropped = self.chunks.pop().filter(|_| !self.chunks.is_empty());
            let Some(dropped) = dropped else { return Err(error) };
            self.end = dropped.offset;
            self.cut()?;
            problem.get_or_insert(error);
        }
        Ok((self.frames(), problem))
    }

    fn close(&mut self) -> std::io::Result<()> {
        self.cut()?;
        self.file.write_all(&self.moov())?;
        self.file.seek(SeekFrom::Start(self.mdat))?;
        self.file.write_all(&mdat_header(self.end - self.mdat))
    }

    fn moov(&self) -> Vec<u8> {
        let duration = u64::from(self.frames()) * u64::from(UNITS_PER_FRAME);
        let stbl = atom(b"stbl", &self.sample_tables());
        let dinf = atom(b"dinf", &full(b"dref", 0, &[&be(1), &full(b"url ", 1, &[])]));
        let minf = atom(b"minf", &[full(b"vmhd", 1, &[&[0; 8]]), dinf, stbl].concat());
        let handler: [&[u8]; 4] = [&[0; 4], b"vide", &[0; 12], b"Film\0"];
        let mdia = atom(
            b"mdia",
            &[
                full(b"mdhd", 1 << 24, &[&self.times(duration), &be(0x55c4_0000)]),
                full(b"hdlr", 0, &handler),
                minf,
            ]
            .concat(),
        );
        let trak = atom(b"trak", &[self.tkhd(duration), mdia].concat());
        // Speed 1, volume 1, ten bytes without meaning, the unit matrix, 24 bytes of zeros, and the
        // number of the next track.
        let speed = [&be(0x1_0000)[..], &be(0x0100_0000), &[0; 8]].concat();
        let mvhd: [&[u8]; 5] = [&self.times(duration), &speed, &unit_matrix(), &[0; 24], &be(2)];
        atom(b"moov", &[full(b"mvhd", 1 << 24, &mvhd), trak].concat())
    }

    /// Times of creation and change (unknown), units in a second, and a duration in them.
    fn times(&self, duration: u64) -> Vec<u8> {
        [&[0; 16][..], &be(self.settings.rate * UNITS_PER_FRAME), &duration.to_be_bytes()].concat()
    }

    fn tkhd(&self, duration: u64) -> Vec<u8> {
        // Times, the number of the track, and its duration; then layer, group and volume.
        let head = [&[0; 16][..], &be(1), &[0; 4], &duration.to_be_bytes(), &[0; 16]].concat();
        let [width, height] = self.settings.size.map(|side| be(side << 16));
        // Enabled, in the movie.
        full(b"tkhd", 1 << 24 | 3, &[&head, &unit_matrix(), &width, &height])
    }

    fn sample_tables(&self) -> Vec<u8> {
        let frames = self.frames();
        let numbers = |numbers: &mut dyn Iterator<Item = u32>| numbers.flat_map(u32::to_be_bytes).collect();
        let sizes: Vec<u8> = numbers(&mut self.chunks.iter().flat_map(|chunk| chunk.sizes.iter().copied()));
        let mut first = 1;
        let keys: Vec<u8> = numbers(&mut self.chunks.iter().map(|chunk| {
            let key = first;
            first += chunk.sizes.len() as u32;
            key
        }));
        // The first chunk with a number of samples, that number, and the description of them.
        let runs: Vec<[u32; 3]> = (1..)
            .zip(&self.chunks)
            .map(|(number, chunk)| [number, chunk.sizes.len() as u32, 1])
            .fold(Vec::new(), |mut runs: Vec<[u32; 3]>, run| {
                if runs.last().is_none_or(|last| last[1] != run[1]) {
                    runs.push(run);
                }
                runs
            });
        let run_bytes: Vec<u8> = numbers(&mut runs.as_flattened().iter().copied());
        let offsets: Vec<u8> = self.chunks.iter().flat_map(|chunk| chunk.offset.to_be_bytes()).collect();
        let chunks = be(self.chunks.len() as u32);
        [
            full(b"stsd", 0, &[&be(1), &self.av01()]),
            full(b"stts", 0, &[&be(1), &be(frames), &be(UNITS_PER_FRAME)]),
            full(b"stss", 0, &[&chunks, &keys]),
            full(b"stsc", 0, &[&be(runs.len() as u32), &run_bytes]),
            full(b"stsz", 0, &[&be(0), &be(frames), &sizes]),
            full(b"co64", 0, &[&chunks, &offsets]),
        ]
        .concat()
    }

    /// The description of the samples: size, decoder and colour.
    fn av01(&self) -> Vec<u8> {
        let [width, height] = self.settings.size.map(|side| (side as u16).to_be_bytes());
        let dots_per_inch = be(72 << 16);
        let mut name = [0; 32];
        name[..11].copy_from_slice(b"\x0aafterimage");
        let head: [&[u8]; 11] = [
            &[0, 0, 0, 0, 0, 0, 0, 1],
            &[0; 16],
            &width,
            &height,
            &dots_per_inch,
            &dots_per_inch,
            &[0, 0, 0, 0, 0, 1],
            &name,
            &[0, 24, 0xff, 0xff],
            &self.av1c(),
            // Primaries, transfer and matrix of BT.709, in limited range.
            &atom(b"colr", b"nclx\x00\x01\x00\x01\x00\x01\x00"),
        ];
        atom(b"av01", &head.concat())
    }

    /// What a decoder must be able to do: profile 0, the level, 8 bits, 4:2:0 with chroma at the
    /// place of luma in rows; and the sequence header.
    fn av1c(&self) -> Vec<u8> {
        const CHROMA_420_VERTICAL: u8 = 0b1101;
        let head = [0x81, self.settings.level(), CHROMA_420_VERTICAL, 0];
        atom(b"av1C", &[&head[..], &self.sequence_header].concat())
    }
}

/// The header of an `mdat` of a size in bytes.
fn mdat_header(size: u64) -> Vec<u8> {
    [&be(1)[..], b"mdat", &size.to_be_bytes()].concat()
}

fn be(number: u32) -> [u8; 4] {
    number.to_be_bytes()
}

fn atom(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    [&be(content.len() as u32 + 8)[..], name, content].concat()
}

/// A box with a version and flags.
fn full(name: &[u8; 4], version_and_flags: u32, content: &[&[u8]]) -> Vec<u8> {
    atom(name, &[&be(version_and_flags)[..], &content.concat()].concat())
}

fn unit_matrix() -> Vec<u8> {
    [0x1_0000, 0, 0, 0, 0x1_0000, 0, 0, 0, 0x4000_0000].into_iter().flat_map(u32::to_be_bytes).collect()
}

/// Type of an OBU that separates frames, which an MP4 file leaves out.
const TEMPORAL_DELIMITER: u8 = 2;
const SEQUENCE_HEADER: u8 = 1;

/// The parts (OBUs) of a coded frame: type and bytes. Ends where the bytes are not those of AV1.
fn parts(mut bytes: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
    std::iter::from_fn(move || {
        let head = *bytes.first()?;
        let (has_extension, has_size) = (head & 4 != 0, head & 2 != 0);
        let mut at = 1 + usize::from(has_extension);
        let mut size = if has_size { 0 } else { bytes.len().checked_sub(at)? };
        for shift in (0..8).map(|byte| 7 * byte).take_while(|_| has_size) {
            let byte = *bytes.get(at)?;
            (at, size) = (at + 1, size | usize::from(byte & 0x7f) << shift);
            if byte & 0x80 == 0 {
                break;
            }
        }
        let (part, rest) = bytes.split_at_checked(at.checked_add(size)?)?;
        bytes = rest;
        Some((head >> 3 & 15, part))
    })
}

/// The bytes of a coded frame as an MP4 file holds them.
pub(super) fn sample(packet: &[u8]) -> Vec<u8> {
    let kept = parts(packet).filter(|(kind, _)| *kind != TEMPORAL_DELIMITER);
    kept.flat_map(|(_, bytes)| bytes).copied().collect()
}

fn sequence_header(sample: &[u8]) -> Option<Vec<u8>> {
    parts(sample).find(|(kind, _)| *kind == SEQUENCE_HEADER).map(|(_, bytes)| bytes.to_vec())
}
