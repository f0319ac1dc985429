//! The reader of OBJ before `tobj` took its place, kept for one release to compare with.

mod piece;
mod tests;

use crate::import::progress::{Phase, Steps};
use crate::import::{options::Limits, tally::Tally, text};
use crate::scene::SceneError;
use glam::{DVec2, DVec3, Vec2, Vec3};
use piece::{Corner, Counts, Face, NONE, Piece, Reader, count};
use rayon::prelude::*;
use std::{collections::HashMap, path::Path, sync::atomic::AtomicUsize, sync::atomic::Ordering};

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

/// A face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon<'a> {
    pub(super) line: u64,
    /// Index into [`Model::material_names`].
    pub(super) material: u32,
    corners: &'a [Corner],
}

impl Model {
    fn of(mut pieces: Vec<Piece>, total: &Counts) -> Self {
        let mut model = Self::default();
        model.positions.reserve_exact(total.positions);
        model.normals.reserve_exact(total.normals);
        model.uvs.reserve_exact(total.uvs);
        let mut materials = MaterialRuns::default();
        let has_objects = pieces.iter().any(|piece| piece.shapes.iter().any(|shape| shape.1));
        let mut faces = 0;
        for piece in &mut pieces {
            let shapes = piece.shapes.drain(..).filter(|shape| shape.1 == has_objects);
            model.shapes.extend(shapes.map(|(face, _, name)| (faces + face, name)));
            model.smoothing.extend(piece.smoothing.drain(..).map(|(face, group)| (faces + face, group)));
            faces += piece.faces.len();
            let (positions, uvs) = (model.positions.len(), model.uvs.len());
            model.colors.extend(piece.colors.drain(..).map(|(i, color)| ((positions + i) as u32, color)));
            model.far_uvs.extend(piece.far_uvs.drain(..).map(|(i, uv)| ((uvs + i) as u32, uv)));
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
