//! Threads, tasks and the graphics adapter.

use super::{OwnWrites, ReadNote};
use crate::picture::restore::PictureView;
use crate::window::export::{Destination, Exported};
use crate::window::files::{Asked, Reached};
use crate::window::launch::LaunchOptions;
use crate::window::rendering::baking::{Baking, ShownFloor};
use crate::window::rendering::{
    FullTrace, Loading, Plan, RenderThread, SceneSource, Task, TaskError, Wake, spawn_activity,
};
use crate::window::state::{AppState, Document, Pair, PictureError, Purpose, Quality};
use crate::work_plane::MeasuredPlane;
use afterimage::Tracer;
use afterimage::render::bake::FloorCover;
use afterimage::scene::{SceneEdit, SkyImage};
use afterimage::trace::SceneEpoch;
use egui_wgpu::RenderState;
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// Result of a small task whose progress is not shown.
pub(super) enum AppEvent {
    /// A file was saved at this path, which is shown to the user.
    Saved(PathBuf),
    /// A state or settings file was written; no message is shown.
    Kept,
    /// The view of a picture was read.
    PictureView(PictureView),
    /// The light and the materials of a picture were read.
    Note(Box<ReadNote>),
    /// Materials and daylight were saved in the sidecar.
    SavedEdit(Box<SavedEdit>),
    /// A picture of the sky was read.
    SkyPicture(Arc<SkyImage>),
}

/// What was saved in a sidecar.
pub(super) struct SavedEdit {
    pub(super) path: PathBuf,
    /// Number of the scene whose sidecar it is.
    pub(super) scene: u64,
    pub(super) document: Document,
}

/// What was saved in a session file.
pub(super) struct SavedSession {
    pub(super) path: PathBuf,
    /// The scene whose session it is, and its number.
    pub(super) source: SceneSource,
    pub(super) scene: u64,
    pub(super) document: Document,
    pub(super) quality: Quality,
}

/// The scene is being rebuilt with other materials or daylight.
pub(super) struct PendingEdit {
    pub(super) edit: SceneEdit,
    pub(super) task: Task<Arc<Tracer>>,
}

/// A picture that was compared with the full tracer's.
pub(super) struct Measurement {
    pub(super) pair: Pair,
    pub(super) size: [u32; 2],
    pub(super) error: PictureError,
    /// Error map of the picture as sRGB, row-major from the top.
    pub(super) map: Vec<[u8; 3]>,
}

/// What the store lights of the floor.
#[derive(Default)]
pub(super) struct FloorWatch {
    /// Finds it out.
    pub(super) task: Option<Task<ShownFloor>>,
    /// The places of the scene that was looked at last.
    pub(super) cover: Option<Arc<FloorCover>>,
    /// The state of the scene and the bounces for which the store was looked at last, and when.
    pub(super) looked: Option<((SceneEpoch, u32), Instant)>,
}

/// Tasks by which files are chosen.
#[derive(Default)]
pub(super) struct Choosing {
    /// The system's dialog, and what it was opened for.
    pub(super) dialog: Option<Task<(Purpose, Asked)>>,
    /// A folder that is being read for the list of files.
    pub(super) folder: Option<Task<Reached>>,
    /// A folder that is being read for the path field.
    pub(super) nearby: Option<Task<Reached>>,
}

/// Threads, tasks and the graphics adapter.
pub(super) struct Services {
    /// What the window was started with.
    pub(super) launch: LaunchOptions,
    pub(super) ctx: egui::Context,
    pub(super) wake: Wake,
    pub(super) render: RenderThread,
    /// Number of threads that render.
    pub(super) threads: usize,
    pub(super) graphics: Option<RenderState>,
    /// Messages of the graphics adapter that are not shown yet.
    pub(super) graphics_errors: Arc<Mutex<Vec<String>>>,
    pub(super) loading: Option<Loading>,
    pub(super) edit: Option<PendingEdit>,
    pub(super) export: Option<Task<Exported>>,
    pub(super) full_trace: Option<FullTrace>,
    pub(super) measurement: Option<Task<Measurement>>,
    /// The pair that is being measured, or that could not be measured.
    pub(super) measured_pair: Option<Pair>,
    pub(super) plan: Option<Task<Plan>>,
    /// Finds the outline of the surface of a triangle.
    pub(super) outline: Option<Task<(u32, Vec<[DVec3; 2]>)>>,
    /// The bake that is running.
    pub(super) baking: Option<Baking>,
    pub(super) floor: FloorWatch,
    pub(super) choosing: Choosing,
    /// Files that the program has written itself.
    pub(super) own_writes: OwnWrites,
    /// Ends when the files of the scene have changed.
    pub(super) watch: Option<Task<PathBuf>>,
    /// Measures the light in the scene for the automatic exposure.
    pub(super) light: Option<Task<()>>,
    /// Makes the scene in which daylight factors are rendered.
    pub(super) overcast: Option<Task<(SceneEpoch, Arc<Tracer>)>>,
    /// Measures the work plane.
    pub(super) plane: Option<Task<MeasuredPlane>>,
    pub(super) tasks: Vec<Task<AppEvent>>,
    /// Saves the session.
    pub(super) saving: Option<Task<SavedSession>>,
    /// Set where the system ends the program.
    pub(super) ended: Arc<AtomicBool>,
}

/// Returns the folder of the model that is shown; `None` for built-in scenes.
pub(super) fn model_folder(state: &AppState) -> Option<PathBuf> {
    match &state.scene.as_ref()?.source {
        SceneSource::File { path, .. } => std::path::absolute(path).ok()?.parent().map(Path::to_owned),
        _ => None,
    }
}

impl Services {
    /// Runs a small task; its event is applied with the next update of the window. `activity`
    /// begins the message about a panic.
    pub(super) fn spawn(
        &mut self,
        activity: &str,
        work: impl FnOnce() -> Result<AppEvent, TaskError> + Send + 'static,
    ) {
        self.tasks.push(spawn_activity("task", activity, self.wake.clone(), |_| work()));
    }

    /// True where the system ends the program.
    pub(super) fn is_ended_from_outside(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }

    /// Returns where new pictures, walks and sessions are saved.
    pub(super) fn destination(&self, state: &AppState) -> Destination {
        let chosen = state.picture.settings.folder.clone().or_else(|| self.launch.pictures.clone());
        let name = state.scene.as_ref().map_or("scene", |s| &s.name);
        Destination::new(chosen, model_folder(state), name)
    }
}
