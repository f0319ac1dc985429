//! The scene, as panels show it.

use crate::window::input::fly_camera::speed_for;
use crate::window::rendering::SceneSource;
use afterimage::camera::CameraPath;
use afterimage::scene::{
    Ground, GroundAdvice, LightGroup, Material, MaterialId, Objects, Scene, SceneFeatures, Warning,
};
use afterimage::{Camera, Tracer};
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;

/// A saved view of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SavedView {
    /// Name of the view, as the list shows it.
    pub name: String,
    /// Pose and field of view of the camera.
    pub camera: Camera,
    /// Number of the key that goes to the view, 1 to 9.
    pub key: Option<u8>,
}

/// The scene, as panels show it.
#[derive(Clone, Debug)]
pub struct SceneInfo {
    /// Name of the scene, as the window shows it.
    pub name: String,
    /// Where the scene was loaded from.
    pub source: SceneSource,
    /// Views that the files of the scene hold, the start view first.
    pub views: Vec<SavedView>,
    /// Camera path of the scene, used until the user sets keys.
    pub walk: CameraPath,
    /// Warnings of the import, listed in the Scene panel.
    pub warnings: Vec<Warning>,
    /// Materials by name, where several have the same one.
    pub same_names: Arc<HashMap<String, Vec<MaterialId>>>,
    /// Named objects of the model, also those that are hidden or deleted.
    pub objects: Arc<Objects>,
    /// Number of triangles of the scene.
    pub triangles: usize,
    /// Number of vertices of the scene.
    pub vertices: usize,
    /// Number of lights of the scene.
    pub lights: usize,
    /// Groups in which the lights can be dimmed.
    pub light_groups: Vec<LightGroup>,
    /// Numerical conditioning of the scene, in sentences.
    pub conditioning: Vec<String>,
    /// Number of textures of the scene.
    pub textures: usize,
    /// Extent along x, y and z in metres.
    pub extent_m: [f64; 3],
    /// Lower and upper corner of the building, world metres.
    pub building_m: [DVec3; 2],
    /// Speed in metres per second that suits the building.
    pub speed_m_per_s: f64,
    /// Features of the scene that the renderer must handle.
    pub features: SceneFeatures,
    /// Whether the scene wants a ground, and why not.
    pub ground_advice: GroundAdvice,
    /// True where the model, as it was loaded, has a ground of its own.
    has_own_ground: bool,
    /// The ground at the lowest point of the building.
    pub lowest_ground: Ground,
}

impl SceneInfo {
    /// Describes a scene that was loaded.
    pub fn new(source: SceneSource, tracer: &Tracer) -> Self {
        let scene = tracer.scene();
        let has_own_ground = scene.has_own_ground();
        Self {
            name: scene.name.clone(),
            source,
            views: scene.views.iter().enumerate().map(saved_view).collect(),
            walk: scene.walk.clone(),
            warnings: scene.warnings.clone(),
            same_names: Arc::new(same_names(scene.model_materials())),
            objects: scene.all_objects().clone(),
            triangles: scene.triangles.len(),
            vertices: scene.positions.len(),
            lights: scene.lights.len(),
            light_groups: scene.light_groups.list.clone(),
            conditioning: scene.conditioning.sentences(),
            textures: scene.textures.len(),
            extent_m: (scene.bounds_m[1] - scene.bounds_m[0]).to_array(),
            building_m: scene.building_m,
            speed_m_per_s: speed_for(scene.building_m),
            features: scene.features,
            ground_advice: scene.ground_advice_with(|| has_own_ground),
            has_own_ground,
            lowest_ground: scene.lowest_ground(),
        }
    }

    /// Way that an object may go along each axis, metres: ten times the size of the model.
    pub fn reach_m(&self) -> f64 {
        10.0 * self.extent_m.into_iter().fold(0.0, f64::max)
    }

    /// Updates the numbers that an edit changes.
    pub fn relight(&mut self, scene: &Scene) {
        self.triangles = scene.triangles.len();
        (self.lights, self.features) = (scene.lights.len(), scene.features);
        self.light_groups.clone_from(&scene.light_groups.list);
        self.ground_advice = scene.ground_advice_with(|| self.has_own_ground);
        self.conditioning = scene.conditioning.sentences();
    }
}

fn same_names(materials: &[Material]) -> HashMap<String, Vec<MaterialId>> {
    let mut by_name: HashMap<&str, Vec<MaterialId>> = HashMap::new();
    for (i, material) in (0..).zip(materials) {
        by_name.entry(&material.name).or_default().push(MaterialId(i));
    }
    let shared = by_name.into_iter().filter(|(_, ids)| ids.len() > 1);
    shared.map(|(name, ids)| (name.to_owned(), ids)).collect()
}

fn saved_view((i, view): (usize, &afterimage::scene::NamedView)) -> SavedView {
    let key = u8::try_from(i + 1).ok().filter(|key| *key <= 9);
    SavedView { name: view.name.clone(), camera: view.camera, key }
}
