//! What the window is started with.

use crate::window::rendering::scene_loading::SceneSource;
use crate::window::state::{Appearance, PictureSettings, WINDOW_SAMPLES};
use afterimage::raster::color::ToneMap;
use afterimage::reference::PlacementPolicy;
use afterimage::render::RenderSettings;
use afterimage::trace::TraceSettings;
use afterimage::{Camera, WalkthroughSettings};
use std::path::PathBuf;

/// What the window is opened with.
#[derive(Clone, Debug)]
pub struct WindowRequest {
    /// The scene; the embedded gallery where none is named.
    pub scene: Option<SceneSource>,
    /// What to walk with at first.
    pub settings: WalkthroughSettings,
    /// Diffuse bounces for models from files: made for no renderer in particular, they are dark without any.
    pub model_bounces: u32,
    /// Where to start instead of at the scene's start view.
    pub camera: Option<Camera>,
    /// Start at the saved view of this name. `camera` goes before it.
    pub view: Option<String>,
    /// Vertical field of view at the start, in degrees, where it is not the view's own.
    pub fov_y_deg: Option<f64>,
    /// Exposure in stops; where nothing is said it is 0, and an opened model's is metered.
    pub exposure_ev: Option<f32>,
    /// From radiance to display.
    pub tone_map: ToneMap,
    /// Threads that render; all there are where nothing is said.
    pub threads: Option<usize>,
    /// Where pictures are saved; the current folder, or the user's pictures, where nothing is said.
    pub pictures: Option<PathBuf>,
    /// How pictures are saved at first.
    pub picture: PictureSettings,
    /// The looks of the window.
    pub appearance: Appearance,
    /// Where changed looks are kept; nowhere where nothing is said.
    pub settings_file: Option<PathBuf>,
    /// Where recent files and sessions for the case of a crash are kept; nowhere where nothing is said.
    pub state_folder: Option<PathBuf>,
    /// What is to be said at the start: settings that could not be used.
    pub warnings: Vec<String>,
}

impl Default for WindowRequest {
    fn default() -> Self {
        let trace = TraceSettings { samples: WINDOW_SAMPLES, ..TraceSettings::default() };
        let settings = WalkthroughSettings {
            render: RenderSettings { trace, ..RenderSettings::default() },
            placement: PlacementPolicy::default(),
            audits: true,
            ..WalkthroughSettings::default()
        };
        Self {
            scene: None,
            settings,
            model_bounces: 1,
            camera: None,
            view: None,
            fov_y_deg: None,
            exposure_ev: None,
            tone_map: ToneMap::default(),
            threads: None,
            pictures: None,
            picture: PictureSettings::default(),
            appearance: Appearance::default(),
            settings_file: None,
            state_folder: None,
            warnings: Vec::new(),
        }
    }
}
