//! Options with which the window is opened.

use crate::settings::DEFAULT_BOUNCES;
use crate::window::rendering::scene_loading::SceneSource;
use crate::window::state::{Appearance, PictureSettings, WINDOW_SAMPLES};
use afterimage::import::DaylightOptions;
use afterimage::raster::{color::ToneMap, exposure::Exposure};
use afterimage::reference::PlacementPolicy;
use afterimage::render::RenderSettings;
use afterimage::store::StoreSettings;
use afterimage::trace::TraceSettings;
use afterimage::{Camera, WalkthroughSettings};
use std::path::PathBuf;

/// Options with which the window is opened.
#[derive(Clone, Debug)]
pub struct LaunchOptions {
    /// Scene to open; `None` for the embedded gallery.
    pub scene: Option<SceneSource>,
    /// Sun and sky that replace those of every scene that is opened.
    pub daylight: DaylightOptions,
    /// Settings of the walkthrough at the start.
    pub settings: WalkthroughSettings,
    /// True to improve the picture at rest until the camera moves.
    pub keeps_improving: bool,
    /// Pose to start at instead of the scene's start view.
    pub camera: Option<Camera>,
    /// Name of the saved view to start at. `camera` takes precedence.
    pub view: Option<String>,
    /// Vertical field of view at the start in degrees; `None` for that of the view.
    pub fov_y_deg: Option<f64>,
    /// Exposure at the start; `None` for that of the scene.
    pub exposure: Option<Exposure>,
    /// Tone mapping from radiance to display.
    pub tone_map: ToneMap,
    /// Number of threads that render; `None` for all.
    pub threads: Option<usize>,
    /// Folder for pictures; `None` for the folder of the model or the user's folder for pictures.
    pub pictures: Option<PathBuf>,
    /// Settings of saved pictures at the start.
    pub picture: PictureSettings,
    /// Theme, scale and motion of the window.
    pub appearance: Appearance,
    /// File that keeps a changed appearance; `None` to keep it nowhere.
    pub settings_file: Option<PathBuf>,
    /// Folder for recent files and for sessions kept in case of a crash; `None` to keep them
    /// nowhere.
    pub state_folder: Option<PathBuf>,
    /// The store of references that is read and added to; `None` for none.
    pub store: Option<StoreSettings>,
    /// True where files are chosen in the program's own list, even if the system has a dialog.
    pub has_own_file_list: bool,
    /// Program that opens a file or folder with the user's program for it.
    pub opener: PathBuf,
    /// Messages to show at the start: settings that are invalid.
    pub warnings: Vec<String>,
}

impl LaunchOptions {
    /// Says where references will be kept, as long as that folder does not exist.
    pub fn store_note(&self) -> Option<String> {
        let store = self.store.as_ref().filter(|store| !store.folder.exists())?;
        let (folder, megabytes) = (store.folder.display(), store.max_bytes >> 20);
        Some(format!(
            "light is kept for the next start in {folder}, at most {megabytes} MB; --store off keeps none"
        ))
    }
}

impl Default for LaunchOptions {
    fn default() -> Self {
        let trace = TraceSettings { samples: WINDOW_SAMPLES, bounces: DEFAULT_BOUNCES.0, seed: 0 };
        let settings = WalkthroughSettings {
            render: RenderSettings { trace, ..RenderSettings::default() },
            placement: PlacementPolicy::default(),
            audits: true,
            ..WalkthroughSettings::default()
        };
        Self {
            scene: None,
            daylight: DaylightOptions::default(),
            settings,
            keeps_improving: false,
            camera: None,
            view: None,
            fov_y_deg: None,
            exposure: None,
            tone_map: ToneMap::default(),
            threads: None,
            pictures: None,
            picture: PictureSettings::default(),
            appearance: Appearance::default(),
            settings_file: None,
            state_folder: None,
            store: None,
            has_own_file_list: false,
            opener: system_opener().into(),
            warnings: Vec::new(),
        }
    }
}

/// The system's program that opens a file with the user's program for it.
fn system_opener() -> &'static str {
    if cfg!(windows) {
        "explorer"
    } else if cfg!(target_os = "macos") {
        "open"
    } else {
        "xdg-open"
    }
}
