//! From a model in world metres to a [`Scene`]: everything doubtful is dropped and counted here, once.

use super::duplicates::Duplicates;
use super::{
    Conditioning, Light, Material, MaterialId, NamedView, Scene, SceneFrame, Sky, Sun, Texture, bounds,
    lights, solids,
};
use crate::camera::Camera;
use crate::camera::{CameraKey, CameraPath};
use crate::scene::{SceneFeatures, sanitize};
use glam::{DQuat, DVec3, Vec2, Vec3};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::path::PathBuf;

/// Why there is no scene. Every message names what, where and what to do.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file could not be read.
    #[error("{file}: {cause}; {remedy}", file = file.display())]
    Read {
        /// Which file.
        file: PathBuf,
        /// What the system or the decoder said.
        cause: String,
        /// What the user can do.
        remedy: String,
    },
    /// A line of a file makes the rest meaningless.
    #[error("{file}, line {line}: {cause}; {remedy}", file = file.display())]
    Line {
        /// Which file.
        file: PathBuf,
        /// From 1.
        line: u64,
        /// What is wrong.
        cause: String,
        /// What the user can do.
        remedy: String,
    },
    /// Nothing to look at.
    #[error(
        "{name}: no triangle is left to show ({dropped} dropped); check that the file holds faces with an area"
    )]
    Empty {
        /// The scene.
        name: String,
        /// Triangles that were dropped.
        dropped: usize,
    },
    /// More than the engine's indices can name.
    #[error("{name}: {count} {what}, at most {limit} are supported; split the model")]
    TooLarge {
        /// The scene.
        name: String,
        /// Of these things.
        what: &'static str,
        /// So many.
        count: usize,
        /// And so many are possible.
        limit: usize,
    },
    /// No such embedded scene.
    #[error("there is no embedded scene '{name}'; there are {known}")]
    UnknownBuiltin {
        /// As asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// The user stopped it.
    #[error("loading was cancelled")]
    Cancelled,
}

/// Something doubtful that did not stop the import.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// Where it was found, relative to the scene's folder where possible; empty where no file is meant.
    pub file: String,
    /// From 1; 0 where no line is meant.
    pub line: u64,
    /// What, and what was done about it.
    pub message: String,
}

/// A scene in the making: world metres, +Y up.
#[derive(Clone, Debug, Default)]
pub struct SceneBuilder {
    /// File stem or `builtin:NAME`.
    pub name: String,
    /// Vertex positions, world metres.
    pub positions: Vec<DVec3>,
    /// Unit normals, zero where the face normal is meant; empty or one per position.
    pub normals: Vec<Vec3>,
    /// Texture coordinates; empty or one per position.
    pub uvs: Vec<Vec2>,
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// One per triangle.
    pub triangle_materials: Vec<MaterialId>,
    /// All materials.
    pub materials: Vec<Material>,
    /// All textures.
    pub textures: Vec<Texture>,
    /// Point lights: world position, intensity in radiance * square metres.
    pub point_lights: Vec<(DVec3, Vec3)>,
    /// A sun.
    pub sun: Option<Sun>,
    /// A sky.
    pub sky: Option<Sky>,
    /// Saved views.
    pub views: Vec<NamedView>,
    /// The scene's walk.
    pub walk: Option<CameraPath>,
    /// What was doubtful so far.
    pub warnings: Vec<Warning>,
}

impl SceneBuilder {
    /// An empty scene.
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    /// Adds a material.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a texture.
    pub fn add_texture(&mut self, texture: Texture) -> super::TextureId {
        self.textures.push(texture);
        super::TextureId(self.textures.len() as u32 - 1)
    }

    /// Adds a vertex. `normal` may be zero: then the face's own normal is meant.
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

    /// Adds a flat quad, corners counter-clockwise seen from the front, with texture coordinates 0..`uv_size`.
    pub fn add_quad(&mut self, corners_m: [DVec3; 4], uv_size: Vec2, material: MaterialId) {
        let uvs = [Vec2::ZERO, Vec2::new(uv_size.x, 0.0), uv_size, Vec2::new(0.0, uv_size.y)];
        let v: [u32; 4] = std::array::from_fn(|i| self.add_vertex(corners_m[i], Vec3::ZERO, uvs[i]));
        self.add_triangle([v[0], v[1], v[2]], material);
        self.add_triangle([v[0], v[2], v[3]], material);
    }

    /// Notes something doubtful.
    pub fn warn(&mut self, file: &str, line: u64, message: impl Into<String>) {
        self.warnings.push(Warning { file: file.to_owned(), line, message: message.into() });
    }

    /// Normalises, drops what cannot be traced, finds lights and solids.
    ///
    /// # Errors
    /// [`SceneError::Empty`] where no triangle is left, [`SceneError::TooLarge`] beyond 2^32 - 2 vertices or 2^31
    /// triangles.
    pub fn finish(mut self) -> Result<Scene, SceneError> {
        self.check_sizes()?;
        if self.materials.is_empty() {
            self.add_material(Material::diffuse("default", Vec3::splat(0.6)));
        }
        let mut repairs = sanitize::sanitize(&mut self);
        repairs.triangles_not_finite = self.drop_untraceable(
            |b, t| t.iter().all(|&v| b.positions.get(v as usize).is_some_and(|p| is_place(*p))),
            "with a vertex that is missing, not finite or farther than 1e100 m away",
        );
        let (bounds_m, ignores_outliers) =
            bounds::of(&self.positions, &self.triangles).ok_or_else(|| self.empty_error())?;
        repairs.ignores_outliers = ignores_outliers;
        let frame = bounds::frame_for(bounds_m);
        if repairs.ignores_outliers {
            repairs.triangles_not_finite += self.drop_the_absurdly_far(&frame);
        }
        let positions: Vec<Vec3> =
            self.positions.iter().map(|&p| frame.scene_from_world_f64(p).as_vec3()).collect();
        repairs.triangles_without_area =
            self.drop_untraceable(|_, t| has_area(t.map(|v| positions[v as usize])), "without area");
        if self.triangles.is_empty() {
            return Err(self.empty_error());
        }
        let duplicates =
            Duplicates::find(&positions, &self.triangles, &self.triangle_materials, &self.materials);
        (repairs.duplicates_hidden, repairs.duplicates_seen) = (duplicates.hidden.len(), duplicates.seen);
        let lights = self.lights(&positions, &frame);
        let features = SceneFeatures::of(&self.materials, &lights, self.sky.as_ref(), false);
        let solids = solids::classify(&positions, &self.triangles, &self.triangle_materials, &self.materials);
        let (walk, [brings_view, brings_walk]) = self.visit(bounds_m);
        let mut scene = Scene {
            name: self.name,
            hash: String::new(),
            frame,
            normals: if self.normals.iter().any(|n| *n != Vec3::ZERO) { self.normals } else { Vec::new() },
            uvs: if features.textures || features.alpha { self.uvs } else { Vec::new() },
            positions,
            triangles: self.triangles,
            triangle_materials: self.triangle_materials,
            solids,
            materials: self.materials,
            textures: self.textures,
            lights,
            sun: self.sun,
            sky: self.sky,
            views: self.views,
            walk,
            brings_view,
            brings_walk,
            features,
            warnings: self.warnings,
            bounds_m,
            hidden: duplicates.hidden,
            conditioning: Conditioning::default(),
        };
        scene.hash = hash_of(&scene);
        scene.set_conditioning(repairs);
        Ok(scene)
    }

    /// Makes up the view and the walk that the model does not bring. Told is which of the two it brings.
    fn visit(&mut self, bounds_m: [DVec3; 2]) -> (CameraPath, [bool; 2]) {
        let own_view = self.views.first().map(|view| view.camera);
        if own_view.is_none() {
            self.views.push(NamedView { name: "start".to_owned(), camera: overview(bounds_m) });
        }
        let brings = [own_view.is_some(), self.walk.is_some()];
        let usual_walk = || own_view.map_or_else(|| orbit(bounds_m), |camera| CameraPath::turning(&camera));
        (self.walk.take().unwrap_or_else(usual_walk), brings)
    }

    fn check_sizes(&self) -> Result<(), SceneError> {
        let too_large = |what, count, limit| {
            if count <= limit {
                return Ok(());
            }
            Err(SceneError::TooLarge { name: self.name.clone(), what, count, limit })
        };
        too_large("vertices", self.positions.len(), u32::MAX as usize - 1)?;
        too_large("triangles", self.triangles.len(), i32::MAX as usize)
    }

    /// Drops triangles whose products would overflow, and says that others lie far outside.
    fn drop_the_absurdly_far(&mut self, frame: &SceneFrame) -> usize {
        /// Scene units. Products of three coordinates stay below the largest f32.
        const FARTHEST: f64 = (1u64 << 40) as f64;
        let name = self.name.clone();
        self.warn(&name, 0, "a few vertices lie far outside the rest; centre, scale and views ignore them");
        let is_near = |b: &Self, v: u32| {
            frame.scene_from_world_f64(b.positions[v as usize]).abs().max_element() < FARTHEST
        };
        self.drop_untraceable(|b, t| t.iter().all(|&v| is_near(b, v)), "too far from all others")
    }

    /// Drops triangles and returns how many.
    fn drop_untraceable(&mut self, keep: impl Fn(&Self, [u32; 3]) -> bool, what: &str) -> usize {
        let kept: Vec<bool> = self.triangles.iter().map(|&t| keep(self, t)).collect();
        self.keep_only(&kept, what)
    }

    /// Drops the triangles not kept, says so, and returns how many.
    fn keep_only(&mut self, kept: &[bool], what: &str) -> usize {
        let dropped = kept.iter().filter(|k| !**k).count();
        if dropped == 0 {
            return 0;
        }
        let mut of_triangle = kept.iter();
        self.triangles.retain(|_| of_triangle.next() == Some(&true));
        let mut of_material = kept.iter();
        self.triangle_materials.retain(|_| of_material.next() == Some(&true));
        let name = self.name.clone();
        self.warn(&name, 0, format!("{dropped} triangles {what} were left out"));
        dropped
    }

    fn empty_error(&self) -> SceneError {
        SceneError::Empty { name: self.name.clone(), dropped: self.warnings.len() }
    }

    fn lights(&mut self, positions: &[Vec3], frame: &SceneFrame) -> Vec<Light> {
        let mut found = lights::from_emissive_triangles(
            positions,
            &self.triangles,
            &self.triangle_materials,
            &self.materials,
        );
        let square = (frame.units_per_metre * frame.units_per_metre) as f32;
        for &(position, intensity) in &self.point_lights {
            let position = frame.scene_from_world_f64(position).as_vec3();
            found.push(Light::Point { position, intensity: intensity * square });
        }
        if found.is_empty() && self.sun.is_none() && self.sky.is_none() {
            self.sun = Some(Sun::clear_day());
            self.sky = Some(Sky::CLEAR_DAY);
            let name = self.name.clone();
            self.warn(&name, 0, "the scene has no light; a sun and a sky were added");
        }
        found.extend(self.sun.map(Light::from));
        if self.sky.is_some() {
            found.push(Light::Sky);
        }
        found
    }
}

/// Beyond it, squares of lengths overflow.
const FARTHEST_M: f64 = 1e100;

/// True for a point that something can be.
pub(crate) fn is_place(p: DVec3) -> bool {
    p.abs().max_element() <= FARTHEST_M && p.is_finite()
}

/// True where the cross product of two edges, computed in f64 from the very f32 corners, is not zero.
fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    (b - a).cross(c - a).length_squared() > 0.0
}

/// A view of the whole model from outside, for a model that brings no view of its own.
fn overview([low, high]: [DVec3; 2]) -> Camera {
    let centre = low + (high - low) / 2.0;
    let distance = (high - low).length();
    Camera::look_at(centre + DVec3::new(0.5, 0.35, 0.8) * distance, centre, Camera::DEFAULT_FOV_Y_DEG)
}

/// Once around the model from outside, beginning at its [`overview`], for one that brings neither view nor walk.
fn orbit([low, high]: [DVec3; 2]) -> CameraPath {
    const KEYS: i32 = 16;
    let start = overview([low, high]);
    let centre = low + (high - low) / 2.0;
    let key = |i: i32| {
        let turn = DQuat::from_rotation_y(f64::from(i) * std::f64::consts::TAU / f64::from(KEYS));
        CameraKey { eye: centre + turn * (start.eye - centre), at: centre }
    };
    CameraPath { fov_y_deg: start.fov_y.to_degrees(), frames: 240, keyframes: (0..=KEYS).map(key).collect() }
}

/// SHA-256 of what decides a picture. Views, walk and warnings do not.
pub(super) fn hash_of(scene: &Scene) -> String {
    let mut sha = Sha256::new();
    sha.update(bytemuck::cast_slice(&scene.positions));
    sha.update(bytemuck::cast_slice(&scene.normals));
    sha.update(bytemuck::cast_slice(&scene.uvs));
    sha.update(bytemuck::cast_slice(&scene.triangles));
    scene.triangle_materials.iter().for_each(|m| sha.update(m.0.to_le_bytes()));
    sha.update(format!("{:?}{:?}{:?}{:?}", scene.frame, scene.materials, scene.lights, scene.sky));
    for t in &scene.textures {
        sha.update(format!("{}x{} {:?}", t.width, t.height, t.encoding));
        sha.update(bytemuck::cast_slice(&t.texels));
    }
    sha.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
