//! What the window knows and shows. Panels read it and return [`Command`]s; only the app changes it.

mod command;
mod comparison;
mod edits;
mod history;
mod look;
mod notices;
mod options;
mod picture;
mod quality;
mod scene;
mod sight;
mod sun;
mod unsaved_changes;
mod work;

pub use command::{Command, Editing, Moving, Seeing};
pub use comparison::{Compare, Comparison, Pair, PictureError, difference};
pub use edits::{Change, Edits};
pub use history::{HISTORY, Sample};
pub use look::{FileCommand, Look};
pub use notices::{Notice, Severity};
pub use options::Options;
pub use picture::{Exporting, PictureCommand, PictureFormat, PictureSettings, PictureSize, PictureState};
pub use quality::{Quality, WINDOW_SAMPLES};
pub use scene::{SavedView, SceneInfo};
pub use sight::{Inspection, Lent, Measure, PixelFacts, Sight, Snap, SnapKind};
pub use sun::{PlaceAndTime, SunControls};
pub use unsaved_changes::{Answer, Leaving};
pub use work::Work;

use crate::window::app::scene_loading::{Progress, SceneSource};
use crate::window::gpu::presentation::{Coloring, Heatmap, Overlay, Presentation};
use crate::window::input::fly_camera::{FlyCamera, ViewChange};
use crate::window::input::playback::{Playback, Recording};
use crate::window::rendering::exchange::PublishedFrame;
use crate::window::rendering::plan::{Plan, PlanView};
use crate::window::rendering::thumbnails::Thumbnails;
use afterimage::{Camera, WalkthroughSettings};
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;

/// All of it.
#[derive(Debug)]
pub struct State {
    /// As set by the user.
    pub quality: Quality,
    /// As set at the start: what a reset goes back to.
    pub default_quality: Quality,
    /// Switches.
    pub options: Options,
    /// The camera.
    pub fly: FlyCamera,
    /// The scene that is shown.
    pub scene: Option<SceneInfo>,
    /// The scene that is on its way.
    pub loading: Option<(SceneSource, Progress)>,
    /// The newest finished frame.
    pub frame: Option<PublishedFrame>,
    /// What the renderer is doing.
    pub work: Work,
    /// The last minute, oldest first.
    pub history: VecDeque<Sample>,
    /// Messages, oldest first.
    pub notices: Vec<Notice>,
    /// Text of the path field.
    pub path_text: String,
    /// The question whether to clear the references is open.
    pub asks_to_clear: bool,
    /// What waits for an answer, because it would lose changes.
    pub leaving: Option<Leaving>,
    /// The person has not moved yet.
    pub shows_hint: bool,
    /// The first complete frame from this generation on sets the exposure: a model from a file has just been opened.
    pub meters_from: Option<u64>,
    /// Time from one picture of the window to the next while it is busy, milliseconds, fading.
    pub window_ms: f32,
    /// What draws the window, where it is no graphics card.
    pub software_adapter: Option<String>,
    /// The saved view gone to last.
    pub view_index: usize,
    /// The camera path.
    pub playback: Playback,
    /// The walk that is being recorded.
    pub recording: Option<Recording>,
    /// The name of a saved view that is being changed: which, and what is typed.
    pub renaming: Option<(usize, String)>,
    /// The comparison with the full tracer.
    pub comparison: Comparison,
    /// Changes of the scene; there as soon as a scene is.
    pub edits: Option<Edits>,
    /// What the controls of sun and sky show.
    pub sun: SunControls,
    /// What is looked at more closely.
    pub sight: Sight,
    /// The cut through the building.
    pub plan: Option<Arc<Plan>>,
    /// What of it is shown.
    pub plan_view: PlanView,
    /// Small pictures of views and references.
    pub thumbnails: Option<Thumbnails>,
    /// Pictures.
    pub picture: PictureState,
    /// The looks of the window.
    pub look: Look,
    /// The window of settings is open.
    pub shows_settings: bool,
    /// Where settings are kept.
    pub settings_file: Option<PathBuf>,
    /// Models that were open before, the newest first.
    pub recent: Vec<PathBuf>,
    /// A session that was cut short, to be gone on with or not.
    pub recovery: Option<PathBuf>,
    next_notice: u64,
}

impl State {
    /// Before the first scene.
    pub fn new(walk: WalkthroughSettings, camera: Camera) -> Self {
        let quality = Quality::new(walk);
        Self {
            quality,
            default_quality: quality,
            options: Options {
                heatmap: Heatmap::Off,
                coloring: Coloring::ByType,
                has_outline: false,
                shows_panels: true,
                shows_statistics: true,
                shows_help: false,
                is_paused: false,
                view_change: ViewChange::default(),
            },
            fly: FlyCamera::new(camera),
            scene: None,
            loading: None,
            frame: None,
            work: Work::Loading,
            history: VecDeque::new(),
            notices: Vec::new(),
            path_text: String::new(),
            asks_to_clear: false,
            leaving: None,
            shows_hint: true,
            meters_from: None,
            window_ms: 0.0,
            software_adapter: None,
            view_index: 0,
            playback: Playback::default(),
            recording: None,
            renaming: None,
            comparison: Comparison::default(),
            edits: None,
            sun: SunControls::default(),
            sight: Sight::default(),
            plan: None,
            plan_view: PlanView::default(),
            thumbnails: None,
            picture: PictureState::default(),
            look: Look::default(),
            shows_settings: false,
            settings_file: None,
            recent: Vec::new(),
            recovery: None,
            next_notice: 0,
        }
    }

    /// How the newest frame is shown.
    pub fn presentation(&self) -> Presentation {
        Presentation {
            heatmap: self.options.heatmap,
            coloring: self.options.coloring,
            has_outline: self.options.has_outline,
            exposure_ev: self.quality.exposure_ev,
            tone_map: self.quality.tone_map,
            overlay: Overlay::None,
        }
    }

    /// Sets the exposure by the first complete picture of a model that was just opened.
    pub fn meter(&mut self) {
        // Beyond these a picture is meant to be dark or bright.
        const RANGE_EV: std::ops::RangeInclusive<f32> = -4.0..=6.0;
        let Some(frame) = &self.frame else { return };
        let is_awaited = self.meters_from.is_some_and(|from| frame.generation >= from);
        if let Some(ev) = frame.metered_ev.filter(|_| is_awaited) {
            self.quality.exposure_ev = ev.clamp(*RANGE_EV.start(), *RANGE_EV.end());
            self.meters_from = None;
        }
    }

    /// Takes in how long the window's own last picture took; pauses between them are none.
    pub fn note_window_secs(&mut self, secs: f32) {
        const FADE: f32 = 0.9;
        const LONGEST_SECS: f32 = 0.5;
        if secs < LONGEST_SECS {
            let before = if self.window_ms > 0.0 { self.window_ms } else { secs * 1000.0 };
            self.window_ms = before * FADE + secs * 1000.0 * (1.0 - FADE);
        }
    }

    /// True while a question is open: it has the keyboard.
    pub fn is_asking(&self) -> bool {
        self.leaving.is_some() || self.asks_to_clear || self.recovery.is_some()
    }

    /// The frame's references that are held, and those that it used.
    pub fn references_used_and_held(&self) -> [usize; 2] {
        self.frame.as_ref().map_or([0, 0], |f| [f.stats.references_used, f.references.len()])
    }
}
