//! `CurrentScene`: state of the open scene that panels do not read. A session that is saved in a
//! file is a [`SessionFile`].

use super::{Autosave, SessionFile};
use crate::window::input::Obstacles;
use crate::window::rendering::RenderRequest;
use afterimage::import::AppliedEdit;
use afterimage::render::Pace;
use afterimage::scene::SceneEdit;
use afterimage::trace::SceneEpoch;
use afterimage::{Camera, Tracer};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;
use toml::Table;

/// The session in the metadata of a picture.
#[derive(Clone, Debug)]
pub(super) struct PictureNote {
    /// The picture.
    pub(super) file: PathBuf,
    /// Text of the session; `None` where the picture shows the model as its files have it.
    pub(super) text: Option<String>,
}

/// The light and the materials of a picture, once they were read.
pub(super) struct ReadNote {
    /// The picture.
    pub(super) file: PathBuf,
    /// Hash of the scene, as its files have it, that they were read for.
    pub(super) files_hash: String,
    pub(super) read: anyhow::Result<AppliedEdit>,
}

/// The open scene, its edits, and what has been sent to the renderer.
pub(super) struct CurrentScene {
    /// The scene with its ray tracer; `None` before the first scene.
    pub(super) obstacles: Option<Obstacles>,
    /// Materials and daylight of the scene that is being rendered.
    pub(super) rendered_edit: Option<SceneEdit>,
    /// Number of scenes that were shown so far. What was begun for another scene than this one does
    /// not belong to it.
    pub(super) number: u64,
    /// Generation of the first frame of the scene.
    pub(super) first_generation: u64,
    /// Applied when the scene that is being loaded is shown.
    pub(super) arrival: Arrival,
    /// The unsaved changes are given up in favour of the scene that is being loaded.
    pub(super) discards_edits: bool,
    /// The window may close, even with unsaved changes.
    pub(super) may_close: bool,
    /// File in which the session was saved or from which it was restored, if any.
    pub(super) file: Option<PathBuf>,
    /// Keys of `file` that this version does not know.
    pub(super) unknown_keys: Table,
    /// The session is to be saved once more.
    pub(super) saves_again: bool,
    /// Hash of the scene as the model's files have it.
    pub(super) files_hash: String,
    pub(super) autosave: Autosave,
    /// The state of the scene whose daylight factors are rendered in place of its pictures.
    pub(super) factors_of: Option<SceneEpoch>,
    /// The request that was sent last.
    pub(super) sent: Option<RenderRequest>,
    /// Time of the last motion.
    pub(super) moved: Instant,
    /// The scale of frames while the camera moves.
    pub(super) pace: Pace,
}

/// Where to go when the scene that is being loaded is shown.
#[derive(Default)]
pub(super) struct Arrival {
    /// Pose of the camera; takes precedence over `view`.
    pub(super) camera: Option<Camera>,
    /// Name of a saved view.
    pub(super) view: Option<String>,
    /// Vertical field of view in degrees.
    pub(super) fov_y_deg: Option<f64>,
    /// Exposure in stops; takes precedence over that of the scene.
    pub(super) exposure_ev: Option<f32>,
    /// Hash of the scene that an opened picture stores. If the loaded scene has another hash, a
    /// message says that the scene has changed.
    pub(super) scene_hash: Option<String>,
    /// Session text of a picture whose light and materials are to be shown.
    pub(super) note: Option<PictureNote>,
    /// A saved session to be restored, and its file.
    pub(super) session: Option<(SessionFile, PathBuf)>,
    /// What the session makes of the scene, once that is loaded.
    pub(super) edit: Option<AppliedEdit>,
}

impl Arrival {
    /// True where the program was started at a pose of its own.
    pub(super) fn is_placed(&self) -> bool {
        self.camera.is_some() || self.view.is_some() || self.fov_y_deg.is_some()
    }
}

impl CurrentScene {
    /// State before the first scene is loaded.
    pub(super) fn new(arrival: Arrival) -> Self {
        Self {
            obstacles: None,
            rendered_edit: None,
            first_generation: 0,
            arrival,
            discards_edits: false,
            may_close: false,
            file: None,
            unknown_keys: Table::new(),
            number: 0,
            saves_again: false,
            files_hash: String::new(),
            autosave: Autosave::default(),
            factors_of: None,
            sent: None,
            moved: Instant::now(),
            pace: Pace::default(),
        }
    }

    /// Returns the tracer of the scene that is shown.
    pub(super) fn tracer(&self) -> Option<&Arc<Tracer>> {
        self.obstacles.as_ref().map(Obstacles::tracer)
    }
}
