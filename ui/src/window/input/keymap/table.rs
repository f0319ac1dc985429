//! The table of actions, their default keys and descriptions.

use super::chord::{Chord, ctrl, ctrl_shift, plain, shift};
use clap::ValueEnum;
use egui::Key;

/// What a key does. The names in files are those of [`ValueEnum`], such as `add-reference`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
#[allow(missing_docs, reason = "BINDINGS describes each action")]
pub enum Action {
    Forward,
    Back,
    Left,
    Right,
    Up,
    Down,
    LookLeft,
    LookRight,
    LookUp,
    LookDown,
    ToggleWalk,
    Focus,
    GoThere,
    FrameAll,
    NextView,
    PreviousView,
    GoToView,
    SaveView,
    GoBack,
    Level,
    NarrowFov,
    WidenFov,
    DarkerExposure,
    BrighterExposure,
    ResetExposure,
    ExposeForView,
    ToggleSection,
    SectionBack,
    SectionForward,
    ShowPicture,
    ShowIlluminance,
    ShowLuminance,
    ShowDaylightFactor,
    ShowClay,
    CycleHeatmap,
    ToggleByReference,
    ToggleOutline,
    ToggleEdges,
    ShowFull,
    CompareSplit,
    CompareErrors,
    AddReference,
    ClearCache,
    Bake,
    Pause,
    Freeze,
    Open,
    SaveSession,
    Quit,
    Reload,
    Screenshot,
    ScreenshotWithoutBackground,
    SaveSequence,
    SaveFilm,
    CopyPose,
    PastePose,
    AddPathKey,
    PlayPath,
    Pick,
    Measure,
    ObjectAway,
    ObjectNearer,
    ObjectLeft,
    ObjectRight,
    ObjectUp,
    ObjectDown,
    HideObject,
    DeleteObject,
    Undo,
    Redo,
    Help,
    TogglePanels,
    ToggleStatistics,
    NextRegion,
    PreviousRegion,
    FullScreen,
    Escape,
}

/// The keys of an action.
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// Action that the keys trigger.
    pub action: Action,
    /// Alternative keys, each of which triggers the action.
    pub chords: &'static [Chord],
    /// True if the action lasts while a key is held, independently of Shift and Alt.
    pub held: bool,
    /// Description of the action in the help overlay and in `--help`.
    pub help: &'static str,
}

const fn hold(action: Action, chords: &'static [Chord], help: &'static str) -> Binding {
    Binding { action, chords, held: true, help }
}

const fn press(action: Action, chords: &'static [Chord], help: &'static str) -> Binding {
    Binding { action, chords, held: false, help }
}

/// The keys 1 to 9.
const fn numbers(ctrl: bool) -> [Chord; 9] {
    use Key::{Num1, Num2, Num3, Num4, Num5, Num6, Num7, Num8, Num9};
    let keys = [Num1, Num2, Num3, Num4, Num5, Num6, Num7, Num8, Num9];
    let mut chords = [Chord { key: Num1, shift: false, ctrl }; 9];
    let mut i = 0;
    while i < keys.len() {
        chords[i].key = keys[i];
        i += 1;
    }
    chords
}

const NUMBERS: [Chord; 9] = numbers(false);
const CTRL_NUMBERS: [Chord; 9] = numbers(true);

/// Groups of the help: the name of each, and the first of its actions in [`BINDINGS`].
pub const GROUPS: &[(&str, Action)] = &[
    ("Moving", Action::Forward),
    ("Views and path", Action::GoToView),
    ("Exposure", Action::DarkerExposure),
    ("Method", Action::CycleHeatmap),
    ("Scene", Action::Pick),
    ("Files and pictures", Action::Open),
    ("Window", Action::Help),
];

/// The default keys of all actions, in the order of the help.
pub const BINDINGS: &[Binding] = &[
    hold(Action::Forward, &[plain(Key::W)], "fly forward"),
    hold(Action::Back, &[plain(Key::S)], "fly back"),
    hold(Action::Left, &[plain(Key::A)], "fly left"),
    hold(Action::Right, &[plain(Key::D)], "fly right"),
    hold(Action::Up, &[plain(Key::E), plain(Key::PageUp)], "fly up"),
    hold(Action::Down, &[plain(Key::Q), plain(Key::PageDown)], "fly down"),
    hold(Action::LookLeft, &[plain(Key::ArrowLeft)], "look left"),
    hold(Action::LookRight, &[plain(Key::ArrowRight)], "look right"),
    hold(Action::LookUp, &[plain(Key::ArrowUp)], "look up"),
    hold(Action::LookDown, &[plain(Key::ArrowDown)], "look down"),
    press(Action::ToggleWalk, &[plain(Key::G)], "switch between flying and walking (gravity, steps, walls)"),
    press(Action::Focus, &[plain(Key::F)], "look at the point under the cursor"),
    press(Action::GoThere, &[shift(Key::Enter)], "go to the point under the cursor"),
    press(Action::FrameAll, &[plain(Key::Home)], "show the whole model"),
    press(Action::GoBack, &[plain(Key::Backspace)], "go back to the previous position"),
    press(Action::Level, &[plain(Key::J)], "level the horizon"),
    press(Action::NarrowFov, &[plain(Key::OpenBracket)], "narrow the field of view"),
    press(Action::WidenFov, &[plain(Key::CloseBracket)], "widen the field of view"),
    press(Action::GoToView, &NUMBERS, "go to a saved view"),
    press(Action::SaveView, &CTRL_NUMBERS, "save this view under a number"),
    press(Action::NextView, &[plain(Key::L)], "go to the next saved view"),
    press(Action::PreviousView, &[shift(Key::L)], "go to the previous saved view"),
    press(Action::AddPathKey, &[plain(Key::K)], "add a key to the camera path"),
    press(Action::PlayPath, &[plain(Key::Space)], "play or pause the camera path"),
    press(Action::CopyPose, &[ctrl(Key::C)], "copy the pose as flags of 'afterimage render'"),
    press(Action::PastePose, &[ctrl(Key::V)], "go to the pose in the clipboard"),
    press(Action::DarkerExposure, &[plain(Key::Minus)], "decrease the exposure by half a stop"),
    press(Action::BrighterExposure, &[plain(Key::Equals)], "increase the exposure by half a stop"),
    press(Action::ResetExposure, &[plain(Key::Num0)], "reset the exposure"),
    press(Action::ExposeForView, &[plain(Key::V)], "expose for this view"),
    press(Action::ToggleSection, &[plain(Key::O)], "cut the model open with a plane, or show it whole"),
    press(Action::SectionBack, &[plain(Key::Comma)], "move the plane of the section back, 10 cm"),
    press(Action::SectionForward, &[plain(Key::Period)], "move the plane of the section on, 10 cm"),
    press(Action::ShowPicture, &[shift(Key::Num1)], "show the picture"),
    press(Action::ShowIlluminance, &[shift(Key::Num2)], "show illuminance, lux, in false colour"),
    press(Action::ShowLuminance, &[shift(Key::Num3)], "show luminance, cd/m2, in false colour"),
    press(Action::ShowDaylightFactor, &[shift(Key::Num4)], "show the daylight factor in false colour"),
    press(Action::ShowClay, &[shift(Key::Num5)], "show the model in white clay"),
    press(Action::CycleHeatmap, &[plain(Key::T)], "show pixel types: off, blended, only"),
    press(Action::ToggleByReference, &[shift(Key::T)], "colour pixels by type or by reference"),
    press(Action::ToggleOutline, &[plain(Key::Y)], "outline areas of Type 3"),
    press(Action::ToggleEdges, &[shift(Key::Y)], "draw the edges of surfaces as lines"),
    hold(Action::ShowFull, &[plain(Key::X)], "show the full tracer's picture while held"),
    press(Action::CompareSplit, &[plain(Key::C)], "compare with the full tracer: split picture"),
    press(Action::CompareErrors, &[shift(Key::C)], "compare with the full tracer: error map"),
    press(Action::AddReference, &[plain(Key::N)], "add a reference here"),
    press(Action::ClearCache, &[shift(Key::Delete)], "clear all references (asks first)"),
    press(
        Action::Bake,
        &[shift(Key::B)],
        "light the whole scene in the background, into the store, or stop that",
    ),
    press(Action::Pause, &[plain(Key::P)], "pause rendering until the camera moves, or resume it"),
    press(Action::Freeze, &[shift(Key::P)], "freeze this frame: moving reprojects it, nothing is rendered"),
    press(Action::Pick, &[plain(Key::Enter)], "click the point under the cursor, or in the middle"),
    press(Action::Measure, &[plain(Key::M)], "start or stop measuring distances"),
    press(Action::ObjectAway, &[ctrl(Key::ArrowUp)], "move the selected object away, 10 cm"),
    press(Action::ObjectNearer, &[ctrl(Key::ArrowDown)], "move the object nearer"),
    press(Action::ObjectLeft, &[ctrl(Key::ArrowLeft)], "move the object to the left"),
    press(Action::ObjectRight, &[ctrl(Key::ArrowRight)], "move the object to the right"),
    press(Action::ObjectUp, &[ctrl(Key::PageUp)], "move the object up"),
    press(Action::ObjectDown, &[ctrl(Key::PageDown)], "move the object down"),
    press(Action::HideObject, &[plain(Key::H)], "hide or show the selected object"),
    press(Action::DeleteObject, &[plain(Key::Delete)], "delete the selected object"),
    press(Action::Undo, &[ctrl(Key::Z)], "undo the last change of the scene"),
    press(Action::Redo, &[ctrl_shift(Key::Z), ctrl(Key::Y)], "redo the last undone change"),
    press(Action::Open, &[ctrl(Key::O)], "open a model, a session or a picture's view"),
    press(Action::SaveSession, &[ctrl(Key::S)], "save the session"),
    press(Action::Reload, &[plain(Key::F5)], "reload the scene"),
    press(Action::Screenshot, &[plain(Key::F12)], "save a picture"),
    press(Action::ScreenshotWithoutBackground, &[ctrl(Key::F12)], "save a picture without the sky"),
    press(Action::SaveSequence, &[shift(Key::F12)], "save the camera path as numbered pictures"),
    press(Action::SaveFilm, &[ctrl_shift(Key::F12)], "save the camera path as a film (MP4)"),
    press(Action::Help, &[plain(Key::F1), shift(Key::Slash)], "show or hide this help"),
    press(Action::TogglePanels, &[plain(Key::F2)], "show or hide the panels"),
    press(Action::ToggleStatistics, &[plain(Key::F3)], "show few figures, all, or none"),
    press(Action::NextRegion, &[plain(Key::F6)], "go to the next part of the window"),
    press(Action::PreviousRegion, &[shift(Key::F6)], "go to the part of the window before"),
    press(Action::FullScreen, &[plain(Key::F11)], "enter or leave full screen"),
    press(Action::Escape, &[plain(Key::Escape)], "close the open dialog or view (never quits)"),
    press(Action::Quit, &[ctrl(Key::Q)], "close the window"),
];

/// Mouse actions and modifiers for the help: input and description.
pub const MOUSE: &[(&str, &str)] = &[
    ("Drag, left or right button", "look around"),
    ("Wheel", "fly towards the cursor"),
    ("Right button + wheel", "change the speed (0.05 to 200 m/s)"),
    ("Click", "inspect a pixel, select its material and object"),
    ("Double click", "go to the point"),
    ("Shift held", "move five times as fast, look around twice as fast"),
    ("Alt held", "a fifth as fast"),
    ("Tab, Shift+Tab", "go to the next control, or the one before; Enter and Space press it"),
    ("Drop a file", "open a model, a session or a picture's view"),
];

impl Binding {
    /// The keys as text; of more than three, only the first and the last.
    pub fn keys(&self) -> String {
        match self.chords {
            [first, .., last] if self.chords.len() > 3 => format!("{}-{}", first.name(), last.name()),
            chords => chords.iter().map(Chord::name).collect::<Vec<_>>().join(", "),
        }
    }
}
