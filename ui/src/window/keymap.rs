//! Every key in one table: what the window obeys, what the help overlay shows and what `--help` prints.
//!
//! Keys are meant by their place on the keyboard, so that WASD is one hand's square on every layout.

use crate::settings::suggestion;
use egui::{Event, Key, Modifiers};
use std::sync::OnceLock;
use toml::{Table, Value};

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

/// A key with the modifiers that must be held; Alt is never asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chord {
    /// By its place, named after the US layout.
    pub key: Key,
    /// With Shift.
    pub shift: bool,
    /// With Ctrl (Command on a Mac).
    pub ctrl: bool,
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

const fn plain(key: Key) -> Chord {
    Chord { key, shift: false, ctrl: false }
}

const fn shift(key: Key) -> Chord {
    Chord { key, shift: true, ctrl: false }
}

const fn ctrl(key: Key) -> Chord {
    Chord { key, shift: false, ctrl: true }
}

const fn ctrl_shift(key: Key) -> Chord {
    Chord { key, shift: true, ctrl: true }
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

static REBOUND: OnceLock<Vec<Binding>> = OnceLock::new();

/// The table as the user has it: [`BINDINGS`], or what [`install`] made of them.
pub fn bindings() -> &'static [Binding] {
    REBOUND.get().map_or(BINDINGS, Vec::as_slice)
}

/// Binds keys anew, once, before any of them is shown or pressed.
///
/// # Errors
/// As [`rebound`]; the keys stay as they were.
pub fn install(keys: &Table) -> Result<(), String> {
    let table = rebound(keys)?;
    // A second call comes from a second start in one process; the first one's keys are shown already.
    let _ = REBOUND.set(table);
    Ok(())
}

/// The table with other keys for some actions: `add-reference = "B"`, `forward = ["W", "Up"]`; an empty list takes the
/// keys away.
///
/// # Errors
/// Where an action or a key is unknown, or a key would do two things: one message for all of it, and nothing is changed.
pub fn rebound(keys: &Table) -> Result<Vec<Binding>, String> {
    let names: Vec<String> = BINDINGS.iter().map(|b| b.action.name()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let (mut table, mut troubles) = (BINDINGS.to_vec(), Vec::new());
    for (name, value) in keys {
        match (names.iter().position(|n| n == name), chords(value)) {
            (None, _) => troubles.push(format!("there is no action '{name}', {}", suggestion(name, &names))),
            (_, Err(cause)) => troubles.push(format!("{name}: {cause}")),
            // Once in the life of the program.
            (Some(at), Ok(chords)) => table[at].chords = chords.leak(),
        }
    }
    troubles.extend(conflicts(&table));
    if troubles.is_empty() {
        return Ok(table);
    }
    Err(format!("[keys] is left aside, the usual keys hold: {}", troubles.join("; ")))
}

/// Keys that would do two things. What is held acts whatever modifiers do, so it takes its key with all of them but
/// Ctrl.
fn conflicts(table: &[Binding]) -> Vec<String> {
    let all: Vec<(&Binding, Chord)> =
        table.iter().flat_map(|b| b.chords.iter().map(move |c| (b, *c))).collect();
    let clash = |(a, x): &(&Binding, Chord), (b, y): &(&Binding, Chord)| {
        x == y || ((a.held && b.held) && x.key == y.key)
    };
    let mut troubles = Vec::new();
    for (i, first) in all.iter().enumerate() {
        for second in all[i + 1..].iter().filter(|second| clash(first, second)) {
            let (a, b) = (first.0.action.name(), second.0.action.name());
            troubles.push(format!("{} is bound to both {a} and {b}", second.1.name()));
        }
    }
    troubles
}

fn chords(value: &Value) -> Result<Vec<Chord>, String> {
    let wanted = "a key like \"Ctrl+K\" or a list of them is wanted";
    match value {
        Value::String(text) => Ok(vec![Chord::parse(text)?]),
        Value::Array(list) => {
            list.iter().map(|v| v.as_str().ok_or(wanted.to_owned()).and_then(Chord::parse)).collect()
        }
        _ => Err(wanted.to_owned()),
    }
}

impl Action {
    /// As it is written in files: `add-reference`.
    pub fn name(self) -> String {
        let mut name = String::new();
        for c in format!("{self:?}").chars() {
            if c.is_uppercase() && !name.is_empty() {
                name.push('-');
            }
            name.extend(c.to_lowercase());
        }
        name
    }
}

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

impl Chord {
    /// Reads `K`, `Shift+K`, `Ctrl+F12`.
    fn parse(text: &str) -> Result<Self, String> {
        let (mut chord, mut rest) = (plain(Key::A), text.trim());
        loop {
            if let Some(after) = rest.strip_prefix("Shift+") {
                (chord.shift, rest) = (true, after);
            } else if let Some(after) = rest.strip_prefix("Ctrl+") {
                (chord.ctrl, rest) = (true, after);
            } else {
                break;
            }
        }
        let name = match rest {
            "PgUp" => "PageUp",
            "PgDn" => "PageDown",
            "?" => "Slash",
            name => name,
        };
        chord.shift |= rest == "?";
        chord.key = Key::from_name(name).ok_or_else(|| format!("there is no key '{text}'"))?;
        match chord.key {
            Key::Tab => Err("Tab belongs to the focus".to_owned()),
            _ => Ok(chord),
        }
    }

    /// As it is printed on keys.
    pub fn name(&self) -> String {
        let prefix = match (self.ctrl, self.shift) {
            (true, true) => "Ctrl+Shift+",
            (true, _) => "Ctrl+",
            (_, true) if self.key == Key::Slash => return "?".to_owned(),
            (_, true) => "Shift+",
            _ => "",
        };
        let key = match self.key {
            Key::OpenBracket => "[",
            Key::CloseBracket => "]",
            Key::Minus => "-",
            Key::Equals => "=",
            Key::PageUp => "PgUp",
            Key::PageDown => "PgDn",
            Key::Escape => "Esc",
            key => key.name(),
        };
        format!("{prefix}{key}")
    }
}

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

/// An action that was asked for once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pressed {
    /// What.
    pub action: Action,
    /// By which of its chords: saved views are counted by it.
    pub chord: usize,
}

/// Which keys are down.
#[derive(Debug, Default)]
pub struct Keyboard {
    down: Vec<Key>,
}

impl Keyboard {
    /// Takes the events of one frame of the window; returns what was pressed. While text is being typed nothing is
    /// pressed or held; without the window's focus nothing is held, because releases no longer arrive.
    pub fn update(&mut self, events: &[Event], typing: bool) -> Vec<Pressed> {
        let mut pressed = Vec::new();
        for event in events {
            match event {
                Event::WindowFocused(false) => self.down.clear(),
                Event::Key { key, physical_key, pressed: is_press, repeat, modifiers } => {
                    let place = physical_key.unwrap_or(*key);
                    if !is_press {
                        self.down.retain(|k| *k != place);
                    } else if !typing && !repeat {
                        self.press(*key, place, *modifiers, &mut pressed);
                    }
                }
                _ => {}
            }
        }
        if typing {
            self.down.clear();
        }
        pressed
    }

    fn press(&mut self, key: Key, place: Key, modifiers: Modifiers, pressed: &mut Vec<Pressed>) {
        if !modifiers.command && !self.down.contains(&place) {
            self.down.push(place);
        }
        // The question mark sits elsewhere on other layouts; it is the one key that is meant by its sign.
        let chord = match key {
            Key::Questionmark => shift(Key::Slash),
            _ => Chord { key: place, shift: modifiers.shift, ctrl: modifiers.command },
        };
        for binding in bindings().iter().filter(|b| !b.held) {
            if let Some(at) = binding.chords.iter().position(|c| *c == chord) {
                pressed.push(Pressed { action: binding.action, chord: at });
            }
        }
    }

    /// True while any key of an action is down.
    pub fn is_held(&self, action: Action) -> bool {
        let is_down = |c: &Chord| self.down.contains(&c.key);
        bindings().iter().any(|b| b.held && b.action == action && b.chords.iter().any(is_down))
    }

    /// +1, -1 or 0 by two opposite actions.
    pub fn axis(&self, positive: Action, negative: Action) -> f64 {
        f64::from(i8::from(self.is_held(positive)) - i8::from(self.is_held(negative)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(key: Key, place: Key, pressed: bool, modifiers: Modifiers) -> Event {
        Event::Key { key, physical_key: Some(place), pressed, repeat: false, modifiers }
    }

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

    #[test]
    fn keys_are_meant_by_place_and_held_until_released() {
        let mut keyboard = Keyboard::default();
        // On a French keyboard the key at W says Z.
        keyboard.update(&[key(Key::Z, Key::W, true, Modifiers::NONE)], false);
        assert_eq!(keyboard.axis(Action::Forward, Action::Back), 1.0);
        keyboard.update(&[key(Key::Z, Key::W, false, Modifiers::NONE)], false);
        assert_eq!(keyboard.axis(Action::Forward, Action::Back), 0.0);
    }

    #[test]
    fn lost_focus_and_typing_release_everything() {
        let mut keyboard = Keyboard::default();
        let w = key(Key::W, Key::W, true, Modifiers::NONE);
        keyboard.update(std::slice::from_ref(&w), false);
        keyboard.update(&[Event::WindowFocused(false)], false);
        assert!(!keyboard.is_held(Action::Forward));
        keyboard.update(std::slice::from_ref(&w), true);
        assert!(!keyboard.is_held(Action::Forward));
        assert!(keyboard.update(&[key(Key::T, Key::T, true, Modifiers::NONE)], true).is_empty());
    }

    #[test]
    fn shift_tells_actions_apart_but_does_not_stop_flying() {
        let mut keyboard = Keyboard::default();
        let plain = keyboard.update(&[key(Key::T, Key::T, true, Modifiers::NONE)], false);
        let shifted = keyboard.update(&[key(Key::T, Key::T, true, Modifiers::SHIFT)], false);
        assert_eq!(plain, [Pressed { action: Action::CycleHeatmap, chord: 0 }]);
        assert_eq!(shifted, [Pressed { action: Action::ToggleByReference, chord: 0 }]);
        keyboard.update(&[key(Key::W, Key::W, true, Modifiers::SHIFT)], false);
        assert!(keyboard.is_held(Action::Forward));
    }

    #[test]
    fn saved_views_are_counted_by_their_key() {
        let pressed = Keyboard::default().update(&[key(Key::Num3, Key::Num3, true, Modifiers::NONE)], false);
        assert_eq!(pressed, [Pressed { action: Action::GoToView, chord: 2 }]);
    }

    fn table(text: &str) -> Result<Vec<Binding>, String> {
        rebound(&text.parse().unwrap())
    }

    #[test]
    fn every_key_reads_back_as_it_is_printed() {
        for chord in BINDINGS.iter().flat_map(|b| b.chords) {
            assert_eq!(Chord::parse(&chord.name()).as_ref(), Ok(chord));
        }
    }

    #[test]
    fn keys_can_be_bound_anew() {
        let table = table("add-reference = 'B'\nforward = ['W', 'I']\nnext-view = []\nlevel = 'L'").unwrap();
        let keys = |action| table.iter().find(|b| b.action == action).map(Binding::keys);
        assert_eq!(keys(Action::AddReference).as_deref(), Some("B"));
        assert_eq!(keys(Action::Forward).as_deref(), Some("W, I"));
        assert_eq!(keys(Action::NextView).as_deref(), Some(""));
        assert_eq!(keys(Action::Level).as_deref(), Some("L"));
        assert_eq!(keys(Action::Back), BINDINGS.iter().find(|b| b.action == Action::Back).map(Binding::keys));
    }

    #[test]
    fn conflicts_and_mistakes_are_refused_in_one_message() {
        let error =
            table("add-reference = 'K'\nadd-refrence = 'B'\nlevel = 'Hyper+J'\nfocus = 7").unwrap_err();
        for words in [
            "K is bound to both add-reference and add-path-key",
            "did you mean 'add-reference'?",
            "no key 'Hyper+J'",
            "a key like",
            "the usual keys hold",
        ] {
            assert!(error.contains(words), "'{words}' is not in: {error}");
        }
        assert!(table("pause = 'Tab'").unwrap_err().contains("focus"));
        assert!(table("forward = 'Ctrl+W'\nback = 'W'").unwrap_err().contains("both"));
    }
}
