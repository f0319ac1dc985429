//! A key with its modifiers, and its textual form.

use anyhow::{Context, ensure};
use egui::Key;

/// A key with the modifiers that must be held. Alt is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chord {
    /// Key by its position, named as on the US layout.
    pub key: Key,
    /// True if Shift must be held.
    pub shift: bool,
    /// True if Ctrl must be held (Command on a Mac).
    pub ctrl: bool,
}

/// True on a Mac, whose keyboards say Command where others say Ctrl.
const ON_MAC: bool = cfg!(target_os = "macos");

pub(crate) const fn plain(key: Key) -> Chord {
    Chord { key, shift: false, ctrl: false }
}

pub(crate) const fn shift(key: Key) -> Chord {
    Chord { key, shift: true, ctrl: false }
}

pub(crate) const fn ctrl(key: Key) -> Chord {
    Chord { key, shift: false, ctrl: true }
}

pub(crate) const fn ctrl_shift(key: Key) -> Chord {
    Chord { key, shift: true, ctrl: true }
}

impl Chord {
    /// Parses a chord such as `K`, `Shift+K` or `Ctrl+F12`; `Cmd` means the same as `Ctrl`.
    pub(crate) fn parse(text: &str) -> anyhow::Result<Self> {
        let (mut chord, mut rest) = (plain(Key::A), text.trim());
        loop {
            if let Some(after) = rest.strip_prefix("Shift+") {
                (chord.shift, rest) = (true, after);
            } else if let Some(after) = rest.strip_prefix("Ctrl+").or_else(|| rest.strip_prefix("Cmd+")) {
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
        chord.key = Key::from_name(name).with_context(|| format!("there is no key '{text}'"))?;
        ensure!(chord.key != Key::Tab, "Tab is reserved for moving the focus");
        Ok(chord)
    }

    /// The chord as text, such as `Shift+K`; `Self::parse` reads it.
    pub fn name(&self) -> String {
        let prefix = match (self.ctrl, self.shift) {
            (true, true) if ON_MAC => "Cmd+Shift+",
            (true, true) => "Ctrl+Shift+",
            (true, _) if ON_MAC => "Cmd+",
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::input::keymap::BINDINGS;

    #[test]
    fn every_chord_parses_from_its_name() {
        for chord in BINDINGS.iter().flat_map(|b| b.chords) {
            assert_eq!(Chord::parse(&chord.name()).ok(), Some(*chord));
        }
    }
}
