//! Reading the lines of a piece of OBJ text that are not numbers: faces, names, and what is counted
//! as a trouble.

use super::piece::{Corner, Counts, Face, NONE, Piece};
use crate::import::text::{self, Lines};
use crate::import::{options::Limits, trouble::Trouble};
use crate::scene::SceneError;
use std::path::Path;

/// Maximum number of corners of a face. Modelling programs hardly write longer ones. A face of 4096
/// corners that crosses itself everywhere takes 0.14 s to triangulate; one of 65,536 took 11 s,
/// without a chance to cancel.
const FACE_CORNERS: usize = 4096;

/// Reader of one piece.
pub(super) struct FaceReader<'a> {
    /// Numbers of elements up to the current line.
    so_far: Counts,
    total: Counts,
    /// Vertices of the whole file that are refused, ascending.
    refused: &'a [u32],
    piece: Piece,
}

impl<'a> FaceReader<'a> {
    /// A reader of the piece that begins after the lines and elements `before`.
    pub(super) fn new(before: Counts, total: Counts, refused: &'a [u32]) -> Self {
        let piece = Piece { first_line: before.lines + 1, ..Piece::default() };
        Self { so_far: before, total, refused, piece }
    }

    /// Reads a text.
    pub(super) fn read(mut self, text: &str, file: &Path) -> Result<Piece, SceneError> {
        for line in Lines::new(text, self.piece.first_line) {
            if line.text.len() > text::LINE_BYTES {
                return Err(SceneError::Line {
                    file: file.to_owned(),
                    line: line.number,
                    cause: "the line is longer than 16 MB".to_owned(),
                    remedy: "check that this is a text OBJ file".to_owned(),
                });
            }
            self.line(line.number, &line.text);
        }
        Ok(self.piece)
    }

    fn line(&mut self, number: u64, line: &str) {
        let (key, rest) = text::keyword(line);
        match key {
            "v" => self.so_far.positions += 1,
            "vn" => self.so_far.normals += 1,
            "vt" => self.so_far.uvs += 1,
            "f" | "fo" => self.face(number, rest),
            "usemtl" => self.material(number, rest),
            "mtllib" => self.piece.libraries.push((number, rest.to_owned())),
            "o" | "g" => self.shape(number, key == "o", rest),
            "" => {}
            "s" => self.smoothing(number, rest),
            "mg" | "usemap" | "maplib" | "lod" | "bevel" | "c_interp" | "d_interp" | "shadow_obj"
            | "trace_obj" => {
                self.piece.tally.add(Trouble::WITHOUT_EFFECT, number, || key.to_owned());
            }
            "l" | "p" => self.piece.tally.add(Trouble::LINE_OR_POINT, number, String::new),
            "vp" | "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim"
            | "hole" | "scrv" | "sp" | "end" | "con" => {
                self.piece.tally.add(Trouble::FREE_FORM, number, || key.to_owned());
            }
            _ => self.piece.tally.add(Trouble::UNKNOWN_LINE, number, || key.to_owned()),
        }
    }

    /// `s off` and `s 0` end smoothing.
    fn smoothing(&mut self, number: u64, rest: &str) {
        let word = rest.split_ascii_whitespace().next().unwrap_or("off");
        let group = match word.parse() {
            Ok(group) => group,
            Err(_) if word.eq_ignore_ascii_case("off") => 0,
            Err(_) if word.eq_ignore_ascii_case("on") => 1,
            Err(_) => {
                self.piece.tally.add(Trouble::SMOOTHING_GROUP, number, || word.to_owned());
                0
            }
        };
        self.piece.smoothing.push((self.piece.faces.len(), group));
    }

    fn material(&mut self, number: u64, rest: &str) {
        let name = text::name(rest);
        if name.len() > Limits::NAME_BYTES {
            self.piece.tally.add(Trouble::NAME_TOO_LONG, number, String::new);
            return;
        }
        self.piece.switches.push((self.piece.faces.len(), name.to_owned()));
    }

    fn shape(&mut self, number: u64, is_object: bool, rest: &str) {
        let name = text::name(rest);
        if name.len() > Limits::NAME_BYTES {
            self.piece.tally.add(Trouble::NAME_TOO_LONG, number, String::new);
            return;
        }
        self.piece.shapes.push((self.piece.faces.len(), is_object, name.to_owned()));
    }

    fn face(&mut self, number: u64, rest: &str) {
        let start = self.piece.corners.len();
        let read = self.corners(start, number, rest).and_then(|()| self.check_refused(start));
        if let Err((trouble, detail)) = read {
            self.piece.tally.add(trouble, number, || detail);
            self.piece.corners.truncate(start);
            return;
        }
        let line = (number - self.piece.first_line) as u32;
        self.piece.faces.push(Face { end: self.piece.corners.len() as u32, line });
    }

    fn check_refused(&self, start: usize) -> Result<(), (Trouble, String)> {
        let is_refused = |c: &&Corner| self.refused.binary_search(&c.position).is_ok();
        match self.piece.corners[start..].iter().find(is_refused) {
            Some(c) => Err((Trouble::VERTEX_REFUSED, format!("vertex {}", c.position + 1))),
            None => Ok(()),
        }
    }

    fn corners(&mut self, start: usize, number: u64, rest: &str) -> Result<(), (Trouble, String)> {
        for token in rest.split_ascii_whitespace().take_while(|t| !t.starts_with('#')) {
            let corner = self.corner(number, token)?;
            // The same position twice in a row adds no area, and confuses the triangulation.
            if self.piece.corners[start..].last().map(|c| c.position) != Some(corner.position) {
                self.piece.corners.push(corner);
            }
        }
        let corners = &self.piece.corners[start..];
        if corners.len() > 3 && corners[0].position == corners[corners.len() - 1].position {
            self.piece.corners.pop();
        }
        match self.piece.corners.len() - start {
            0..3 => Err((Trouble::FACE_TOO_SHORT, format!("f {rest}"))),
            3..=FACE_CORNERS => Ok(()),
            n => Err((Trouble::FACE_TOO_LONG, format!("{n} corners"))),
        }
    }

    fn corner(&mut self, number: u64, token: &str) -> Result<Corner, (Trouble, String)> {
        let unreadable = || (Trouble::CORNER_UNREADABLE, format!("'{token}'"));
        let (position, uv, normal) = indices(token).ok_or_else(unreadable)?;
        let (before, total, tally) = (&self.so_far, &self.total, &mut self.piece.tally);
        let position = resolve(position, before.positions, total.positions)
            .ok_or_else(|| (Trouble::VERTEX_MISSING, format!("vertex {position} of {}", total.positions)))?;
        let mut optional = |index: Option<i64>, before, total, trouble| {
            let Some(index) = index else { return NONE };
            resolve(index, before, total).unwrap_or_else(|| {
                tally.add(trouble, number, || format!("{index} of {total}"));
                NONE
            })
        };
        let uv = optional(uv, before.uvs, total.uvs, Trouble::UV_MISSING);
        let normal = optional(normal, before.normals, total.normals, Trouble::NORMAL_MISSING);
        Ok(Corner { position, uv, normal })
    }
}

/// Returns the indices of a corner: that of its position, and those of texture coordinate and
/// normal where it has them.
fn indices(token: &str) -> Option<(i64, Option<i64>, Option<i64>)> {
    let mut parts = token.as_bytes().split(|b| *b == b'/');
    let mut next = || match parts.next() {
        None | Some([]) => Some(None),
        Some(digits) => index(digits).map(Some),
    };
    let (position, uv, normal) = (next()?, next()?, next()?);
    Some((position?, uv, normal))
}

/// Parses a signed decimal integer of at most 18 digits, which may have a comment attached.
fn index(token: &[u8]) -> Option<i64> {
    let (negative, digits) = match token {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        all => (false, all),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0i64;
    for (i, digit) in digits.iter().enumerate() {
        if *digit == b'#' && i > 0 {
            break;
        }
        if !digit.is_ascii_digit() {
            return None;
        }
        value = value * 10 + i64::from(digit - b'0');
    }
    Some(if negative { -value } else { value })
}

/// Converts an OBJ index, counted from 1 or backwards from the last element so far, to an index
/// from 0.
fn resolve(index: i64, so_far: usize, total: usize) -> Option<u32> {
    let from_zero = if index > 0 { index - 1 } else { so_far as i64 + index };
    let in_range = index != 0 && from_zero >= 0 && from_zero < total as i64;
    in_range.then_some(from_zero as u32)
}
