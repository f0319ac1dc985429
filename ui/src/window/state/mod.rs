//! State of the window. Panels read [`AppState`] and return [`Command`]s; commands change it
//! through `app`, and motion of the camera changes it through `input`.

mod app_state;
mod appearance;
mod command;
mod comparison;
mod document;
mod file_list;
mod frame_rate;
mod history;
mod lighting;
mod material_presets;
mod navigation;
mod notices;
mod options;
mod picture;
mod presentation;
mod quality;
mod scene;
mod section;
mod selection;
mod sun;
mod unsaved_changes;
mod view_exposure;
mod work;

pub use app_state::{AppState, Dialogs, FileState, PlanState};
pub use appearance::Appearance;
pub use command::{Command, EditCommand, FileCommand, InspectCommand, NavigationCommand};
pub use comparison::{Compare, Comparison, Pair, PictureError, difference};
pub use document::{Carried, Change, Document, OpenDocument};
pub use file_list::{FileList, ListCommand, Purpose};
pub use frame_rate::FrameRate;
pub use history::{HISTORY, Sample};
pub use lighting::{Area, Lighting, LightingCommand, PlaneSettings};
pub use material_presets::{COAT, MaterialPreset, copied, gloss_of, with_gloss};
pub use navigation::Navigation;
pub use notices::{Notice, Severity};
pub use options::{Options, Statistics};
pub use picture::{
    PictureCommand, PictureFormat, PictureQuality, PictureSettings, PictureSize, PictureState,
};
pub use presentation::{Coloring, FILLED_COLOR, FalseColors, Heatmap, Overlay, Presentation};
pub use quality::{Quality, WINDOW_SAMPLES};
pub use scene::{SavedView, SceneInfo};
pub use section::SectionView;
pub use selection::{Dropper, Inspection, Measure, PixelFacts, ReferenceView, Selection, Snap, SnapKind};
pub use sun::SunControls;
pub use unsaved_changes::{Answer, Leaving, OutsidePicture};
pub use view_exposure::ViewExposure;
pub use work::Work;
