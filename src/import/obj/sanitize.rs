//! The text that `tobj` is given: repaired, piece by piece, while it reads.
//!
//! First come all positions, texture coordinates and normals, then all faces, because `tobj` looks
//! up the corners of an object when it ends. A corner without a texture coordinate or a normal gets
//! one that stands for none. Names, materials and everything else stay in the pieces.

use super::piece::{Counts, Part, Piece, Reader};
use crate::import::progress::{Phase, Steps};
use crate::import::{options::Limits, tally::Tally};
use crate::scene::SceneError;
use rayon::prelude::*;
use std::io::{self, BufRead, Read};
use std::path::Path;

/// Number of pieces repaired at a time, about 4 MB of text.
const AT_ONCE: usize = 8;

/// Largest number of faces of an object in the text for `tobj`, but for those of the last piece. It
/// makes its meshes at the end of each, which cannot be cancelled.
const OBJECT_FACES: usize = 65_536;

/// A reader of the repaired text. It fails where the import is cancelled.
pub(super) struct Sanitizer<'a> {
    pub(super) texts: &'a [&'a str],
    /// Numbers of elements before each piece, and in all.
    pub(super) before: &'a [Counts],
    pub(super) total: Counts,
    pub(super) file: &'a Path,
    pub(super) limits: &'a Limits,
    pub(super) steps: &'a Steps<'a>,
    part: Part,
    next: usize,
    /// Faces and corners written, and faces since the last object began.
    corners: usize,
    object_faces: usize,
    refused: Vec<u32>,
    text: Vec<u8>,
    read: usize,
    /// The pieces whose faces have been written.
    pub(super) pieces: Vec<Piece>,
    /// Troubles with the numbers.
    pub(super) tally: Tally,
    /// Why the text ended early.
    pub(super) error: Option<SceneError>,
}

impl<'a> Sanitizer<'a> {
    pub(super) fn new(
        (texts, before, total): (&'a [&'a str], &'a [Counts], Counts),
        (file, limits, steps): (&'a Path, &'a Limits, &'a Steps<'a>),
    ) -> Self {
        Self {
            texts,
            before,
            total,
            file,
            limits,
            steps,
            part: Part::Numbers,
            next: 0,
            corners: 0,
            object_faces: 0,
            refused: Vec::new(),
            text: Vec::new(),
            read: 0,
            pieces: Vec::new(),
            tally: Tally::default(),
            error: None,
        }
    }

    /// Repairs the next pieces. Leaves the text empty at its end.
    fn fill(&mut self) -> Result<(), SceneError> {
        self.text.clear();
        self.read = 0;
        while self.text.is_empty() {
            if self.next == self.texts.len() {
                if self.part == Part::Faces {
                    return Ok(());
                }
                self.end_numbers();
                continue;
            }
            let range = self.next..self.texts.len().min(self.next + AT_ONCE);
            self.next = range.end;
            let done = [Part::Numbers, Part::Faces].iter().position(|part| *part == self.part).unwrap_or(0);
            let part = self.next as f32 / self.texts.len() as f32;
            self.steps.at(Phase::Parsing, (done as f32 + part) / 2.0)?;
            let repaired: Vec<(Piece, String)> =
                range.into_par_iter().map(|i| self.repair(i)).collect::<Result<_, _>>()?;
            repaired.into_iter().try_for_each(|(piece, text)| self.add(piece, &text))?;
        }
        Ok(())
    }

    fn repair(&self, piece: usize) -> Result<(Piece, String), SceneError> {
        let (part, total) = (self.part, self.total);
        let text = String::with_capacity(self.texts[piece].len());
        let reader = Reader {
            part,
            so_far: self.before[piece],
            total,
            refused: &self.refused,
            piece: Piece::default(),
            text,
        };
        self.steps.at(Phase::Parsing, self.next as f32 / self.texts.len() as f32 / 2.0)?;
        reader.read(self.texts[piece], self.file)
    }

    fn add(&mut self, mut piece: Piece, text: &str) -> Result<(), SceneError> {
        if self.part == Part::Numbers {
            self.refused.append(&mut piece.refused);
            self.tally.append(piece.tally);
            self.text.extend_from_slice(text.as_bytes());
            return Ok(());
        }
        self.corners += piece.corner_count;
        let limit = self.limits.corners;
        if self.corners > limit {
            let name = self.file.display().to_string();
            return Err(SceneError::TooLarge { name, what: "corners", count: self.corners, limit });
        }
        if self.object_faces + piece.faces.len() > OBJECT_FACES {
            self.text.extend_from_slice(b"o part\n");
            self.object_faces = 0;
        }
        self.object_faces += piece.faces.len();
        self.text.extend_from_slice(text.as_bytes());
        self.pieces.push(piece);
        Ok(())
    }

    /// Adds the texture coordinate and the normal that stand for none, and begins the faces.
    fn end_numbers(&mut self) {
        if self.total.uvs > 0 {
            self.text.extend_from_slice(b"vt NaN NaN\n");
        }
        if self.total.normals > 0 {
            self.text.extend_from_slice(b"vn 0 0 0\n");
        }
        (self.part, self.next) = (Part::Faces, 0);
    }
}

impl BufRead for Sanitizer<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.read == self.text.len()
            && let Err(error) = self.fill()
        {
            self.error = Some(error);
            return Err(io::Error::other("the import has ended"));
        }
        Ok(&self.text[self.read..])
    }

    fn consume(&mut self, amount: usize) {
        self.read += amount;
    }
}

impl Read for Sanitizer<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let ready = self.fill_buf()?;
        let count = ready.len().min(buffer.len());
        buffer[..count].copy_from_slice(&ready[..count]);
        self.consume(count);
        Ok(count)
    }
}
