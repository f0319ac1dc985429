//! What the window knows and shows. Panels read it and return [`Command`]s; only the app changes it.

use super::fly_camera::{FlyCamera, Gait, ViewChange};
use super::frames::PublishedFrame;
use super::load::{Progress, SceneSource};
use super::playback::{Playback, Recording};
use super::screenshot::Development;
use super::viewport::{Coloring, Heatmap, Presentation};
use afterimage::raster::color::ToneMap;
use afterimage::reference::ReferenceId;
use afterimage::scene::Warning;
use afterimage::{Camera, Tracer, WalkthroughSettings};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Samples per light in the window: a person wants fluid motion. Files are rendered with more.
pub const WINDOW_SAMPLES: u32 = 4;

/// What decides how good a picture is and how long it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Mode, samples, bounces, placement, cache.
    pub walk: WalkthroughSettings,
    /// Rendered pixels per pixel of the viewport, along an edge.
    pub render_scale: f32,
    /// A frame that is no longer wanted is given up after so long.
    pub budget_ms: f32,
    /// In stops.
    pub exposure_ev: f32,
    /// From radiance to display.
    pub tone_map: ToneMap,
}

impl Quality {
    /// The window's defaults with someone's settings.
    pub fn new(walk: WalkthroughSettings) -> Self {
        let tone_map = ToneMap::default();
        Self { walk, render_scale: 0.5, budget_ms: 100.0, exposure_ev: 0.0, tone_map }
    }

    /// How pictures are developed.
    pub fn development(&self) -> Development {
        Development { exposure_ev: self.exposure_ev, tone_map: self.tone_map }
    }
}

/// What the renderer is doing, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the words say it")]
pub enum Work {
    Loading,
    NoScene,
    Paused,
    Moving,
    Filling,
    AddingReference,
    Complete,
    Refining,
    Converged,
}

impl Work {
    /// The word on the screen.
    pub fn word(self) -> &'static str {
        match self {
            Self::Loading => "loading",
            Self::NoScene => "no scene",
            Self::Paused => "paused",
            Self::Moving => "moving",
            Self::Filling => "filling",
            Self::AddingReference => "adding a reference",
            Self::Complete => "complete",
            Self::Refining => "refining",
            Self::Converged => "converged",
        }
    }
}

/// How serious a notice is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Something was done.
    Info,
    /// Something failed.
    Error,
}

/// A message over the viewport, there until it is dismissed.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Its name.
    pub id: u64,
    /// How serious.
    pub severity: Severity,
    /// In full.
    pub text: String,
    /// When it came up.
    pub since: Instant,
}

/// Good news goes away by itself after so long.
const INFO_TIME: Duration = Duration::from_secs(8);

/// So many notices are kept.
const MOST_NOTICES: usize = 4;

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
    /// Lights.
    pub lights: usize,
    /// How hard it is on numbers, in sentences.
    pub stiffness: Vec<String>,
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
            lights: scene.lights.len(),
            stiffness: scene.stiffness.sentences(),
        }
    }
}

fn saved_view((i, view): (usize, &afterimage::scene::NamedView)) -> SavedView {
    let key = u8::try_from(i + 1).ok().filter(|key| *key <= 9);
    SavedView { name: view.name.clone(), camera: view.camera, key }
}

/// One frame in the plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When.
    pub at: Instant,
    /// Type 1, 2 and 3 in percent.
    pub percent: [f32; 3],
    /// Selection and warp, secondary, tracing in milliseconds.
    pub stage_ms: [f32; 3],
}

/// The plots reach back so far.
pub const HISTORY: Duration = Duration::from_secs(60);

/// What is switched on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Types over the picture.
    pub heatmap: Heatmap,
    /// What their colours mean.
    pub coloring: Coloring,
    /// Type 3 is outlined.
    pub has_outline: bool,
    /// Menu and side panel.
    pub shows_panels: bool,
    /// Figures over the viewport.
    pub shows_statistics: bool,
    /// The keys.
    pub shows_help: bool,
    /// Nothing is rendered.
    pub is_paused: bool,
    /// How views change.
    pub view_change: ViewChange,
}

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
    next_notice: u64,
}

/// What a control asks for.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Command {
    Open(SceneSource),
    Browse,
    CancelLoading,
    Reload,
    SetPathText(String),
    SetQuality(Quality),
    SetOptions(Options),
    SetSpeed(f64),
    SetFovDegrees(f64),
    EaseTo(Camera),
    Moving(Moving),
    Say(Severity, String),
    Level,
    ChangeFov(f64),
    AddReference,
    AskToClear,
    Clear,
    KeepReferences,
    Remove(ReferenceId),
    Screenshot,
    CopyPose,
    CopyText(String),
    Dismiss(u64),
    FullScreen,
    Escape,
}

/// What a control asks for of views, paths and the way one moves.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Moving {
    GoToView(usize),
    GoToKey(u8),
    StepView(isize),
    SaveView(u8),
    AddView,
    RemoveView(usize),
    Rename(Option<(usize, String)>),
    FinishRenaming,
    PastePose(String),
    SetGait(Gait),
    AddPathKey,
    RemovePathKey(usize),
    SetPlayback(Playback),
    PlayPath,
    ToggleRecording,
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
            shows_hint: true,
            meters_from: None,
            window_ms: 0.0,
            software_adapter: None,
            view_index: 0,
            playback: Playback::default(),
            recording: None,
            renaming: None,
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
        }
    }

    /// Puts a message over the viewport; one that is there already is not repeated.
    pub fn notify(&mut self, severity: Severity, text: String) {
        self.notices.retain(|n| n.text != text);
        let id = self.next_notice;
        self.next_notice += 1;
        self.notices.push(Notice { id, severity, text, since: Instant::now() });
        let surplus = self.notices.len().saturating_sub(MOST_NOTICES);
        self.notices.drain(..surplus);
    }

    /// Takes away good news that was there for long enough.
    pub fn expire_notices(&mut self) {
        self.notices.retain(|n| n.severity == Severity::Error || n.since.elapsed() < INFO_TIME);
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

    /// Adds the newest frame to the plots.
    pub fn record(&mut self) {
        let Some(frame) = &self.frame else { return };
        let (stats, now) = (&frame.stats, Instant::now());
        let p = stats.types.percentages();
        let ms = |secs: f64| (secs * 1000.0) as f32;
        self.history.push_back(Sample {
            at: now,
            percent: [p.type1_percent, p.type2_percent, p.type3_percent].map(|v| v as f32),
            stage_ms: [stats.secs.select + stats.secs.warp, stats.secs.secondary, stats.secs.trace].map(ms),
        });
        while self.history.front().is_some_and(|s| now - s.at > HISTORY) {
            self.history.pop_front();
        }
    }

    /// What the renderer is doing, and how far it is.
    pub fn work_text(&self) -> String {
        match (self.work, &self.frame) {
            (Work::Refining, Some(frame)) => {
                let refined = frame.stats.refined;
                format!("{} {}/{}", self.work.word(), refined.pass, refined.of)
            }
            (work, _) => work.word().to_owned(),
        }
    }

    /// The frame's references that are held, and those that it used.
    pub fn references_used_and_held(&self) -> [usize; 2] {
        self.frame.as_ref().map_or([0, 0], |f| [f.stats.references_used, f.references.len()])
    }
}
