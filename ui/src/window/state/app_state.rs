//! Everything that panels read.

use super::{
    Appearance, Comparison, FalseColors, FileList, FrameRate, Leaving, Lighting, Navigation, Notice,
    OpenDocument, Options, OutsidePicture, Overlay, PictureState, Presentation, Quality, Sample, SavedView,
    SceneInfo, Selection, Severity, ViewExposure, Work, history, notices,
};
use crate::window::files::Listing;
use crate::window::rendering::{
    FrameValues, Plan, PlanView, Progress, PublishedFrame, Quantity, SceneSource, SeenSection, Thumbnails,
};
use afterimage::Mode;
use afterimage::camera::CameraPath;
use afterimage::raster::color::radiance_shown_as;
use afterimage::raster::exposure::Metered;
use afterimage::raster::false_color::line_step;
use afterimage::scene::MaterialId;
use afterimage::trace::section::CAP_TONES;
use glam::DVec3;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;

/// Everything that is shown or saved: what panels read.
#[derive(Debug, Default)]
pub struct AppState {
    /// Rendering settings, as the user set them.
    pub quality: Quality,
    /// Rendering settings at the start; a reset restores them.
    pub default_quality: Quality,
    /// The automatic exposure; `None` before the light in the first scene is measured.
    pub metered: Option<Metered>,
    /// The automatic exposure that follows the view.
    pub view_exposure: ViewExposure,
    /// Heatmap, panels, pause and other switches of the window.
    pub options: Options,
    /// The camera and its path.
    pub navigation: Navigation,
    /// The scene that is shown.
    pub scene: Option<SceneInfo>,
    /// The scene that is being loaded, and the progress of loading.
    pub loading: Option<(SceneSource, Progress)>,
    /// The newest finished frame; `None` before the first.
    pub frame: Option<PublishedFrame>,
    /// What the renderer is doing.
    pub work: Work,
    /// How often frames are rendered while the camera moves.
    pub frame_rate: FrameRate,
    /// The frames of the last minute, oldest first.
    pub history: VecDeque<Sample>,
    /// Messages over the viewport, oldest first.
    pub notices: Vec<Notice>,
    /// Identifies the next message. It only grows, so that no message is taken for an earlier one.
    pub next_notice: u64,
    /// Questions and dialogs that are open.
    pub dialogs: Dialogs,
    /// Width and height of the viewport in pixels.
    pub viewport_size: [u32; 2],
    /// Time between two updates of the window while it is busy, in milliseconds, smoothed.
    pub window_ms: f32,
    /// Name of the graphics adapter where it is a software rasteriser.
    pub software_adapter: Option<String>,
    /// The comparison with the full tracer.
    pub comparison: Comparison,
    /// What the user can change about the scene: materials, objects, light, views, path and
    /// measures; `None` before the first scene.
    pub document: Option<OpenDocument>,
    /// Light is traced by groups, because the controls of the lights were shown.
    pub knows_lights: bool,
    /// The pixel, distance, material and reference that are selected.
    pub selection: Selection,
    /// The plan of the floor.
    pub plan: PlanState,
    /// Scales of false colours, and the work plane.
    pub lighting: Lighting,
    /// Small pictures of views and references.
    pub thumbnails: Thumbnails,
    /// Settings and progress of saved pictures.
    pub picture: PictureState,
    /// Theme and scale of the window.
    pub appearance: Appearance,
    /// Files that the window remembers.
    pub files: FileState,
}

/// Questions and dialogs that are open.
#[derive(Clone, Debug, Default)]
pub struct Dialogs {
    /// Asks whether to clear all references.
    pub asks_to_clear: bool,
    /// An action that would lose unsaved changes, held until the user has answered.
    pub leaving: Option<Leaving>,
    /// A session that names a picture outside its folder, held until the user has answered.
    pub outside_picture: Option<OutsidePicture>,
    /// The settings dialog is open.
    pub shows_settings: bool,
}

/// Files that the window remembers.
#[derive(Clone, Debug, Default)]
pub struct FileState {
    /// Text of the path field.
    pub path_text: String,
    /// The folder that the path field names, for suggestions.
    pub nearby: Arc<Listing>,
    /// The program's own list of files, while it is open.
    pub list: Option<FileList>,
    /// Folder of the file that was chosen last.
    pub last_folder: Option<PathBuf>,
    /// Models that were opened before, the newest first.
    pub recent: Vec<PathBuf>,
    /// A session left behind by a crash; the user is asked whether to restore it.
    pub recovery: Option<PathBuf>,
    /// File that keeps the settings; `None` where there is no folder for it.
    pub settings_file: Option<PathBuf>,
}

/// The plan of the floor and the part of it that is shown.
#[derive(Clone, Debug, Default)]
pub struct PlanState {
    /// Horizontal cut through a storey of the building.
    pub cut: Option<Arc<Plan>>,
    /// Eye height in metres of the last cut that was begun, also if it failed.
    pub asked_m: Option<f64>,
    /// Floor of the storey that was chosen, in world metres; `None` for that of the camera.
    pub storey_m: Option<f64>,
    /// The part of the cut that is shown.
    pub view: PlanView,
    /// Walkable places, world metres, each with the share of what is seen from it that stored
    /// references light, 0..1.
    pub floor: Vec<(DVec3, f32)>,
    /// Progress of a bake; `None` while none is running.
    pub baking: Option<Progress>,
}

impl AppState {
    /// Returns how the newest frame is drawn.
    pub fn presentation(&self) -> Presentation {
        Presentation {
            heatmap: self.options.heatmap,
            coloring: self.options.coloring,
            has_outline: self.options.has_outline,
            exposure_ev: self.exposure_ev(),
            tone_map: self.quality.tone_map,
            overlay: Overlay::None,
            false_colors: self.false_colors(),
            is_clay: self.shown_quantity() == Quantity::Clay,
        }
    }

    /// The section that is shown now.
    pub fn section(&self) -> Option<SeenSection> {
        let section = self.document.as_ref()?.now().section.filter(|section| section.is_on)?;
        // It warps references, and those of another section show what is cut away.
        if self.quality.walk.render.mode == Mode::Paper {
            return None;
        }
        // An exposure that follows the view is measured with the cut surfaces: it must not depend
        // on itself.
        let ev = match self.quality.follows_view {
            true => self.metered.map_or(0.0, Metered::ev),
            false => self.exposure_ev(),
        };
        let tones = CAP_TONES.map(|tone| radiance_shown_as(tone, ev, self.quality.tone_map));
        Some(SeenSection { plane: section.plane, tones })
    }

    /// Returns what the newest frame shows.
    pub fn shown_quantity(&self) -> Quantity {
        self.frame.as_ref().map_or(Quantity::Picture, |frame| frame.values.quantity)
    }

    fn false_colors(&self) -> Option<FalseColors> {
        let max = self.lighting.max_of(self.shown_quantity())?;
        let line_step = if self.options.has_isolines { line_step(max) / max } else { 0.0 };
        Some(FalseColors { scale: FrameValues::share_of_packed(max), line_step })
    }

    /// Returns the value of the frame at the cursor; `None` where there is none.
    pub fn value_at_cursor(&self) -> Option<f32> {
        let (frame, [x, y]) = (self.frame.as_ref()?, self.lighting.cursor?);
        let [width, height] = frame.size.map(|side| side as f32);
        // The height always fits.
        let x = (x - 0.5) * self.aspect() as f32 * height / width.max(1.0) + 0.5;
        let is_inside = [x, y].iter().all(|at| (0.0..1.0).contains(at));
        let pixel = (y * height) as usize * frame.size[0] as usize + (x * width) as usize;
        frame.values.value(*frame.radiance.get(pixel).filter(|_| is_inside)?)
    }

    /// Returns the exposure in stops.
    pub fn exposure_ev(&self) -> f32 {
        let of_view = || self.view_exposure.shown_ev().filter(|_| self.quality.follows_view);
        let of_scene = || self.metered.map(Metered::ev);
        self.quality.exposure.stops().or_else(of_view).or_else(of_scene).unwrap_or_default()
    }

    /// True where something that the user has changed is not saved.
    pub fn is_unsaved(&self) -> bool {
        self.document.as_ref().is_some_and(|document| document.is_unsaved(&self.quality))
    }

    /// Returns the saved views, the start view first.
    pub fn views(&self) -> &[SavedView] {
        self.document.as_ref().map_or(&[], |document| &document.now().views)
    }

    /// Returns the user's camera path, or that of the scene where there is none; an empty one
    /// without a scene.
    pub fn path(&self) -> &CameraPath {
        static NONE: CameraPath = CameraPath { fov_y_deg: 0.0, frames: 0, keyframes: Vec::new() };
        let own = self.document.as_ref().and_then(|document| document.now().path.as_ref());
        own.or(self.scene.as_ref().map(|scene| &scene.walk)).unwrap_or(&NONE)
    }

    /// Returns which of its name a material is, counted from 1, and how many there are; `None` where
    /// no other material has its name.
    pub fn number_of_name(&self, id: MaterialId) -> Option<[usize; 2]> {
        let name = &self.document.as_ref()?.scene().materials.get(id.0 as usize)?.name;
        let ids = self.scene.as_ref()?.same_names.get(name)?;
        Some([ids.binary_search(&id).ok()? + 1, ids.len()])
    }

    /// True where the camera path is the user's own.
    pub fn has_own_path(&self) -> bool {
        self.document.as_ref().is_some_and(|document| document.now().path.is_some())
    }

    /// Returns width divided by height of the viewport.
    pub fn aspect(&self) -> f64 {
        let [width, height] = self.viewport_size.map(f64::from);
        width / height.max(1.0)
    }

    /// Returns the title of the window: the scene, with a mark while changes are not saved.
    pub fn title(&self) -> String {
        let mark = if self.is_unsaved() { "*" } else { "" };
        let Some(scene) = &self.scene else { return "Afterimage".to_owned() };
        let label = scene.source.label();
        // Of a path, the name of the file.
        let name = label.rsplit(['/', '\\']).next().unwrap_or(&label);
        format!("{mark}{name} \u{2022} Afterimage")
    }

    /// Returns what the renderer is doing, with its progress.
    pub fn work_text(&self) -> String {
        self.work.text(self.frame.as_ref())
    }

    /// Shows a message that something was done.
    pub fn info(&mut self, text: impl Into<String>) {
        self.notify(Severity::Info, text.into());
    }

    /// Shows a message that something is not as expected.
    pub fn warning(&mut self, text: impl Into<String>) {
        self.notify(Severity::Warning, text.into());
    }

    /// Removes messages of failures: the user goes on with something else.
    pub fn forget_errors(&mut self) {
        self.notices.retain(|notice| notice.severity != Severity::Error);
    }

    /// Shows a message that a file or folder was saved, from which it can be opened.
    pub fn saved(&mut self, text: impl Into<String>, file: Option<PathBuf>) {
        self.info(text);
        if let Some(notice) = self.notices.last_mut() {
            notice.file = file;
        }
    }

    /// Shows a message that something failed.
    pub fn error(&mut self, text: impl Into<String>) {
        self.notify(Severity::Error, text.into());
    }

    fn notify(&mut self, severity: Severity, text: String) {
        notices::push(&mut self.notices, self.next_notice, severity, text);
        self.next_notice += 1;
    }

    /// Adds the newest frame to the plots.
    pub fn record(&mut self) {
        if let Some(frame) = &self.frame {
            history::record(&mut self.history, &frame.stats);
        }
    }

    /// Notes the time since the last update of the window; longer pauses do not count.
    pub fn note_window_secs(&mut self, secs: f32) {
        const FADE: f32 = 0.9;
        const MAX_SECS: f32 = 0.5;
        if secs < MAX_SECS {
            let before = if self.window_ms > 0.0 { self.window_ms } else { secs * 1000.0 };
            self.window_ms = before * FADE + secs * 1000.0 * (1.0 - FADE);
        }
    }

    /// True where the window shows each frame as it was rendered, and is drawn again when the next
    /// one is there. Drawing with a software rasteriser takes its time from the renderer, and
    /// frames come soon enough.
    pub fn waits_for_frames(&self) -> bool {
        self.software_adapter.is_some() && !self.options.is_paused && !self.frame_rate.is_late()
    }

    /// True while a question or the list of files is open: it receives all keys.
    pub fn is_asking(&self) -> bool {
        let is_list_open = self.files.list.is_some();
        self.dialogs.leaving.is_some()
            || self.dialogs.asks_to_clear
            || self.dialogs.outside_picture.is_some()
            || self.files.recovery.is_some()
            || is_list_open
    }

    /// Returns the number of references that the newest frame used, and the number that are held.
    pub fn references_used_and_held(&self) -> [usize; 2] {
        self.frame.as_ref().map_or([0, 0], |f| [f.stats.references_used, f.references.len()])
    }
}
