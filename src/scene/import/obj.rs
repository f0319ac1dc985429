//! The OBJ reader: text to positions, normals, texture coordinates and faces, in pieces and in parallel.
//!
//! Why not `tobj`: one bad index or a bare `f` makes it give up the whole file without a line number, and it takes
//! `l` for a face. Reading around that needs every line rewritten first, which costs more than reading it here.
//! `tobj` remains the independent second opinion in the tests.

use super::report::{Tally, Trouble};
use super::text::{self, Lines};
use super::{Limits, Phase, Steps};
use crate::scene::SceneError;
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// No texture coordinate, or no normal.
pub(super) const NONE: u32 = u32::MAX;

/// Text per unit of parallel work: some 16,000 lines, so that a cancel is noticed within milliseconds.
const PIECE_BYTES: usize = 512 << 10;

/// A longer face is hardly one that a modelling program wrote. One of 4096 corners that crosses itself everywhere takes
/// 0.14 s to fill, one of 65,536 took 11 s: nobody could cancel meanwhile.
const FACE_CORNERS: usize = 4096;

/// A corner of a face: indices from 0 into the whole file's lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}
const _: () = assert!(size_of::<Corner>() == 12);

/// A polygon: where its corners end in its piece's list, and its line, counted from the piece's first.
#[derive(Clone, Copy, Debug)]
struct Face {
    end: u32,
    line: u32,
}

/// What one piece of the text says.
#[derive(Debug, Default)]
struct Piece {
    first_line: u64,
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    corners: Vec<Corner>,
    faces: Vec<Face>,
    /// `usemtl`: the number of faces before it, and the name.
    switches: Vec<(usize, String)>,
    /// The same once the pieces are joined: the end of a run of faces, and its material's number.
    runs: Vec<(usize, u32)>,
    libraries: Vec<(u64, String)>,
    tally: Tally,
}

/// A whole OBJ file.
#[derive(Debug, Default)]
pub(super) struct Model {
    /// As written; not finite where a vertex was refused.
    pub(super) positions: Vec<DVec3>,
    /// Unit length, or zero.
    pub(super) normals: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    pieces: Vec<Piece>,
    /// Names used by faces, in the order of use; the first is empty where faces come before any `usemtl`.
    pub(super) material_names: Vec<String>,
    /// `mtllib` lines: number and operand.
    pub(super) libraries: Vec<(u64, String)>,
    pub(super) tally: Tally,
}

#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    lines: u64,
    positions: usize,
    uvs: usize,
    normals: usize,
}

impl Counts {
    fn plus(self, other: Self) -> Self {
        Self {
            lines: self.lines + other.lines,
            positions: self.positions + other.positions,
            uvs: self.uvs + other.uvs,
            normals: self.normals + other.normals,
        }
    }
}

/// Takes the text of an OBJ file; returns what it says. Troubles of single lines are counted, never fatal.
pub(super) fn parse(text: &str, file: &Path, limits: &Limits, steps: &Steps) -> Result<Model, SceneError> {
    let texts = text::pieces(text, PIECE_BYTES);
    let counts: Vec<Counts> = texts.par_iter().map(|t| count(t, steps)).collect::<Result<_, _>>()?;
    let mut total = Counts::default();
    let before: Vec<Counts> = counts
        .iter()
        .map(|c| {
            let so_far = total;
            total = total.plus(*c);
            so_far
        })
        .collect();
    check_counts(&total, file)?;
    let done = AtomicUsize::new(0);
    let pieces: Vec<Piece> = texts
        .par_iter()
        .zip(&before)
        .map(|(t, before)| {
            let piece = Reader { before: *before, total, piece: Piece::default() }.read(t, file)?;
            let done = done.fetch_add(t.len(), Ordering::Relaxed) + t.len();
            steps.at(Phase::Parsing, done as f32 / text.len() as f32)?;
            Ok(piece)
        })
        .collect::<Result<_, SceneError>>()?;
    let corners: usize = pieces.iter().map(|p| p.corners.len()).sum();
    within("corners", corners, limits.corners, file)?;
    Ok(Model::of(pieces, &total))
}

fn check_counts(total: &Counts, file: &Path) -> Result<(), SceneError> {
    let limit = NONE as usize - 1;
    within("vertices", total.positions, limit, file)?;
    within("normals", total.normals, limit, file)?;
    within("texture coordinates", total.uvs, limit, file)
}

fn within(what: &'static str, count: usize, limit: usize, file: &Path) -> Result<(), SceneError> {
    if count <= limit {
        return Ok(());
    }
    Err(SceneError::TooLarge { name: file.display().to_string(), what, count, limit })
}

/// Counts what [`Reader`] will find, by the same rules, so that each piece knows what lies before it.
fn count(text: &str, steps: &Steps) -> Result<Counts, SceneError> {
    let mut counts = Counts::default();
    let mut lines = Lines::new(text, 0);
    for line in lines.by_ref() {
        match text::keyword(&line.text).0 {
            "v" => counts.positions += 1,
            "vt" => counts.uvs += 1,
            "vn" => counts.normals += 1,
            _ => {}
        }
    }
    counts.lines = lines.next_number();
    steps.at(Phase::Parsing, 0.0)?;
    Ok(counts)
}

/// Reads one piece.
struct Reader {
    before: Counts,
    total: Counts,
    piece: Piece,
}

impl Reader {
    fn read(mut self, text: &str, file: &Path) -> Result<Piece, SceneError> {
        self.piece.first_line = self.before.lines + 1;
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
            "v" => self.position(number, rest),
            "vn" => self.normal(number, rest),
            "vt" => self.uv(number, rest),
            "f" | "fo" => self.face(number, rest),
            "usemtl" => self.material(number, rest),
            "mtllib" => self.piece.libraries.push((number, rest.to_owned())),
            "" | "o" | "g" | "s" | "mg" | "usemap" | "maplib" | "lod" | "bevel" | "c_interp" | "d_interp"
            | "shadow_obj" | "trace_obj" => {}
            "l" | "p" => self.piece.tally.add(Trouble::LINE_OR_POINT, number, String::new),
            "vp" | "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim"
            | "hole" | "scrv" | "sp" | "end" | "con" => {
                self.piece.tally.add(Trouble::FREE_FORM, number, || key.to_owned());
            }
            _ => self.piece.tally.add(Trouble::UNKNOWN_LINE, number, || key.to_owned()),
        }
    }

    fn position(&mut self, number: u64, rest: &str) {
        let position = numbers::<3>(rest).map(DVec3::from_array);
        if position.is_none() {
            self.piece.tally.add(Trouble::VERTEX_UNREADABLE, number, || rest.to_owned());
        }
        // A refused vertex keeps its place, so that the indices of all others stay right.
        self.piece.positions.push(position.unwrap_or(DVec3::NAN));
    }

    fn normal(&mut self, number: u64, rest: &str) {
        let normal = numbers::<3>(rest).map(DVec3::from_array);
        if normal.is_none() {
            self.piece.tally.add(Trouble::NORMAL_UNREADABLE, number, || rest.to_owned());
        }
        let unit = normal.and_then(DVec3::try_normalize).unwrap_or(DVec3::ZERO);
        self.piece.normals.push(unit.as_vec3());
    }

    fn uv(&mut self, number: u64, rest: &str) {
        // `vt u` alone is legal; v is then 0.
        let uv = numbers::<2>(rest).or_else(|| numbers::<1>(rest).map(|[u]| [u, 0.0]));
        let uv = uv.map(|[u, v]| Vec2::new(u as f32, v as f32)).filter(|uv| uv.is_finite());
        if uv.is_none() {
            self.piece.tally.add(Trouble::UV_UNREADABLE, number, || rest.to_owned());
        }
        self.piece.uvs.push(uv.unwrap_or(Vec2::ZERO));
    }

    fn material(&mut self, number: u64, rest: &str) {
        let name = text::name(rest);
        if name.len() > Limits::NAME_BYTES {
            self.piece.tally.add(Trouble::NAME_TOO_LONG, number, String::new);
            return;
        }
        self.piece.switches.push((self.piece.faces.len(), name.to_owned()));
    }

    fn face(&mut self, number: u64, rest: &str) {
        let start = self.piece.corners.len();
        if let Err((trouble, detail)) = self.corners(number, rest) {
            self.piece.corners.truncate(start);
            self.piece.tally.add(trouble, number, || detail);
            return;
        }
        let line = (number - self.piece.first_line) as u32;
        self.piece.faces.push(Face { end: self.piece.corners.len() as u32, line });
    }

    fn corners(&mut self, number: u64, rest: &str) -> Result<(), (Trouble, String)> {
        let start = self.piece.corners.len();
        for token in rest.split_ascii_whitespace().take_while(|t| !t.starts_with('#')) {
            let corner = self.corner(number, token)?;
            // The same corner twice in a row adds nothing, and confuses the triangulation.
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
        let (before, total, piece) = (&self.before, &self.total, &mut self.piece);
        let position = resolve(position, before.positions + piece.positions.len(), total.positions)
            .ok_or_else(|| (Trouble::VERTEX_MISSING, format!("vertex {position} of {}", total.positions)))?;
        let uv_index = uv.map(|i| (i, resolve(i, before.uvs + piece.uvs.len(), total.uvs)));
        let normal_index =
            normal.map(|i| (i, resolve(i, before.normals + piece.normals.len(), total.normals)));
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

/// The first `N` numbers of a line. What follows (a weight, a colour) is ignored.
fn numbers<const N: usize>(rest: &str) -> Option<[f64; N]> {
    let mut tokens = rest.split_ascii_whitespace();
    let mut found = [0.0; N];
    for slot in &mut found {
        *slot = text::number(tokens.next()?)?;
    }
    Some(found)
}

/// A signed decimal integer of at most 18 digits; a comment may be stuck to it.
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

/// From 1, or negative from the last one so far, to an index from 0.
fn resolve(index: i64, so_far: usize, total: usize) -> Option<u32> {
    let from_zero = if index > 0 { index - 1 } else { so_far as i64 + index };
    let in_range = index != 0 && from_zero >= 0 && from_zero < total as i64;
    in_range.then_some(from_zero as u32)
}

/// A face as the welder takes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon<'a> {
    pub(super) line: u64,
    /// Index into [`Model::material_names`].
    pub(super) material: u32,
    pub(super) corners: &'a [Corner],
}

impl Model {
    fn of(mut pieces: Vec<Piece>, total: &Counts) -> Self {
        let mut model = Self::default();
        model.positions.reserve_exact(total.positions);
        model.normals.reserve_exact(total.normals);
        model.uvs.reserve_exact(total.uvs);
        let mut materials = MaterialRuns::default();
        for piece in &mut pieces {
            model.positions.append(&mut piece.positions);
            model.normals.append(&mut piece.normals);
            model.uvs.append(&mut piece.uvs);
            model.libraries.append(&mut piece.libraries);
            model.tally.append(std::mem::take(&mut piece.tally));
            piece.runs = materials.runs_of(piece);
        }
        model.material_names = materials.names;
        model.pieces = pieces;
        model
    }

    /// Number of polygons.
    pub(super) fn face_count(&self) -> usize {
        self.pieces.iter().map(|p| p.faces.len()).sum()
    }

    /// The polygons in the order of the file.
    pub(super) fn faces(&self) -> impl Iterator<Item = Polygon<'_>> {
        self.pieces.iter().flat_map(|piece| {
            let mut start = 0;
            let runs = piece.runs.iter().scan(0, |from, &(to, material)| {
                let run = *from..to;
                *from = to;
                Some(run.map(move |face| (face, material)))
            });
            runs.flatten().map(move |(face, material)| {
                let Face { end, line } = piece.faces[face];
                let corners = &piece.corners[start as usize..end as usize];
                start = end;
                Polygon { line: piece.first_line + u64::from(line), material, corners }
            })
        })
    }
}

/// Gives names their numbers while the pieces go by; a piece starts with the material that the last one ended with.
#[derive(Default)]
struct MaterialRuns {
    current: String,
    names: Vec<String>,
    number_of: HashMap<String, u32>,
}

impl MaterialRuns {
    /// Consecutive faces of one material: the end of the run, and the material.
    fn runs_of(&mut self, piece: &mut Piece) -> Vec<(usize, u32)> {
        let mut runs = Vec::new();
        let mut start = 0;
        for (face, name) in piece.switches.drain(..) {
            self.close(start..face, &mut runs);
            start = face;
            self.current = name;
        }
        self.close(start..piece.faces.len(), &mut runs);
        runs
    }

    fn close(&mut self, faces: std::ops::Range<usize>, runs: &mut Vec<(usize, u32)>) {
        if faces.is_empty() {
            return; // a material that no face uses costs nothing
        }
        let next = self.names.len() as u32;
        let number = *self.number_of.entry(self.current.clone()).or_insert_with(|| {
            self.names.push(self.current.clone());
            next
        });
        runs.push((faces.end, number));
    }
}
