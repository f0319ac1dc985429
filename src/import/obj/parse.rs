//! Parsing OBJ text into positions, normals, texture coordinates and faces.
//!
//! `tobj` parses it, piece by piece, behind [`FaceReader`] and [`NumberLines`]: alone it refuses a
//! whole file for one bad index or a bare `f`, without a line number, and reads `l` as a face.

use super::faces::FaceReader;
use super::numbers::NumberLines;
use super::piece::{Corner, Counts, Face, NONE, Piece, UsedNumbers};
use super::used::{self, Source};
use crate::import::progress::{Phase, Steps};
use crate::import::{files::unreadable, options::Limits, tally::Tally, text};
use crate::scene::SceneError;
use glam::{DVec2, DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes of text per unit of parallel work: about 16,000 lines, so that a cancellation is noticed
/// within milliseconds.
const PIECE_BYTES: usize = 512 << 10;

/// Contents of an OBJ file.
#[derive(Debug, Default)]
pub(super) struct Model {
    /// Positions as written, later in world metres; not finite where a vertex was refused.
    pub(super) positions: Vec<DVec3>,
    /// Unit vectors, or zero.
    pub(super) normals: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    /// Texture coordinates of which f32 keeps too few digits, by index, ascending.
    pub(super) far_uvs: Vec<(u32, DVec2)>,
    /// Colours of vertices as written, by the index of their position, ascending.
    pub(super) colors: Vec<(u32, Vec3)>,
    /// Smoothing groups: the number of faces before each, and the group; 0 is flat.
    pub(super) smoothing: Vec<(usize, u32)>,
    pieces: Vec<Piece>,
    /// Material names in the order of their first use by a face. A name is empty for faces before
    /// any `usemtl`.
    pub(super) material_names: Vec<String>,
    /// Objects, or groups where the file has no objects: the number of faces before each, and the
    /// name.
    pub(super) shapes: Vec<(usize, String)>,
    /// `mtllib` lines: line number and operand.
    pub(super) libraries: Vec<(u64, String)>,
    pub(super) tally: Tally,
}

/// Parses the text of an OBJ file. Troubles of single lines are counted and never fatal.
pub(super) fn parse(text: &str, file: &Path, limits: &Limits, steps: &Steps) -> Result<Model, SceneError> {
    let texts = text::pieces(text, PIECE_BYTES);
    let lines: Vec<NumberLines> = texts
        .par_iter()
        .map(|text| {
            steps.at(Phase::Parsing, 0.0)?;
            Ok(NumberLines::find(text))
        })
        .collect::<Result<_, SceneError>>()?;
    let (before, total) = sums(&lines);
    check_counts(&total, file)?;
    let refused_of = |(lines, before): (&NumberLines, &Counts)| {
        let first = before.positions as u32;
        lines.refused.iter().map(|i| first + i).collect::<Vec<u32>>()
    };
    let refused: Vec<u32> = lines.iter().zip(&before).flat_map(refused_of).collect();
    let has_colors = lines.iter().any(|lines| lines.has_colors);
    let source = Source { texts: &texts, lines: &lines, before: &before, has_colors };
    let parser = PieceParser { source, total, refused, file, limits, steps, corners: AtomicUsize::new(0) };
    let pieces = (0..texts.len()).into_par_iter().map(|i| parser.parse(i)).collect::<Result<Vec<_>, _>>()?;
    let (pieces, numbers): (Vec<Piece>, Vec<UsedNumbers>) = pieces.into_iter().unzip();
    let mut tally = Tally::default();
    for (lines, before) in lines.into_iter().zip(&before) {
        tally.append(lines.tally.moved(before.lines + 1));
    }
    Ok(Model::of(pieces, tally).with(numbers, &total))
}

/// Returns the numbers of elements before each piece, and in all.
fn sums(lines: &[NumberLines]) -> (Vec<Counts>, Counts) {
    let mut total = Counts::default();
    let before = lines.iter().map(|lines| {
        let so_far = total;
        total = total.plus(lines.counts());
        so_far
    });
    (before.collect(), total)
}

/// Parser of the pieces of a text, which are independent.
struct PieceParser<'a> {
    source: Source<'a>,
    total: Counts,
    /// Vertices that are refused, ascending.
    refused: Vec<u32>,
    file: &'a Path,
    limits: &'a Limits,
    steps: &'a Steps<'a>,
    /// Number of corners so far.
    corners: AtomicUsize,
}

impl PieceParser<'_> {
    fn parse(&self, i: usize) -> Result<(Piece, UsedNumbers), SceneError> {
        let done = i as f32 / self.source.texts.len() as f32;
        self.steps.at(Phase::Parsing, done)?;
        let reader = FaceReader::new(self.source.before[i], self.total, &self.refused);
        let mut piece = reader.read(self.source.texts[i], self.file)?;
        let corners = self.corners.fetch_add(piece.corners.len(), Ordering::Relaxed) + piece.corners.len();
        // The number so far depends on the order of the threads, and the message must not.
        within("corners", corners.min(self.limits.corners + 1), self.limits.corners, self.file)?;
        self.steps.at(Phase::Parsing, done)?;
        let numbers = used::parse(&mut piece, &self.source).map_err(|error| {
            let cause = format!("its repaired text cannot be parsed: {error}");
            unreadable(self.file, cause, "please report this file")
        })?;
        Ok((piece, numbers))
    }
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

/// A face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon<'a> {
    pub(super) line: u64,
    /// Index into [`Model::material_names`].
    pub(super) material: u32,
    pub(super) corners: &'a [Corner],
}

impl Model {
    /// A model of pieces, without its numbers.
    fn of(mut pieces: Vec<Piece>, tally: Tally) -> Self {
        let mut model = Self { tally, ..Self::default() };
        let mut materials = MaterialRuns::default();
        let has_objects = pieces.iter().any(|piece| piece.shapes.iter().any(|shape| shape.1));
        let mut faces = 0;
        for piece in &mut pieces {
            let shapes = piece.shapes.drain(..).filter(|shape| shape.1 == has_objects);
            model.shapes.extend(shapes.map(|(face, _, name)| (faces + face, name)));
            model.smoothing.extend(piece.smoothing.drain(..).map(|(face, group)| (faces + face, group)));
            faces += piece.faces.len();
            model.libraries.append(&mut piece.libraries);
            model.tally.append(std::mem::take(&mut piece.tally));
            piece.runs = materials.runs_of(piece);
        }
        model.material_names = materials.names;
        model.pieces = pieces;
        model
    }

    /// Returns the model with its numbers, each at its index in the file. Those that no face uses
    /// are not finite, or zero.
    fn with(self, used: Vec<UsedNumbers>, total: &Counts) -> Self {
        let mut positions = vec![DVec3::NAN; total.positions];
        let mut normals = vec![Vec3::ZERO; total.normals];
        let mut uvs = vec![Vec2::ZERO; total.uvs];
        let (mut far_uvs, mut colors) = (BTreeMap::new(), BTreeMap::new());
        for used in used {
            set_all(&mut positions, &used.positions);
            set_all(&mut normals, &used.normals);
            set_all(&mut uvs, &used.uvs);
            far_uvs.extend(used.far_uvs);
            colors.extend(used.colors);
        }
        let (far_uvs, colors) = (far_uvs.into_iter().collect(), colors.into_iter().collect());
        Self { positions, normals, uvs, far_uvs, colors, ..self }
    }

    /// Returns the number of polygons.
    pub(super) fn face_count(&self) -> usize {
        self.pieces.iter().map(|p| p.faces.len()).sum()
    }

    /// Returns the corners of all faces, in the order of [`Self::faces`], to be changed.
    pub(super) fn corners_mut(&mut self) -> impl Iterator<Item = &mut Corner> {
        self.pieces.iter_mut().flat_map(|piece| &mut piece.corners)
    }

    /// Returns the polygons in the order of the file.
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

fn set_all<T: Copy>(list: &mut [T], values: &[(u32, T)]) {
    for (index, value) in values {
        // An element that stands for none has no index.
        if let Some(slot) = list.get_mut(*index as usize) {
            *slot = *value;
        }
    }
}

/// Numbers the material names, piece by piece. A piece starts with the material that the piece
/// before it ended with.
#[derive(Default)]
struct MaterialRuns {
    current: String,
    names: Vec<String>,
    number_of: HashMap<String, u32>,
}

impl MaterialRuns {
    /// Returns the runs of consecutive faces of one material: the end of each run, and the
    /// material.
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
            return; // a material that no face uses gets no number
        }
        let next = self.names.len() as u32;
        let number = *self.number_of.entry(self.current.clone()).or_insert_with(|| {
            self.names.push(self.current.clone());
            next
        });
        runs.push((faces.end, number));
    }
}
