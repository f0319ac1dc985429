//! The state of the keyboard: keys that are held, and actions that are pressed.

use super::chord::{Chord, shift};
use super::{rebinding::bindings, table::Action};
use egui::{Event, Key, Modifiers};

/// An action whose key was pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pressed {
    /// Action to which the pressed key is bound.
    pub action: Action,
    /// Index of the chord among those of the action; for saved views, it selects the view.
    pub chord: usize,
}

/// Part of the window that receives keyboard input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attention {
    /// No control has the focus: all keys belong to the viewport.
    View,
    /// A control such as a button or a slider has the focus.
    Control,
    /// A text field has the focus.
    Text,
    /// A question or an open menu has the focus.
    Question,
}

/// True for actions whose function keys also act while text is typed.
fn acts_while_typing(action: Action) -> bool {
    matches!(action, Action::Help | Action::NextRegion | Action::PreviousRegion)
}

/// True for keys that type nothing.
fn is_function_key(key: Key) -> bool {
    (Key::F1..=Key::F12).contains(&key)
}

/// True for keys that operate a focused control.
fn operates_controls(key: Key) -> bool {
    matches!(key, Key::Space | Key::Enter | Key::ArrowUp | Key::ArrowDown | Key::ArrowLeft | Key::ArrowRight)
}

/// The keys that are held.
#[derive(Debug, Default)]
pub struct Keyboard {
    down: Vec<Key>,
}

impl Keyboard {
    /// Processes the events of one window frame and returns the pressed actions. While text is
    /// typed, no key is held, and only function keys that move the focus or show the help are
    /// pressed; none while a question is asked. While a control has the focus, the keys that
    /// operate it are ignored. When the window loses the focus, all keys are released, because
    /// their release events do not arrive.
    pub fn update(&mut self, events: &[Event], attention: Attention) -> Vec<Pressed> {
        let typing = matches!(attention, Attention::Text | Attention::Question);
        let is_taken = |key| match attention {
            Attention::View => false,
            Attention::Control => operates_controls(key),
            Attention::Text => !is_function_key(key),
            Attention::Question => true,
        };
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
            pressed.retain(|p: &Pressed| acts_while_typing(p.action));
        }
        pressed
    }

    fn press(&mut self, key: Key, place: Key, modifiers: Modifiers, pressed: &mut Vec<Pressed>) {
        if !modifiers.command && !self.down.contains(&place) {
            self.down.push(place);
        }
        // The position of the question mark depends on the layout, so this key is identified by its
        // character.
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

    /// True while any key of an action is held.
    pub fn is_held(&self, action: Action) -> bool {
        let is_down = |c: &Chord| self.down.contains(&c.key);
        bindings().iter().any(|b| b.held && b.action == action && b.chords.iter().any(is_down))
    }

    /// +1, -1 or 0, from two opposite actions.
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
    fn keys_are_identified_by_position_and_held_until_released() {
        let mut keyboard = Keyboard::default();
        // On a French keyboard, the key at the position of W is Z.
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
    fn a_focused_control_keeps_only_the_keys_that_operate_it() {
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
    fn shift_selects_another_action_but_does_not_stop_flying() {
        let mut keyboard = Keyboard::default();
        let plain = keyboard.update(&[key(Key::T, Key::T, true, Modifiers::NONE)], Attention::View);
        let shifted = keyboard.update(&[key(Key::T, Key::T, true, Modifiers::SHIFT)], Attention::View);
        assert_eq!(plain, [Pressed { action: Action::CycleHeatmap, chord: 0 }]);
        assert_eq!(shifted, [Pressed { action: Action::ToggleByReference, chord: 0 }]);
        keyboard.update(&[key(Key::W, Key::W, true, Modifiers::SHIFT)], Attention::View);
        assert!(keyboard.is_held(Action::Forward));
    }

    #[test]
    fn the_number_key_selects_the_saved_view() {
        let pressed =
            Keyboard::default().update(&[key(Key::Num3, Key::Num3, true, Modifiers::NONE)], Attention::View);
        assert_eq!(pressed, [Pressed { action: Action::GoToView, chord: 2 }]);
    }
}
