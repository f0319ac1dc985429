//! Every key in one table: what the window obeys, what the help overlay shows and what `--help` prints.
//!
//! Keys are meant by their place on the keyboard, so that WASD is one hand's square on every layout.

mod chord;
mod keyboard;
mod rebinding;

pub use chord::Chord;
pub use keyboard::{Attention, Keyboard, Pressed};
pub use rebinding::{bindings, install, rebound};

use chord::{ctrl, ctrl_shift, plain, shift};
use egui::Key;

/// What a key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the table's help texts say it")]
pub enum Action {
    Forward,
    Back,
    Left,
    Right,
    Up,
    Down,
    ToggleWalk,
    Focus,
    FrameAll,
    NextView,
    PreviousView,
    GoToView,
    SaveView,
    Level,
    NarrowFov,
    WidenFov,
    DarkerExposure,
    BrighterExposure,
    ResetExposure,
    CycleHeatmap,
    ToggleByReference,
    ToggleOutline,
    ShowFull,
    CompareSplit,
    CompareErrors,
    AddReference,
    ClearCache,
    Pause,
    Open,
    SaveSession,
    Quit,
    Reload,
    Screenshot,
    ScreenshotWithoutBackground,
    SaveSequence,
    CopyPose,
    PastePose,
    AddPathKey,
    PlayPath,
    Measure,
    Undo,
    Redo,
    Help,
    TogglePanels,
    ToggleStatistics,
    FullScreen,
    Escape,
}

/// One line of the table.
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// What it does.
    pub action: Action,
    /// Any of these.
    pub chords: &'static [Chord],
    /// True where it acts for as long as it is held, whatever Shift and Alt do meanwhile.
    pub held: bool,
    /// For people.
    pub help: &'static str,
}

const fn hold(action: Action, chords: &'static [Chord], help: &'static str) -> Binding {
    Binding { action, chords, held: true, help }
}

const fn press(action: Action, chords: &'static [Chord], help: &'static str) -> Binding {
    Binding { action, chords, held: false, help }
}

/// The table.
pub const BINDINGS: &[Binding] = &[
    hold(Action::Forward, &[plain(Key::W), plain(Key::ArrowUp)], "fly forward"),
    hold(Action::Back, &[plain(Key::S), plain(Key::ArrowDown)], "fly back"),
    hold(Action::Left, &[plain(Key::A), plain(Key::ArrowLeft)], "fly left"),
    hold(Action::Right, &[plain(Key::D), plain(Key::ArrowRight)], "fly right"),
    hold(Action::Up, &[plain(Key::E), plain(Key::PageUp)], "rise"),
    hold(Action::Down, &[plain(Key::Q), plain(Key::PageDown)], "sink"),
    press(Action::ToggleWalk, &[plain(Key::G)], "fly, or walk: gravity, steps, walls"),
    press(Action::Focus, &[plain(Key::F)], "look at the point under the cursor"),
    press(Action::FrameAll, &[plain(Key::Home)], "see the whole model"),
    press(Action::NextView, &[plain(Key::L)], "go to the next saved view"),
    press(Action::PreviousView, &[shift(Key::L)], "go to the saved view before"),
    press(
        Action::GoToView,
        &[
            plain(Key::Num1),
            plain(Key::Num2),
            plain(Key::Num3),
            plain(Key::Num4),
            plain(Key::Num5),
            plain(Key::Num6),
            plain(Key::Num7),
            plain(Key::Num8),
            plain(Key::Num9),
        ],
        "go to a saved view",
    ),
    press(
        Action::SaveView,
        &[
            ctrl(Key::Num1),
            ctrl(Key::Num2),
            ctrl(Key::Num3),
            ctrl(Key::Num4),
            ctrl(Key::Num5),
            ctrl(Key::Num6),
            ctrl(Key::Num7),
            ctrl(Key::Num8),
            ctrl(Key::Num9),
        ],
        "save this view under a number",
    ),
    press(Action::Level, &[plain(Key::J)], "level the horizon"),
    press(Action::NarrowFov, &[plain(Key::OpenBracket)], "narrow the field of view"),
    press(Action::WidenFov, &[plain(Key::CloseBracket)], "widen the field of view"),
    press(Action::DarkerExposure, &[plain(Key::Minus)], "expose half a stop darker"),
    press(Action::BrighterExposure, &[plain(Key::Equals)], "expose half a stop brighter"),
    press(Action::ResetExposure, &[plain(Key::Num0)], "reset the exposure"),
    press(Action::CycleHeatmap, &[plain(Key::T)], "pixel types: off, blended, only"),
    press(Action::ToggleByReference, &[shift(Key::T)], "colour by type or by reference"),
    press(Action::ToggleOutline, &[plain(Key::Y)], "outline Type 3"),
    hold(Action::ShowFull, &[plain(Key::X)], "show the full tracer's picture while held"),
    press(Action::CompareSplit, &[plain(Key::C)], "compare with the full tracer: split picture"),
    press(Action::CompareErrors, &[shift(Key::C)], "compare with the full tracer: map of errors"),
    press(Action::AddReference, &[plain(Key::N)], "add a reference here"),
    press(Action::ClearCache, &[shift(Key::Delete)], "clear all references (asks first)"),
    press(Action::Pause, &[plain(Key::P)], "pause or resume the renderer"),
    press(Action::Open, &[ctrl(Key::O)], "open a model, a session or a picture's view"),
    press(Action::SaveSession, &[ctrl(Key::S)], "save the session"),
    press(Action::Quit, &[ctrl(Key::Q)], "close the window"),
    press(Action::Reload, &[plain(Key::F5)], "load the scene again"),
    press(Action::Screenshot, &[plain(Key::F12)], "save a picture"),
    press(Action::ScreenshotWithoutBackground, &[ctrl(Key::F12)], "save a picture without the sky"),
    press(Action::SaveSequence, &[shift(Key::F12)], "save the camera path as numbered pictures"),
    press(Action::CopyPose, &[ctrl(Key::C)], "copy the pose as flags of 'afterimage render'"),
    press(Action::PastePose, &[ctrl(Key::V)], "go to the pose in the clipboard"),
    press(Action::AddPathKey, &[plain(Key::K)], "add a key to the camera path"),
    press(Action::PlayPath, &[plain(Key::Space)], "play or pause the camera path"),
    press(Action::Measure, &[plain(Key::M)], "measure between two clicks, or stop"),
    press(Action::Undo, &[ctrl(Key::Z)], "undo the last change of the scene"),
    press(Action::Redo, &[ctrl_shift(Key::Z)], "redo what was undone"),
    press(Action::Help, &[plain(Key::F1), shift(Key::Slash)], "show or hide this help"),
    press(Action::TogglePanels, &[plain(Key::F2)], "show or hide the panels"),
    press(Action::ToggleStatistics, &[plain(Key::F3)], "show or hide the statistics"),
    press(Action::FullScreen, &[plain(Key::F11)], "full screen"),
    press(Action::Escape, &[plain(Key::Escape)], "close what is open (never quits)"),
];

/// What the mouse and the modifiers do, in the words of the help.
pub const MOUSE: &[(&str, &str)] = &[
    ("Drag, left or right button", "look around"),
    ("Wheel", "fly towards the cursor"),
    ("Right button + wheel", "change the speed (0.05 to 200 m/s)"),
    ("Click", "inspect a pixel, choose its material"),
    ("Double click", "go there"),
    ("Shift held", "five times as fast"),
    ("Alt held", "five times as slow"),
    ("Drop a file", "open a model, a session or a picture's view"),
];

impl Binding {
    /// The keys as text; a long row is shown by its ends.
    pub fn keys(&self) -> String {
        match self.chords {
            [first, .., last] if self.chords.len() > 3 => format!("{}-{}", first.name(), last.name()),
            chords => chords.iter().map(Chord::name).collect::<Vec<_>>().join(", "),
        }
    }
}

/// The keys of an action as text, for menus and tooltips.
pub fn keys_of(action: Action) -> String {
    bindings().iter().find(|b| b.action == action).map(Binding::keys).unwrap_or_default()
}

/// All keys as lines of plain text, for `--help`.
pub fn help_text() -> String {
    let keys = bindings().iter().map(|b| (b.keys(), b.help));
    let mouse = MOUSE.iter().map(|(what, help)| ((*what).to_owned(), *help));
    keys.chain(mouse).map(|(keys, help)| format!("  {keys:<28} {help}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_is_bound_twice_and_no_action_listed_twice() {
        let chords: Vec<Chord> = BINDINGS.iter().flat_map(|b| b.chords).copied().collect();
        for (i, a) in chords.iter().enumerate() {
            assert!(!chords[i + 1..].contains(a), "{} is bound twice", a.name());
            assert_ne!(a.key, Key::Tab, "Tab belongs to the focus");
        }
        for (i, a) in BINDINGS.iter().enumerate() {
            assert!(BINDINGS[i + 1..].iter().all(|b| b.action != a.action), "{:?} is listed twice", a.action);
            assert!(!a.help.is_empty());
        }
    }

    #[test]
    fn help_names_every_line() {
        let text = help_text();
        assert!(BINDINGS.iter().all(|b| text.contains(b.help) && text.contains(&b.keys())));
        assert!(text.contains("1-9"));
    }
}
