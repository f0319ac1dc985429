//! Corners to shared vertices, polygons to triangles: from the file's three lists to the scene's one.

use crate::import::obj::{Model, Polygon};
use crate::import::obj_piece::{Corner, NONE};
use crate::import::polygon::{Filled, Filler};
use crate::import::report::Trouble;
use crate::import::{Phase, Steps};
use crate::scene::{MaterialId, SceneBuilder, SceneError};
use glam::{DVec3, Vec2, Vec3};

/// Corners of faces between two looks at the progress.
const STEP_CORNERS: usize = 1 << 16;

/// Takes a model and its positions in world metres; fills the builder's vertices and triangles. Material numbers
/// stay the model's. The builder must not hold vertices yet.
pub(crate) fn build(
    model: &mut Model,
    positions_m: &[DVec3],
    builder: &mut SceneBuilder,
    steps: &Steps,
) -> Result<(), SceneError> {
    let mut tally = std::mem::take(&mut model.tally);
    let face_count = model.face_count();
    reserve(builder, face_count, positions_m.len())?;
    let mut welder = Welder::new(model, positions_m);
    let mut filler = Filler::new();
    let mut corners_m = Vec::new();
    let mut since = STEP_CORNERS;
    for (i, face) in model.faces().enumerate() {
        since += face.corners.len();
        if since >= STEP_CORNERS {
            since = 0;
            steps.at(Phase::Building, i as f32 / face_count as f32)?;
        }
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
    model.tally = tally;
    Ok(())
}

fn reserve(builder: &mut SceneBuilder, faces: usize, vertices: usize) -> Result<(), SceneError> {
    let reserved = builder
        .triangles
        .try_reserve(faces)
        .and_then(|()| builder.positions.try_reserve(vertices))
        .and_then(|()| builder.triangle_materials.try_reserve(faces));
    reserved.map_err(|_| SceneError::Read {
        file: builder.name.clone().into(),
        cause: format!("there is no memory for its {faces} faces"),
        remedy: "close other programs or split the model".to_owned(),
    })
}

/// A vertex made of a position, and the next one made of the same position.
struct Variant {
    uv: u32,
    normal: u32,
    next: u32,
}

/// Finds vertices again by their three indices. Per position a chain of its variants: no hashing, and the vertices
/// come in the order of their first use.
struct Welder<'a> {
    model: &'a Model,
    positions_m: &'a [DVec3],
    newest: Vec<u32>,
    variants: Vec<Variant>,
}

impl<'a> Welder<'a> {
    /// Real models share a position among a few normals; a file made to be slow gets unshared vertices instead.
    const LONGEST_CHAIN: usize = 64;

    fn new(model: &'a Model, positions_m: &'a [DVec3]) -> Self {
        Self { model, positions_m, newest: vec![NONE; positions_m.len()], variants: Vec::new() }
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
        for _ in 0..Self::LONGEST_CHAIN {
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
        let vertex = builder.add_vertex(self.positions_m[corner.position as usize], normal, uv);
        self.newest[corner.position as usize] = vertex;
        vertex
    }
}
