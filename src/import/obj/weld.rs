//! Welding corners into shared vertices and splitting polygons into triangles: an OBJ file indexes
//! three lists, a scene one.

use super::parse::{Model, Polygon};
use super::piece::{Corner, NONE};
use crate::import::polygon::{Filled, Filler};
use crate::import::progress::{Phase, Steps};
use crate::import::{files::no_memory, trouble::Trouble, vertex_colors::VertexColors};
use crate::scene::{MaterialId, SceneBuilder, SceneError};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Number of corners between two reports of progress.
const STEP_CORNERS: usize = 1 << 16;

/// Adds the vertices and triangles of a model, whose positions are world metres, to a builder
/// without vertices. Material numbers are those of the model. Returns the colours of the vertices.
pub(super) fn build(
    model: &mut Model,
    builder: &mut SceneBuilder,
    steps: &Steps,
) -> Result<VertexColors, SceneError> {
    let mut tally = std::mem::take(&mut model.tally);
    let positions_m = &model.positions;
    let face_count = model.face_count();
    reserve(builder, face_count, positions_m.len())?;
    let mut welder = Welder::new(model);
    let mut filler = Filler::new();
    let mut corners_m = Vec::new();
    let mut since = STEP_CORNERS;
    let mut shapes = Shapes { open: &model.shapes, numbers: HashMap::new() };
    for (i, face) in model.faces().enumerate() {
        since += face.corners.len();
        if since >= STEP_CORNERS {
            since = 0;
            steps.at(Phase::Building, i as f32 / face_count as f32)?;
        }
        shapes.begin(i, builder);
        corners_m.clear();
        corners_m.extend(face.corners.iter().map(|c| positions_m[c.position as usize]));
        if let Some(bad) = corners_m.iter().position(|p| !p.is_finite()) {
            let vertex = face.corners[bad].position + 1;
            tally.add(Trouble::VERTEX_REFUSED, face.line, || format!("vertex {vertex}"));
            continue;
        }
        match filler.fill(&corners_m) {
            Filled::Whole => {}
            Filled::NoArea => tally.add(Trouble::FACE_WITHOUT_AREA, face.line, String::new),
            Filled::Crossed => tally.add(Trouble::FACE_CROSSES_ITSELF, face.line, String::new),
        }
        welder.add(&face, &filler.triangles, builder);
    }
    let colors = welder.colors;
    model.tally = tally;
    Ok(colors)
}

/// The objects of a file that are still to come. Those of one name are one object.
struct Shapes<'a> {
    open: &'a [(usize, String)],
    numbers: HashMap<&'a str, u32>,
}

impl Shapes<'_> {
    /// Begins the object that starts with a face, if one does.
    fn begin(&mut self, face: usize, builder: &mut SceneBuilder) {
        let started = self.open.partition_point(|shape| shape.0 <= face);
        let Some((_, name)) = started.checked_sub(1).map(|last| &self.open[last]) else { return };
        self.open = &self.open[started..];
        let add = || builder.objects.add(name);
        let object = (!name.is_empty()).then(|| *self.numbers.entry(name).or_insert_with(add));
        builder.objects.begin(builder.triangles.len() as u32, object);
    }
}

fn reserve(builder: &mut SceneBuilder, faces: usize, vertices: usize) -> Result<(), SceneError> {
    let reserved = builder
        .triangles
        .try_reserve(faces)
        .and_then(|()| builder.positions.try_reserve(vertices))
        .and_then(|()| builder.triangle_materials.try_reserve(faces));
    reserved.map_err(|_| no_memory(&builder.name, format!("its {faces} faces")))
}

/// A vertex: its texture coordinate and normal, and the next vertex of the same position.
struct Variant {
    uv: u32,
    normal: u32,
    next: u32,
}

/// Finds vertices by their three indices, in a chain per position: this needs no hashing, and
/// vertices are ordered by first use.
struct Welder<'a> {
    model: &'a Model,
    newest: Vec<u32>,
    variants: Vec<Variant>,
    colors: VertexColors,
}

impl<'a> Welder<'a> {
    /// Maximum length of a chain. In real models a few normals share a position; a file made to be
    /// slow gets unshared vertices instead.
    const MAX_CHAIN: usize = 64;

    fn new(model: &'a Model) -> Self {
        Self {
            model,
            newest: vec![NONE; model.positions.len()],
            variants: Vec::new(),
            colors: VertexColors::default(),
        }
    }

    fn add(&mut self, face: &Polygon, triangles: &[[u32; 3]], builder: &mut SceneBuilder) {
        for triangle in triangles {
            let vertices = triangle.map(|i| self.vertex(face.corners[i as usize], builder));
            builder.add_triangle(vertices, MaterialId(face.material));
        }
    }

    fn vertex(&mut self, corner: Corner, builder: &mut SceneBuilder) -> u32 {
        let first = self.newest[corner.position as usize];
        let mut at = first;
        for _ in 0..Self::MAX_CHAIN {
            if at == NONE {
                break;
            }
            let variant = &self.variants[at as usize];
            if variant.uv == corner.uv && variant.normal == corner.normal {
                return at;
            }
            at = variant.next;
        }
        self.variants.push(Variant { uv: corner.uv, normal: corner.normal, next: first });
        let normal = self.model.normals.get(corner.normal as usize).copied().unwrap_or(Vec3::ZERO);
        let uv = self.model.uvs.get(corner.uv as usize).copied().unwrap_or(Vec2::ZERO);
        let vertex = builder.add_vertex(self.model.positions[corner.position as usize], normal, uv);
        self.newest[corner.position as usize] = vertex;
        let color = self.model.colors.binary_search_by_key(&corner.position, |(of, _)| *of);
        if let Ok(at) = color {
            self.colors.set(vertex, self.model.colors[at].1);
        }
        vertex
    }
}
