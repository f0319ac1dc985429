//! Which keys are down, and what pressing them asks for.

use crate::window::input::keymap::chord::{Chord, shift};
use crate::window::input::keymap::{Action, bindings};
use egui::{Event, Key, Modifiers};

/// An action that was asked for once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pressed {
    /// What.
    pub action: Action,
    /// By which of its chords: saved views are counted by it.
    pub chord: usize,
}

/// Who listens to the keys besides the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attention {
    /// Nobody.
    View,
    /// A button, a slider or the like has the focus.
    Control,
    /// Text is typed, or a question waits for its answer.
    Text,
}

/// Keys that press and move a control which has the focus.
fn works_controls(key: Key) -> bool {
    matches!(key, Key::Space | Key::Enter | Key::ArrowUp | Key::ArrowDown | Key::ArrowLeft | Key::ArrowRight)
}

/// Which keys are down.
#[derive(Debug, Default)]
pub struct Keyboard {
    down: Vec<Key>,
}

impl Keyboard {
    /// Takes the events of one frame of the window; returns what was pressed. While text is being typed nothing is
    /// pressed or held; while another control has the focus, what it is worked with is its own; without the window's focus
    /// nothing is held, because releases no longer arrive.
    pub fn update(&mut self, events: &[Event], attention: Attention) -> Vec<Pressed> {
        let typing = attention == Attention::Text;
        let is_taken = |key| typing || attention == Attention::Control && works_controls(key);
        let mut pressed = Vec::new();
        for event in events {
            match event {
                Event::WindowFocused(false) => self.down.clear(),
                Event::Key { key, physical_key, pressed: is_press, repeat, modifiers } => {
                    let place = physical_key.unwrap_or(*key);
                    if !is_press {
                        self.down.retain(|k| *k != place);
                    } else if !repeat && !is_taken(*key) {
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
    fn keys_are_meant_by_place_and_held_until_released() {
        let mut keyboard = Keyboard::default();
        // On a French keyboard the key at W says Z.
        keyboard.update(&[key(Key::Z, Key::W, true, Modifiers::NONE)], Attention::View);
        assert_eq!(keyboard.axis(Action::Forward, Action::Back), 1.0);
        keyboard.update(&[key(Key::Z, Key::W, false, Modifiers::NONE)], Attention::View);
        assert_eq!(keyboard.axis(Action::Forward, Action::Back), 0.0);
    }

    #[test]
    fn lost_focus_and_typing_release_everything() {
        let mut keyboard = Keyboard::default();
        let w = key(Key::W, Key::W, true, Modifiers::NONE);
        keyboard.update(std::slice::from_ref(&w), Attention::View);
        keyboard.update(&[Event::WindowFocused(false)], Attention::View);
        assert!(!keyboard.is_held(Action::Forward));
        keyboard.update(std::slice::from_ref(&w), Attention::Text);
        assert!(!keyboard.is_held(Action::Forward));
        assert!(keyboard.update(&[key(Key::T, Key::T, true, Modifiers::NONE)], Attention::Text).is_empty());
    }

    #[test]
    fn a_control_with_the_focus_keeps_the_keys_that_work_it_and_no_others() {
        let pressed = |k| Keyboard::default().update(&[key(k, k, true, Modifiers::NONE)], Attention::Control);
        assert_eq!(pressed(Key::Space), []);
        assert_eq!(pressed(Key::T), [Pressed { action: Action::CycleHeatmap, chord: 0 }]);
        let mut keyboard = Keyboard::default();
        for k in [Key::ArrowUp, Key::W] {
            assert!(!keyboard.is_held(Action::Forward));
            keyboard.update(&[key(k, k, true, Modifiers::NONE)], Attention::Control);
        }
        assert!(keyboard.is_held(Action::Forward), "W");
    }

    #[test]
    fn shift_tells_actions_apart_but_does_not_stop_flying() {
        let mut keyboard = Keyboard::default();
        let plain = keyboard.update(&[key(Key::T, Key::T, true, Modifiers::NONE)], Attention::View);
        let shifted = keyboard.update(&[key(Key::T, Key::T, true, Modifiers::SHIFT)], Attention::View);
        assert_eq!(plain, [Pressed { action: Action::CycleHeatmap, chord: 0 }]);
        assert_eq!(shifted, [Pressed { action: Action::ToggleByReference, chord: 0 }]);
        keyboard.update(&[key(Key::W, Key::W, true, Modifiers::SHIFT)], Attention::View);
        assert!(keyboard.is_held(Action::Forward));
    }

    #[test]
    fn saved_views_are_counted_by_their_key() {
        let pressed =
            Keyboard::default().update(&[key(Key::Num3, Key::Num3, true, Modifiers::NONE)], Attention::View);
        assert_eq!(pressed, [Pressed { action: Action::GoToView, chord: 2 }]);
    }
}
