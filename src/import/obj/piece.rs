//! Reading one piece of OBJ text, line by line: its lines are repaired, and written for `tobj`.

use crate::import::progress::{Phase, Steps};
use crate::import::text::{self, Lines};
use crate::import::{options::Limits, tally::Tally, trouble::Trouble};
use crate::scene::SceneError;
use glam::Vec3;
use std::path::Path;

/// Index that stands for no texture coordinate or no normal.
pub(super) const NONE: u32 = u32::MAX;

/// Maximum number of corners of a face. Modelling programs hardly write longer ones. A face of 4096
/// corners that crosses itself everywhere takes 0.14 s to triangulate; one of 65,536 took 11 s,
/// without a chance to cancel.
const FACE_CORNERS: usize = 4096;

/// Texture coordinates from here on are wrapped before they are rounded to f32, which keeps a
/// sixteenth of a texel of a picture of 4096 texels below.
pub(super) const UV_FAR: f64 = 256.0;

/// Largest texture coordinate of which f64 keeps an eighth of a picture.
const UV_MAX: f64 = 1e15;

/// A corner of a face: indices into the lists of the whole file, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}
const _: () = assert!(size_of::<Corner>() == 12);

/// A polygon: the end of its corners in the list of its piece, and its line, counted from the first
/// line of the piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) end: u32,
    pub(super) line: u32,
}

/// Contents of one piece of the text.
#[derive(Debug, Default)]
pub(super) struct Piece {
    pub(super) first_line: u64,
    /// Vertices that are refused, by their index in the file.
    pub(super) refused: Vec<u32>,
    /// Corners of all faces, as `tobj` has read them.
    pub(super) corners: Vec<Corner>,
    /// Number of the corners of all faces.
    pub(super) corner_count: usize,
    pub(super) faces: Vec<Face>,
    /// `usemtl` lines: the number of faces before each, and the name.
    pub(super) switches: Vec<(usize, String)>,
    /// `o` and `g` lines: the number of faces before each, whether it is an `o`, and the name.
    pub(super) shapes: Vec<(usize, bool, String)>,
    /// `s` lines: the number of faces before each, and the group; 0 is flat.
    pub(super) smoothing: Vec<(usize, u32)>,
    /// `usemtl` after the pieces are joined: the end of each run of faces, and the number of its
    /// material.
    pub(super) runs: Vec<(usize, u32)>,
    pub(super) libraries: Vec<(u64, String)>,
    pub(super) tally: Tally,
}

/// Numbers of lines and vertex attributes in a text.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub(super) lines: u64,
    pub(super) positions: usize,
    pub(super) uvs: usize,
    pub(super) normals: usize,
    /// A vertex has a colour.
    pub(super) has_colors: bool,
}

impl Counts {
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            lines: self.lines + other.lines,
            positions: self.positions + other.positions,
            uvs: self.uvs + other.uvs,
            normals: self.normals + other.normals,
            has_colors: self.has_colors || other.has_colors,
        }
    }
}

/// Counts what [`Reader`] will find, by the same rules: each piece needs the numbers of the pieces
/// before it.
pub(super) fn count(text: &str, steps: &Steps) -> Result<Counts, SceneError> {
    let mut counts = Counts::default();
    let mut lines = Lines::new(text, 0);
    for line in lines.by_ref() {
        let (key, rest) = text::keyword(&line.text);
        match key {
            "v" => {
                counts.positions += 1;
                counts.has_colors = counts.has_colors || color(rest).is_some();
            }
            "vt" => counts.uvs += 1,
            "vn" => counts.normals += 1,
            _ => {}
        }
    }
    counts.lines = lines.next_number();
    steps.at(Phase::Parsing, 0.0)?;
    Ok(counts)
}

/// The lines of a piece of text that one pass reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// Positions, normals and texture coordinates: `tobj` needs all of them before the first face.
    Numbers,
    /// Everything else.
    Faces,
}

/// Reader of one piece.
pub(super) struct Reader<'a> {
    pub(super) part: Part,
    /// Numbers of elements up to the current line.
    pub(super) so_far: Counts,
    pub(super) total: Counts,
    /// Vertices of the whole file that are refused, ascending; empty while numbers are read.
    pub(super) refused: &'a [u32],
    pub(super) piece: Piece,
    /// The repaired lines.
    pub(super) text: String,
}

impl Reader<'_> {
    /// Reads a text. Returns what `tobj` does not need, and the repaired lines for it.
    pub(super) fn read(mut self, text: &str, file: &Path) -> Result<(Piece, String), SceneError> {
        self.piece.first_line = self.so_far.lines + 1;
        for line in Lines::new(text, self.piece.first_line) {
            if line.text.len() > text::LINE_BYTES {
                return Err(SceneError::Line {
                    file: file.to_owned(),
                    line: line.number,
                    cause: "the line is longer than 16 MB".to_owned(),
                    remedy: "check that this is a text OBJ file".to_owned(),
                });
            }
            match self.part {
                Part::Numbers => self.numbers_of(line.number, &line.text),
                Part::Faces => self.line(line.number, &line.text),
            }
        }
        Ok((self.piece, self.text))
    }

    fn numbers_of(&mut self, number: u64, line: &str) {
        let (key, rest) = text::keyword(line);
        match key {
            "v" => self.position(number, rest),
            "vn" => self.normal(number, rest),
            "vt" => self.uv(number, rest),
            _ => {}
        }
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

    fn position(&mut self, number: u64, rest: &str) {
        let position = self.numbers::<3>(number, rest);
        if position.is_none() {
            self.piece.tally.add(Trouble::VERTEX_UNREADABLE, number, || rest.to_owned());
            self.piece.refused.push(self.so_far.positions as u32);
        }
        // A refused vertex keeps its index, so that the indices of all others stay right.
        self.write("v", rest, position, [f64::NAN; 3]);
        if self.total.has_colors {
            let color = position.and(color(rest)).map(|c| c.as_dvec3().to_array());
            self.text.pop();
            self.write("", "", color, [f64::NAN; 3]);
        }
        self.so_far.positions += 1;
    }

    fn normal(&mut self, number: u64, rest: &str) {
        let normal = self.numbers::<3>(number, rest);
        if normal.is_none() {
            self.piece.tally.add(Trouble::NORMAL_UNREADABLE, number, || rest.to_owned());
        }
        self.write("vn", rest, normal, [0.0; 3]);
    }

    fn uv(&mut self, number: u64, rest: &str) {
        // `vt u` alone is valid; v is then 0.
        let uv = self.numbers::<2>(number, rest).or_else(|| numbers::<1>(rest).map(|[u]| [u, 0.0]));
        let uv = uv.filter(|uv| uv.iter().all(|c| c.abs() <= UV_MAX));
        if uv.is_none() {
            self.piece.tally.add(Trouble::UV_UNREADABLE, number, || rest.to_owned());
        }
        self.write("vt", rest, uv, [0.0; 2]);
    }

    /// Writes a line of numbers, or of `instead` where there are none. Numbers that can be copied
    /// keep their digits in the file.
    fn write<const N: usize>(&mut self, key: &str, rest: &str, numbers: Option<[f64; N]>, instead: [f64; N]) {
        self.text.push_str(key);
        let tokens = || rest.split_ascii_whitespace().take(N);
        let is_plain = |token: &str| token.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
        if numbers.is_some() && tokens().count() == N && tokens().all(is_plain) {
            for token in tokens() {
                self.text.push(' ');
                self.text.push_str(token);
            }
        } else {
            let written = numbers.unwrap_or(instead).map(|number| format!(" {number:e}"));
            written.iter().for_each(|number| self.text.push_str(number));
        }
        self.text.push('\n');
    }

    /// Returns the first `N` numbers of a line, also those with decimal commas.
    fn numbers<const N: usize>(&mut self, number: u64, rest: &str) -> Option<[f64; N]> {
        numbers(rest).or_else(|| {
            let found = numbers(&text::with_decimal_points(rest)?)?;
            self.piece.tally.add(Trouble::DECIMAL_COMMA, number, || rest.to_owned());
            Some(found)
        })
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
        self.piece.corners.clear();
        if let Err((trouble, detail)) = self.corners(number, rest) {
            self.piece.tally.add(trouble, number, || detail);
            return;
        }
        let is_refused = |c: &&Corner| self.refused.binary_search(&c.position).is_ok();
        if let Some(refused) = self.piece.corners.iter().find(is_refused).map(|c| c.position) {
            self.piece.tally.add(Trouble::VERTEX_REFUSED, number, || format!("vertex {}", refused + 1));
            return;
        }
        self.write_face();
        let line = (number - self.piece.first_line) as u32;
        self.piece.corner_count += self.piece.corners.len();
        self.piece.faces.push(Face { end: 0, line });
    }

    /// Writes a face with a texture coordinate and a normal at every corner, where the file has
    /// any: `tobj` would take those of the corner before.
    fn write_face(&mut self) {
        let of_list = |index: u32, total: usize| if index == NONE { total } else { index as usize };
        self.text.push('f');
        for corner in &self.piece.corners {
            self.text.push(' ');
            push_index(&mut self.text, corner.position as usize);
            if self.total.uvs + self.total.normals > 0 {
                self.text.push('/');
            }
            if self.total.uvs > 0 {
                push_index(&mut self.text, of_list(corner.uv, self.total.uvs));
            }
            if self.total.normals > 0 {
                self.text.push('/');
                push_index(&mut self.text, of_list(corner.normal, self.total.normals));
            }
        }
        self.text.push('\n');
    }

    fn corners(&mut self, number: u64, rest: &str) -> Result<(), (Trouble, String)> {
        let start = self.piece.corners.len();
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
        let mut parts = token.split('/');
        let unreadable = || (Trouble::CORNER_UNREADABLE, format!("'{token}'"));
        let mut next = || match parts.next() {
            None | Some("") => Ok(None),
            Some(digits) => index(digits).map(Some).ok_or_else(unreadable),
        };
        let (position, uv, normal) = (next()?.ok_or_else(unreadable)?, next()?, next()?);
        let (before, total, piece) = (&self.so_far, &self.total, &mut self.piece);
        let position = resolve(position, before.positions, total.positions)
            .ok_or_else(|| (Trouble::VERTEX_MISSING, format!("vertex {position} of {}", total.positions)))?;
        let uv_index = uv.map(|i| (i, resolve(i, before.uvs, total.uvs)));
        let normal_index = normal.map(|i| (i, resolve(i, before.normals, total.normals)));
        if let Some((i, None)) = uv_index {
            piece.tally.add(Trouble::UV_MISSING, number, || format!("{i} of {}", total.uvs));
        }
        if let Some((i, None)) = normal_index {
            piece.tally.add(Trouble::NORMAL_MISSING, number, || format!("{i} of {}", total.normals));
        }
        let or_none = |found: Option<(i64, Option<u32>)>| found.and_then(|(_, i)| i).unwrap_or(NONE);
        Ok(Corner { position, uv: or_none(uv_index), normal: or_none(normal_index) })
    }
}

/// Returns the colour of a vertex, red, green and blue, where three numbers or more follow the
/// position. `v x y z w` has none; of seven numbers, the last is alpha.
fn color(rest: &str) -> Option<Vec3> {
    let mut tokens = rest.split_ascii_whitespace().skip(3).take_while(|token| !token.starts_with('#'));
    let mut channel = || tokens.next().and_then(text::number).map(|number| number as f32);
    Some(Vec3::new(channel()?, channel()?, channel()?)).filter(|color| color.is_finite())
}

/// Returns the first `N` numbers of a line. What follows (a weight, a colour) is ignored.
fn numbers<const N: usize>(rest: &str) -> Option<[f64; N]> {
    let mut tokens = rest.split_ascii_whitespace();
    let mut found = [0.0; N];
    for slot in &mut found {
        *slot = text::number(tokens.next()?)?;
    }
    Some(found)
}

/// Appends an index, counted from 0, as OBJ counts it.
fn push_index(text: &mut String, index: usize) {
    let (mut digits, mut first, mut left) = ([0; 20], 20, index + 1);
    while left > 0 {
        first -= 1;
        digits[first] = b'0' + (left % 10) as u8;
        left /= 10;
    }
    text.extend(digits[first..].iter().map(|digit| char::from(*digit)));
}

/// Parses a signed decimal integer of at most 18 digits, which may have a comment attached.
fn index(token: &str) -> Option<i64> {
    let (negative, digits) = match token.as_bytes() {
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
