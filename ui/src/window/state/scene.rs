//! The scene as the panels show it.

use crate::window::rendering::scene_loading::SceneSource;
use afterimage::scene::{Scene, SceneFeatures, Warning};
use afterimage::{Camera, Tracer};

/// A view that can be gone back to.
#[derive(Clone, Debug, PartialEq)]
pub struct SavedView {
    /// What the user calls it.
    pub name: String,
    /// Where it looks from.
    pub camera: Camera,
    /// The number of the key that goes there, 1 to 9.
    pub key: Option<u8>,
}

/// The scene as the panels show it.
#[derive(Clone, Debug)]
pub struct SceneInfo {
    /// Its name.
    pub name: String,
    /// Where it came from.
    pub source: SceneSource,
    /// Saved views, the start view first.
    pub views: Vec<SavedView>,
    /// What was doubtful in its files.
    pub warnings: Vec<Warning>,
    /// Triangles.
    pub triangles: usize,
    /// Vertices.
    pub vertices: usize,
    /// Lights.
    pub lights: usize,
    /// How hard it is on numbers, in sentences.
    pub conditioning: Vec<String>,
    /// Textures.
    pub textures: usize,
    /// Extent along x, y and z, metres.
    pub extent_m: [f64; 3],
    /// What the renderer must do for it.
    pub features: SceneFeatures,
}

impl SceneInfo {
    /// What a loaded scene has.
    pub fn new(source: SceneSource, tracer: &Tracer) -> Self {
        let scene = tracer.scene();
        Self {
            name: scene.name.clone(),
            source,
            views: scene.views.iter().enumerate().map(saved_view).collect(),
            warnings: scene.warnings.clone(),
            triangles: scene.triangles.len(),
            vertices: scene.positions.len(),
            lights: scene.lights.len(),
            conditioning: scene.conditioning.sentences(),
            textures: scene.textures.len(),
            extent_m: (scene.bounds_m[1] - scene.bounds_m[0]).to_array(),
            features: scene.features,
        }
    }

    /// Takes over what a change of materials or light has changed.
    pub fn relight(&mut self, scene: &Scene) {
        (self.lights, self.features) = (scene.lights.len(), scene.features);
        self.conditioning = scene.conditioning.sentences();
    }
}

fn saved_view((i, view): (usize, &afterimage::scene::NamedView)) -> SavedView {
    let key = u8::try_from(i + 1).ok().filter(|key| *key <= 9);
    SavedView { name: view.name.clone(), camera: view.camera, key }
}
