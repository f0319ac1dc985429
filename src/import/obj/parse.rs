//! Parsing OBJ text into positions, normals, texture coordinates and faces.
//!
//! `tobj` parses it, behind [`Sanitizer`]: alone it refuses a whole file for one bad index or a
//! bare `f`, without a line number, and reads `l` as a face.

use super::piece::{Corner, Counts, Face, NONE, Piece, UV_FAR, count};
use super::sanitize::Sanitizer;
use crate::import::progress::{Phase, Steps};
use crate::import::{files::unreadable, options::Limits, tally::Tally, text};
use crate::scene::SceneError;
use glam::{DVec2, DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::{collections::HashMap, path::Path};

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
    let mut sanitizer = Sanitizer::new((&texts, &before, total), (file, limits, steps));
    let meshes = tobj::load_obj_buf(&mut sanitizer, &OPTIONS, |_| Ok(Default::default()));
    if let Some(error) = sanitizer.error {
        return Err(error);
    }
    let (meshes, _) = meshes.map_err(|error| {
        unreadable(file, format!("its repaired text cannot be parsed: {error}"), "please report this file")
    })?;
    let mut model = Model::of(sanitizer.pieces, sanitizer.tally);
    let mut faces = FaceSlots { pieces: &mut model.pieces, piece: 0, face: 0 };
    let mut numbers = Numbers::default();
    for mesh in meshes {
        numbers.add(mesh.mesh, &mut faces);
        steps.at(Phase::Parsing, 1.0)?;
    }
    let Numbers { positions, normals, uvs, far_uvs, colors } = numbers;
    Ok(Model { positions, normals, uvs, far_uvs, colors, ..model })
}

/// Polygons and the three lists of indices stay as they are: they are welded and filled here.
const OPTIONS: tobj::LoadOptions =
    tobj::LoadOptions { single_index: false, triangulate: false, ignore_points: true, ignore_lines: true };

/// The faces of the pieces that still wait for their corners.
struct FaceSlots<'a> {
    pieces: &'a mut [Piece],
    piece: usize,
    face: usize,
}

impl FaceSlots<'_> {
    /// Sets the corners of the next face.
    fn fill(&mut self, corners: impl Iterator<Item = Corner>) {
        while self.pieces.get(self.piece).is_some_and(|piece| self.face == piece.faces.len()) {
            (self.piece, self.face) = (self.piece + 1, 0);
        }
        let Some(piece) = self.pieces.get_mut(self.piece) else { return };
        if self.face == 0 {
            piece.corners = Vec::with_capacity(piece.corner_count);
        }
        piece.corners.extend(corners);
        piece.faces[self.face].end = piece.corners.len() as u32;
        self.face += 1;
    }
}

/// The lists of a model.
#[derive(Default)]
struct Numbers {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    far_uvs: Vec<(u32, DVec2)>,
    colors: Vec<(u32, Vec3)>,
}

impl Numbers {
    /// Appends the lists of a mesh, and sets the corners of its faces.
    fn add(&mut self, mesh: tobj::Mesh, faces: &mut FaceSlots) {
        let bases = [self.positions.len(), self.uvs.len(), self.normals.len()].map(|base| base as u32);
        let triple = |n: &[f64; 3]| DVec3::from_array(*n);
        for (i, color) in (bases[0]..).zip(mesh.vertex_color.as_chunks().0) {
            let color = triple(color).as_vec3();
            if color.is_finite() {
                self.colors.push((i, color));
            }
        }
        self.positions.extend(mesh.positions.as_chunks().0.iter().map(triple));
        let unit = |n: &[f64; 3]| triple(n).try_normalize().unwrap_or(DVec3::ZERO).as_vec3();
        self.normals.extend(mesh.normals.as_chunks().0.iter().map(unit));
        for uv in mesh.texcoords.as_chunks().0 {
            let uv = DVec2::from_array(*uv);
            if uv.abs().max_element() >= UV_FAR {
                self.far_uvs.push((self.uvs.len() as u32, uv));
            }
            self.uvs.push(uv.as_vec2());
        }
        let corner = |i: usize| {
            let [position, uv, normal] = [&mesh.indices, &mesh.texcoord_indices, &mesh.normal_indices]
                .map(|list| list.get(i).copied().unwrap_or(NONE));
            // The ones that stand for none.
            let uv = if uv == NONE { NONE } else { bases[1] + uv };
            let has_uv = self.uvs.get(uv as usize).is_some_and(|uv| !uv.is_nan());
            let normal = if normal == NONE { NONE } else { bases[2] + normal };
            let has_normal = self.normals.get(normal as usize).is_some_and(|n| *n != Vec3::ZERO);
            Corner {
                position: bases[0] + position,
                uv: if has_uv { uv } else { NONE },
                normal: if has_normal { normal } else { NONE },
            }
        };
        let mut first = 0;
        let triangles = if mesh.face_arities.is_empty() { mesh.indices.len() / 3 } else { 0 };
        let arities = mesh.face_arities.iter().map(|n| *n as usize).chain(std::iter::repeat_n(3, triangles));
        for arity in arities {
            faces.fill((first..first + arity).map(corner));
            first += arity;
        }
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
    /// A model of pieces whose faces have no corners yet.
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
