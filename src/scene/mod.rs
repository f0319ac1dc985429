//! What is rendered, as plain data, and what it asks of the renderer.
//!
//! Everything enters through [`SceneBuilder`]: the importer and the embedded scenes alike.

mod bounds;
pub mod builder;
pub mod builtin;
pub mod conditioning;
mod duplicates;
mod edit;
pub mod features;
mod lights;
pub mod material;
mod sanitize;
mod sky;
pub mod solar;
mod solids;
mod sun;
pub mod texture;

pub use crate::camera::SceneFrame;
pub use builder::{SceneBuilder, SceneError, Warning};
pub use conditioning::{Conditioning, Repairs};
pub use edit::{Daylight, SceneEdit};
pub use features::SceneFeatures;
pub use lights::Light;
pub(crate) use lights::point_on_mesh;
pub use material::{Material, MaterialKind, TextureRef};
pub use sky::Sky;
pub use sun::Sun;
pub use texture::{Encoding, Texture};

use crate::camera::Camera;
use crate::camera::CameraPath;
use glam::{DVec3, Vec2, Vec3};

/// Index into [`Scene::materials`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub u32);

/// Index into [`Scene::textures`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextureId(pub u32);

/// A saved view.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedView {
    /// What the user calls it.
    pub name: String,
    /// Where it looks from.
    pub camera: Camera,
}

/// A scene, ready to be traced. Positions are in scene space.
#[derive(Clone, Debug)]
pub struct Scene {
    /// File stem or `builtin:NAME`.
    pub name: String,
    /// SHA-256 of everything that decides a picture, as lower-case hex.
    pub hash: String,
    /// World <-> scene.
    pub frame: SceneFrame,
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals, or a zero vector where the face normal is meant; empty where no vertex has one.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v up; empty where nothing is textured.
    pub uvs: Vec<Vec2>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Material of each triangle.
    pub triangle_materials: Vec<MaterialId>,
    /// For dielectrics: which triangles bound a solid, and which way it lies; empty without glass.
    pub solids: Vec<SolidSide>,
    /// All materials; at least one.
    pub materials: Vec<Material>,
    /// All textures.
    pub textures: Vec<Texture>,
    /// All lights, emissive surfaces included.
    pub lights: Vec<Light>,
    /// The sun, where there is one. `lights` holds it too.
    pub sun: Option<Sun>,
    /// The sky, where there is one. `lights` holds it too.
    pub sky: Option<Sky>,
    /// Where a visit starts. The first is the start view; never empty.
    pub views: Vec<NamedView>,
    /// The scene's own walk.
    pub walk: CameraPath,
    /// False where the views were made up.
    pub brings_view: bool,
    /// False where the walk was made up.
    pub brings_walk: bool,
    /// What the renderer must do for this scene.
    pub features: SceneFeatures,
    /// Everything doubtful found on the way in.
    pub warnings: Vec<Warning>,
    /// Lower and upper corner, world metres; of the bulk where a few vertices lie far outside.
    pub bounds_m: [DVec3; 2],
    /// Triangles that lie exactly on an earlier one and cannot be told from it, ascending: no ray meets them.
    pub hidden: Vec<u32>,
    /// How hard it is on numbers, and what was mended.
    pub conditioning: Conditioning,
}

/// How a triangle of a dielectric bounds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolidSide {
    /// Part of an open sheet: light passes straight through.
    Thin,
    /// Part of a closed body whose inside lies behind the triangle (against its geometric normal).
    InsideBehind,
    /// Part of a closed body whose inside lies in front of the triangle.
    InsideInFront,
}

impl Scene {
    /// The three corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// The material of a triangle.
    pub fn material_of(&self, triangle: u32) -> &Material {
        &self.materials[self.triangle_materials[triangle as usize].0 as usize]
    }

    /// The start view.
    pub fn start(&self) -> &Camera {
        &self.views[0].camera
    }
}
