//! A scene while it is being put together.

use super::daylight::nits_per_unit;
use super::light_groups::{LampGroup, LightSettings};
use super::{
    Material, MaterialId, NamedView, Objects, ProfileLight, Sky, SourceFile, SpotLight, Sun, Texture,
    TextureId, Warning,
};
use crate::camera::CameraPath;
use crate::raster::exposure::Exposure;
use glam::{DVec3, Vec2, Vec3};

/// A scene while it is being put together, in world metres with +Y up. [`SceneBuilder::finish`]
/// makes a [`Scene`](super::Scene) from it.
#[derive(Clone, Debug, Default)]
pub struct SceneBuilder {
    /// File stem of the model, or `builtin:NAME`.
    pub name: String,
    /// Vertex positions in world metres.
    pub positions: Vec<DVec3>,
    /// Unit vertex normals, one per position or none at all. A zero vector stands for the face
    /// normal.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one per position or none at all.
    pub uvs: Vec<Vec2>,
    /// Vertex indices of each triangle, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Material of each triangle.
    pub triangle_materials: Vec<MaterialId>,
    /// The named objects that the triangles belong to.
    pub objects: Objects,
    /// All materials.
    pub materials: Vec<Material>,
    /// All textures.
    pub textures: Vec<Texture>,
    /// Point lights: position in world metres, and intensity in radiance times square metres.
    pub point_lights: Vec<(DVec3, Vec3)>,
    /// Spot lights.
    pub spot_lights: Vec<SpotLight>,
    /// Lamps whose light was measured by direction.
    pub profile_lights: Vec<ProfileLight>,
    /// The sun.
    pub sun: Option<Sun>,
    /// The sky.
    pub sky: Option<Sky>,
    /// True where the files say that there is no sun: none is added to a dark scene.
    pub is_sun_off: bool,
    /// True where the files say that there is no sky: none is added to a dark scene.
    pub is_sky_off: bool,
    /// Groups of lamps that the user has put together.
    pub lamp_groups: Vec<LampGroup>,
    /// How the groups of lights are set.
    pub light_settings: LightSettings,
    /// True where the model gives its lights in photometric units: candela, lux and cd/m2.
    pub is_photometric: bool,
    /// Views offered to the user.
    pub views: Vec<NamedView>,
    /// The camera path of the scene.
    pub walk: Option<CameraPath>,
    /// Exposure at which the scene is shown unless the user gives one.
    pub exposure: Exposure,
    /// The problems found so far.
    pub warnings: Vec<Warning>,
    /// The files that the scene is read from.
    pub files: Vec<SourceFile>,
}

impl SceneBuilder {
    /// Returns an empty scene.
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    /// Adds a material and returns its index.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a texture and returns its index.
    pub fn add_texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// Adds a vertex and returns its index. A zero `normal` stands for the face normal.
    pub fn add_vertex(&mut self, position_m: DVec3, normal: Vec3, uv: Vec2) -> u32 {
        self.positions.push(position_m);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }

    /// Adds a triangle.
    pub fn add_triangle(&mut self, vertices: [u32; 3], material: MaterialId) {
        self.triangles.push(vertices);
        self.triangle_materials.push(material);
    }

    /// Begins an object: the triangles that are added from now on belong to it.
    pub fn begin_object(&mut self, name: &str) {
        let object = self.objects.add(name);
        self.objects.begin(self.triangles.len() as u32, Some(object));
    }

    /// Ends an object: the triangles that are added from now on belong to none.
    pub fn end_object(&mut self) {
        self.objects.begin(self.triangles.len() as u32, None);
    }

    /// Adds a flat quadrilateral. The corners run counter-clockwise seen from the front, and the
    /// texture coordinates from zero at the first corner to `uv_size` at the third.
    pub fn add_quad(&mut self, corners_m: [DVec3; 4], uv_size: Vec2, material: MaterialId) {
        let uvs = [Vec2::ZERO, Vec2::new(uv_size.x, 0.0), uv_size, Vec2::new(0.0, uv_size.y)];
        let v: [u32; 4] = std::array::from_fn(|i| self.add_vertex(corners_m[i], Vec3::ZERO, uvs[i]));
        self.add_triangle([v[0], v[1], v[2]], material);
        self.add_triangle([v[0], v[2], v[3]], material);
    }

    /// Returns the luminance in cd/m2 of a radiance of one.
    pub fn nits_per_unit(&self) -> f32 {
        nits_per_unit(self.is_photometric)
    }

    /// Adds the light of a clear day, without the part that the files switch off. Returns what was
    /// added, in words; `None` where both parts are off.
    pub(super) fn add_clear_day(&mut self) -> Option<&'static str> {
        self.sun = (!self.is_sun_off).then(Sun::clear_day);
        self.sky = (!self.is_sky_off).then_some(Sky::CLEAR_DAY);
        match (self.is_sun_off, self.is_sky_off) {
            (false, false) => Some("a sun and a sky were added"),
            (false, true) => Some("a sun was added"),
            (true, false) => Some("a sky was added"),
            (true, true) => None,
        }
    }

    /// Records a problem of the model.
    pub fn warn(&mut self, file: &str, line: u64, message: impl Into<String>) {
        self.warnings.push(Warning { file: file.to_owned(), line, message: message.into() });
    }

    /// Records a problem of the scene as a whole.
    pub(super) fn warn_of_scene(&mut self, message: String) {
        self.warnings.push(Warning { file: self.name.clone(), line: 0, message });
    }
}
