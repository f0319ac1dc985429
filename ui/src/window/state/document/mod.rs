//! The document: everything that a user can change about a scene and would miss, with undo, redo,
//! and one comparison that finds whether anything is not saved.

mod change;
mod merge;
mod open_document;
mod step_names;

pub use change::Change;
pub use open_document::{Carried, OpenDocument};

use super::{SavedView, SectionView, SunControls};
use afterimage::camera::CameraPath;
use afterimage::scene::{Daylight, LightSettings, SceneEdit};
use glam::DVec3;

/// Everything that a user can change about a scene and would miss. The settings of quality stay in
/// [`AppState`](super::AppState), because they also hold before there is a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// Materials, objects, ground, sun, sky and lights.
    pub scene: SceneEdit,
    /// Sun and sky as their controls show them.
    pub sun: SunControls,
    /// Saved views, the start view first.
    pub views: Vec<SavedView>,
    /// The user's camera path; `None` while it is the scene's own.
    pub path: Option<CameraPath>,
    /// Distances that were measured: the two ends of each, in world metres.
    pub measures: Vec<[DVec3; 2]>,
    /// The section; `None` before the first.
    pub section: Option<SectionView>,
}

impl Default for Document {
    fn default() -> Self {
        let scene = SceneEdit {
            materials: Vec::new(),
            daylight: Daylight::default(),
            lights: LightSettings::default(),
            objects: Default::default(),
            ground: None,
        };
        let (views, measures) = (Vec::new(), Vec::new());
        Self { scene, sun: SunControls::default(), views, path: None, measures, section: None }
    }
}
