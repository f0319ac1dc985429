//! Keys as text.

use super::rebinding::bindings;
use super::table::{Action, Binding, MOUSE};

/// Keys of an action as text, for menus and hover texts.
pub fn keys_of(action: Action) -> String {
    bindings().iter().find(|b| b.action == action).map(Binding::keys).unwrap_or_default()
}

/// All keys as lines of text, for `--help`.
pub fn help_text() -> String {
    let keys = bindings().iter().map(|b| (b.keys(), b.help));
    let mouse = MOUSE.iter().map(|(what, help)| ((*what).to_owned(), *help));
    keys.chain(mouse).map(|(keys, help)| format!("  {keys:<28} {help}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::input::keymap::{BINDINGS, Chord};
    use egui::Key;

    #[test]
    fn no_key_is_bound_twice_and_no_action_listed_twice() {
        let chords: Vec<Chord> = BINDINGS.iter().flat_map(|b| b.chords).copied().collect();
        for (i, a) in chords.iter().enumerate() {
            assert!(!chords[i + 1..].contains(a), "{} is bound twice", a.name());
            assert_ne!(a.key, Key::Tab, "Tab moves the focus");
        }
        for (i, a) in BINDINGS.iter().enumerate() {
            assert!(BINDINGS[i + 1..].iter().all(|b| b.action != a.action), "{:?} is listed twice", a.action);
            assert!(!a.help.is_empty());
        }
    }

    #[test]
    fn help_lists_all_bindings() {
        let text = help_text();
        assert!(BINDINGS.iter().all(|b| text.contains(b.help) && text.contains(&b.keys())));
        assert!(text.contains("1-9"));
    }
}
