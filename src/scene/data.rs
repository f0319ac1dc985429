//! The complete scene.

use super::daylight::nits_per_unit;
use super::light_groups::{LampGroup, LightGroups, LightSettings};
use super::{
    Conditioning, EditedObjects, GroundedGeometry, Light, Material, MaterialId, NamedView, Objects,
    SceneFeatures, SceneFrame, Sky, SourceFile, Sun, Texture, Warning,
};
use crate::camera::{Camera, CameraPath};
use crate::raster::exposure::Exposure;
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// A scene that is ready to be traced. Positions are in scene space unless a field says otherwise.
///
/// Geometry and textures are shared by the states of a scene whose materials or lights differ.
#[derive(Clone, Debug)]
pub struct Scene {
    /// File stem of the model, or `builtin:NAME`.
    pub name: String,
    /// SHA-256 of everything that decides a picture, as lower-case hexadecimal digits.
    pub hash: String,
    /// Transform between world and scene space.
    pub frame: SceneFrame,
    /// Vertex positions.
    pub positions: Arc<Vec<Vec3>>,
    /// Unit vertex normals. A zero vector stands for the face normal. Empty if all of them are
    /// zero.
    pub normals: Arc<Vec<Vec3>>,
    /// Texture coordinates, with v pointing up. Empty if no material has a texture.
    pub uvs: Arc<Vec<Vec2>>,
    /// Vertex indices of each triangle.
    pub triangles: Arc<Vec<[u32; 3]>>,
    /// Material of each triangle.
    pub triangle_materials: Arc<Vec<MaterialId>>,
    /// The named objects that the triangles belong to.
    pub objects: Arc<Objects>,
    /// The edits of objects, and what was loaded; `None` where that is what is here.
    pub edited_objects: Option<Arc<EditedObjects>>,
    /// The ground that was added, and the geometry without it; `None` where there is no such
    /// ground. Its triangles and its material are the last ones.
    pub grounded: Option<Arc<GroundedGeometry>>,
    /// True where the scene's files say which ground there is, or that there is none.
    pub is_ground_given: bool,
    /// How each triangle bounds a solid of glass. Empty if the scene has no glass; the entries of
    /// triangles that are not glass have no meaning.
    pub solids: Vec<SolidSide>,
    /// All materials, at least one.
    pub materials: Vec<Material>,
    /// All textures.
    pub textures: Arc<Vec<Texture>>,
    /// All lights: emissive surfaces first, then point lights, the sun and the sky.
    pub lights: Vec<Light>,
    /// Emissive triangles, ascending, each with the index of its light.
    pub lamp_triangles: Vec<[u32; 2]>,
    /// The sun, if there is one. `lights` holds it as well.
    pub sun: Option<Sun>,
    /// The sky, if there is one. `lights` holds it as well.
    pub sky: Option<Sky>,
    /// The groups in which the lights can be dimmed.
    pub light_groups: LightGroups,
    /// Groups of lamps that the user has put together.
    pub lamp_groups: Vec<LampGroup>,
    /// How the groups are set. Materials, lights, sun and sky of this scene follow from it.
    pub light_settings: LightSettings,
    /// The scene with all lights as the files have them; `None` where this is it.
    pub full: Option<Arc<Scene>>,
    /// True where the model gives its lights in photometric units.
    pub is_photometric: bool,
    /// Views offered to the user, at least one. The first is the start view.
    pub views: Vec<NamedView>,
    /// The camera path of the scene.
    pub walk: CameraPath,
    /// Exposure at which the scene is shown unless the user gives one.
    pub exposure: Exposure,
    /// False if the model had no view and one was generated.
    pub brings_view: bool,
    /// False if the model had no camera path and one was generated.
    pub brings_walk: bool,
    /// The features of the renderer that this scene uses.
    pub features: SceneFeatures,
    /// The problems found while the scene was imported and built.
    pub warnings: Vec<Warning>,
    /// The files that the scene was read from, the model first; empty for scenes without files.
    pub files: Arc<Vec<SourceFile>>,
    /// Lower and upper corner of the bounding box, in world metres. If a few vertices lie far
    /// outside, it is the box of the others.
    pub bounds_m: [DVec3; 2],
    /// Lower and upper corner of the box of the building, in world metres: of the model without the
    /// ground around it and without a few objects far away. Start view, speed of flight and plan
    /// follow it. `scene/building/` has the rule.
    pub building_m: [DVec3; 2],
    /// Triangles that coincide with an earlier one and look the same, ascending. Rays ignore them.
    pub hidden: Vec<u32>,
    /// For each triangle, whether it may lie on one of another material; empty where none does.
    pub coincident: Arc<Vec<bool>>,
    /// How demanding the scene is numerically, and what was repaired.
    pub conditioning: Conditioning,
}

/// How a triangle of glass bounds a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolidSide {
    /// The triangle belongs to an open sheet. Light passes straight through.
    Thin,
    /// The triangle belongs to a closed solid whose inside lies behind it, against its geometric
    /// normal.
    InsideBehind,
    /// The triangle belongs to a closed solid whose inside lies in front of it.
    InsideInFront,
}

impl Scene {
    /// Returns the three corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// Returns the material of a triangle.
    pub fn material_of(&self, triangle: u32) -> &Material {
        &self.materials[self.triangle_materials[triangle as usize].0 as usize]
    }

    /// Returns the index of the light that a triangle belongs to; `None` where it emits nothing.
    pub(crate) fn lamp_of_triangle(&self, triangle: u32) -> Option<u32> {
        let at = self.lamp_triangles.binary_search_by_key(&triangle, |lamp| lamp[0]).ok()?;
        Some(self.lamp_triangles[at][1])
    }

    /// Returns the indices of all triangles.
    pub(super) fn triangle_indices(&self) -> std::ops::Range<u32> {
        0..self.triangles.len() as u32
    }

    /// Returns the luminance in cd/m2 of a radiance of one: 1 where the model gives its lights in
    /// photometric units, else 10,000, so that a clear day is bright at an exposure of 0.
    pub fn nits_per_unit(&self) -> f32 {
        nits_per_unit(self.is_photometric)
    }

    /// True where a triangle may lie on one of another material.
    pub fn is_coincident(&self, triangle: u32) -> bool {
        self.coincident.get(triangle as usize).is_some_and(|is| *is)
    }

    /// Returns the camera of the start view.
    pub fn start(&self) -> &Camera {
        &self.views[0].camera
    }
}
