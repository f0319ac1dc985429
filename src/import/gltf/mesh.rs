//! Meshes as triangles: each primitive is read once, and added once for every node that places it.

use super::document::{Document, Fault, Found, List};
use super::schema::{self, Primitive};
use super::{accessor::Accessor, attribute::Attribute, buffers::Buffers, draco::DracoMesh};
use super::{engine_materials::EngineMaterials, nodes::Placement, schema_data};
use crate::import::progress::{Phase, Steps};
use crate::import::{files::no_memory, tally::Tally, trouble::Trouble};
use crate::scene::{MaterialId, SceneBuilder, SceneError};
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3};

/// Number of vertices between two checks for a cancellation.
const STEP_VERTICES: usize = 1 << 16;

/// Adds meshes to a builder.
pub(super) struct Mesher<'a, 't> {
    pub(super) document: &'a Document<'t>,
    pub(super) buffers: &'a Buffers<'t>,
    pub(super) materials: EngineMaterials,
    pub(super) builder: &'a mut SceneBuilder,
    pub(super) tally: &'a mut Tally,
    pub(super) steps: &'a Steps<'a>,
    /// Maximum number of vertices, and of triangles, of all instances together.
    pub(super) limit: usize,
}

/// A primitive in the space of its mesh.
struct Local {
    positions: Vec<Vec3>,
    /// Unit vectors; zero where the face normal applies.
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
    material: MaterialId,
}

/// Where the attributes of a primitive are from: its accessors, or a compressed mesh with the
/// numbers of its attributes there.
struct Source<'a> {
    attributes: &'a schema::Attributes,
    compressed: Option<&'a (DracoMesh, schema::Attributes)>,
}

/// Why a primitive is not added.
enum Stop {
    /// It has a trouble, and is left out.
    Primitive(Fault),
    /// The import ends.
    Import(SceneError),
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Self::Primitive(fault)
    }
}

impl From<SceneError> for Stop {
    fn from(error: SceneError) -> Self {
        Self::Import(error)
    }
}

impl<'a> Mesher<'a, '_> {
    /// Adds the instances of all meshes, sorted by mesh.
    pub(super) fn add_all(&mut self, placements: &[Placement]) -> Result<(), SceneError> {
        let mut done = 0;
        for places in placements.chunk_by(|a, b| a.mesh == b.mesh) {
            self.steps.at(Phase::Building, done as f32 / placements.len() as f32)?;
            done += places.len();
            self.mesh(places)?;
        }
        Ok(())
    }

    fn mesh(&mut self, places: &[Placement]) -> Result<(), SceneError> {
        let index = places[0].mesh;
        let found = self.document.item::<schema::Mesh>(List::Meshes, index);
        let Some(mesh) = self.known(found) else { return Ok(()) };
        let name = mesh.name.unwrap_or_else(|| format!("meshes[{index}]"));
        for (i, raw) in mesh.primitives.iter().enumerate() {
            self.steps.at(Phase::Building, 0.0)?;
            let name = || format!("primitive {i} of {name}");
            let found = self.document.read::<Primitive>(raw, name);
            let Some(primitive) = self.known(found) else { continue };
            match self.local(&primitive, self.document.at(raw), &name) {
                Ok(local) => self.place(&local, places)?,
                Err(Stop::Primitive(fault)) => self.document.note(fault, self.tally),
                Err(Stop::Import(error)) => return Err(error),
            }
        }
        Ok(())
    }

    fn note(&mut self, trouble: Trouble, at: usize, detail: String) {
        self.document.note(Fault { trouble, at, detail }, self.tally);
    }

    /// Returns an item; `None` where it has a trouble, which is counted.
    fn known<T>(&mut self, found: Found<T>) -> Option<T> {
        found.map_err(|fault| self.document.note(fault, self.tally)).ok()
    }

    /// Reads a primitive.
    fn local(&mut self, primitive: &Primitive, at: usize, name: &dyn Fn() -> String) -> Result<Local, Stop> {
        let fault = |trouble| Fault { trouble, at, detail: name() };
        let mode = primitive.mode.unwrap_or(4);
        if mode < 4 {
            return Err(fault(Trouble::LINE_OR_POINT).into());
        }
        if mode > 6 {
            return Err(fault(Trouble::MODE).into());
        }
        let position = primitive.attributes.position.ok_or_else(|| fault(Trouble::NO_POSITION))?;
        let stored = Attribute::open(self.document, self.buffers, position, "VEC3");
        let compressed = self.compressed(primitive, stored.as_ref(), at, name)?;
        let source = Source { compressed: compressed.as_ref(), attributes: &primitive.attributes };
        let positions = match &source.compressed {
            Some((mesh, ids)) => {
                let id = ids.position.ok_or_else(|| fault(Trouble::NO_POSITION))?;
                Attribute::of(mesh, id, self.document, position, 3)?
            }
            None => stored?,
        };
        let mut triangles = match &source.compressed {
            Some((mesh, _)) => mesh.triangles.clone(),
            None => triangles_of(mode, &self.corners(primitive, positions.count())?),
        };
        let all = triangles.len();
        triangles.retain(|t| t.iter().all(|v| (*v as usize) < positions.count()));
        if triangles.len() < all {
            let missing = format!("{} of {}, {} vertices", all - triangles.len(), name(), positions.count());
            self.note(Trouble::TRIANGLE_VERTEX, at, missing);
        }
        if primitive.targets.is_some() {
            self.note(Trouble::MORPH, at, name());
        }
        if primitive.attributes.color_0.is_some() {
            self.note(Trouble::VERTEX_COLOR, at, name());
        }
        let (material, uv_set) =
            self.materials.material(primitive.material, self.document, self.builder, self.tally);
        let has_uvs = |set: u32| primitive.attributes.uvs(set).is_some();
        if let Some(set) = uv_set.filter(|set| !has_uvs(*set)) {
            self.note(Trouble::NO_UV_SET, at, format!("{}, TEXCOORD_{set}", name()));
        }
        Ok(self.vertices(&source, &positions, triangles, material, uv_set))
    }

    /// Decodes the mesh of a compressed primitive, unless it is stored in plain form as well.
    fn compressed(
        &mut self,
        primitive: &Primitive,
        stored: Result<&Attribute, &Fault>,
        at: usize,
        name: &dyn Fn() -> String,
    ) -> Result<Option<(DracoMesh, schema::Attributes)>, Stop> {
        let has_data = |stored: &Attribute| matches!(stored, Attribute::Stored(a) if a.has_data());
        let Some(raw) = primitive.extensions.draco.filter(|_| !stored.is_ok_and(has_data)) else {
            return Ok(None);
        };
        let draco = self.document.read::<schema_data::Draco>(raw, name)?;
        let (bytes, _) = self.buffers.view(self.document, draco.buffer_view)?;
        self.steps.at(Phase::Building, 0.0)?;
        let mesh = DracoMesh::decode(bytes, self.limit).map_err(|cause| {
            let detail = format!("{}: {cause}", name());
            Fault { trouble: Trouble::COMPRESSED, at, detail }
        })?;
        self.within(mesh.count.max(mesh.triangles.len()))?;
        Ok(Some((mesh, draco.attributes)))
    }

    /// Returns the vertex of every corner in the order of the file.
    fn corners(&mut self, primitive: &Primitive, vertices: usize) -> Result<Vec<u32>, Stop> {
        let open = |i| Accessor::open(self.document, self.buffers, i, "SCALAR");
        let indices = primitive.indices.map(open).transpose()?;
        let count = indices.as_ref().map_or(vertices, |i| i.count);
        self.within(count.div_ceil(3))?;
        let mut corners = Vec::new();
        corners.try_reserve_exact(count).map_err(|_| self.no_memory(count))?;
        for from in (0..count).step_by(STEP_VERTICES) {
            self.steps.at(Phase::Building, 0.0)?;
            let part = from as u32..count.min(from + STEP_VERTICES) as u32;
            corners.extend(part.map(|i| indices.as_ref().map_or(i, |indices| indices.index(i))));
        }
        Ok(corners)
    }

    /// Returns only the vertices that the triangles use: exporters often write one large buffer for
    /// many primitives.
    fn vertices(
        &mut self,
        source: &Source,
        positions: &Attribute,
        mut triangles: Vec<[u32; 3]>,
        material: MaterialId,
        uv_set: Option<u32>,
    ) -> Local {
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let (low, high) = (used.first().copied().unwrap_or(0), used.last().copied().unwrap_or(0));
        let is_whole = used.len() as u64 == u64::from(high - low) + 1;
        let place = |v: u32| if is_whole { v - low } else { used.binary_search(&v).unwrap_or(0) as u32 };
        for t in &mut triangles {
            *t = t.map(place);
        }
        let normals = self.optional(source, |attributes| attributes.normal, "VEC3");
        let uvs = self.optional(source, |attributes| attributes.uvs(uv_set?), "VEC2");
        let normal = |v: u32| normals.as_ref().map_or(Vec3::ZERO, |n| Vec3::from_array(n.vector(v)));
        // In glTF, v grows downwards from the top of a picture.
        let uv = |v: u32| uvs.as_ref().map_or(Vec2::ZERO, |uv| up(uv.vector(v)));
        Local {
            positions: used.iter().map(|&v| Vec3::from_array(positions.vector(v))).collect(),
            normals: used.iter().map(|&v| normal(v)).collect(),
            uvs: used.iter().map(|&v| uv(v)).collect(),
            triangles,
            material,
        }
    }

    /// Opens an attribute without which the primitive can still be shown.
    fn optional(
        &mut self,
        source: &Source,
        which: impl Fn(&schema::Attributes) -> Option<usize>,
        shape: &str,
    ) -> Option<Attribute<'a>> {
        let accessor = which(source.attributes)?;
        let width = if shape == "VEC2" { 2 } else { 3 };
        self.known(match source.compressed {
            Some((mesh, ids)) => Attribute::of(mesh, which(ids)?, self.document, accessor, width),
            None => Attribute::open(self.document, self.buffers, accessor, shape),
        })
    }

    fn place(&mut self, local: &Local, places: &[Placement]) -> Result<(), SceneError> {
        let more = local.positions.len().max(local.triangles.len());
        self.within(more.saturating_mul(places.len()))?;
        for placement in places {
            let vertices = local.positions.len();
            let reserved = self.builder.positions.try_reserve(vertices);
            reserved.map_err(|_| self.no_memory(vertices))?;
            let first = self.builder.triangles.len() as u32;
            self.builder.objects.begin(first, Some(placement.object));
            self.bake(local, &placement.world_from_mesh)?;
        }
        Ok(())
    }

    fn bake(&mut self, local: &Local, world: &DMat4) -> Result<(), SceneError> {
        let base = self.builder.positions.len() as u32;
        let linear = DMat3::from_mat4(*world);
        // Normals transform with the inverse transpose, here as cofactors: their scale does not
        // matter, and their sign is that of the winding.
        let mirrored = linear.determinant() < 0.0;
        let cofactors = DMat3::from_cols(
            linear.y_axis.cross(linear.z_axis),
            linear.z_axis.cross(linear.x_axis),
            linear.x_axis.cross(linear.y_axis),
        );
        let sign = if mirrored { -1.0 } else { 1.0 };
        for (i, position) in local.positions.iter().enumerate() {
            if i % STEP_VERTICES == 0 {
                self.steps.at(Phase::Building, 0.0)?;
            }
            let position_m: DVec3 = world.transform_point3(position.as_dvec3());
            let normal = (cofactors * local.normals[i].as_dvec3() * sign).try_normalize();
            self.builder.add_vertex(position_m, normal.unwrap_or(DVec3::ZERO).as_vec3(), local.uvs[i]);
        }
        for &[a, b, c] in &local.triangles {
            let [b, c] = if mirrored { [c, b] } else { [b, c] };
            self.builder.add_triangle([a, b, c].map(|v| base + v), local.material);
        }
        Ok(())
    }

    fn within(&self, more: usize) -> Result<(), SceneError> {
        let so_far = self.builder.positions.len().max(self.builder.triangles.len());
        let count = so_far.saturating_add(more);
        if count <= self.limit {
            return Ok(());
        }
        let name = self.builder.name.clone();
        Err(SceneError::TooLarge { name, what: "vertices of all instances", count, limit: self.limit })
    }

    fn no_memory(&self, count: usize) -> SceneError {
        no_memory(&self.builder.name, format!("{count} more vertices"))
    }
}

/// Returns a texture coordinate with v upwards; zero where it is not finite.
fn up([u, v]: [f32; 2]) -> Vec2 {
    let up = Vec2::new(u, 1.0 - v);
    if up.is_finite() { up } else { Vec2::ZERO }
}

/// Returns the triangles of a list (mode 4), a strip (5) or a fan (6). Corners that do not make a
/// whole triangle are left out.
fn triangles_of(mode: u32, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        4 => corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        5 => {
            // Every second triangle of a strip has the opposite winding.
            let strip = corners.windows(3).enumerate();
            strip.map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] }).collect()
        }
        _ => corners.windows(2).skip(1).map(|t| [corners[0], t[0], t[1]]).collect(),
    }
}
