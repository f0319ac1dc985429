//! Keys as text.

use super::rebinding::bindings;
use super::table::{Action, Binding, GROUPS, MOUSE};

/// Keys of an action as text, for menus and hover texts.
pub fn keys_of(action: Action) -> String {
    bindings().iter().find(|b| b.action == action).map(Binding::keys).unwrap_or_default()
}

/// A group of the help.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HelpGroup {
    /// Name of the group.
    pub name: &'static str,
    /// Keys or input, and what they do.
    pub lines: Vec<(String, &'static str)>,
}

impl HelpGroup {
    /// The group with the lines that contain every word of `filter` in any case, in their keys,
    /// their text or the name of the group.
    #[must_use]
    pub fn filtered(mut self, filter: &str) -> Self {
        let words: Vec<String> = filter.split_whitespace().map(str::to_lowercase).collect();
        self.lines.retain(|(keys, help)| {
            let text = format!("{keys} {help} {}", self.name).to_lowercase();
            words.iter().all(|word| text.contains(word))
        });
        self
    }
}

/// All keys in groups, and the mouse as the last group.
pub fn help_groups() -> Vec<HelpGroup> {
    let begin = |action| bindings().iter().position(|b| b.action == action).unwrap_or(bindings().len());
    let begins: Vec<usize> =
        GROUPS.iter().map(|(_, first)| begin(*first)).chain([bindings().len()]).collect();
    let mut groups: Vec<HelpGroup> = GROUPS
        .iter()
        .zip(begins.windows(2))
        .map(|((name, _), range)| {
            let bindings = &bindings()[range[0]..range[1]];
            HelpGroup { name, lines: bindings.iter().map(|b| (b.keys(), b.help)).collect() }
        })
        .collect();
    let mouse = MOUSE.iter().map(|(input, help)| ((*input).to_owned(), *help)).collect();
    groups.push(HelpGroup { name: "Mouse and modifiers", lines: mouse });
    groups
}

/// All keys as lines of text, for `--help`.
pub fn help_text() -> String {
    let line = |(keys, help): &(String, &str)| format!("  {keys:<28} {help}\n");
    let group = |group: &HelpGroup| group.lines.iter().map(line).collect::<String>();
    help_groups().iter().map(|lines| format!(" {}:\n{}", lines.name, group(lines))).collect()
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
    fn every_binding_is_in_one_group_in_the_order_of_the_table() {
        let groups = help_groups();
        let listed: Vec<&str> = groups.iter().flat_map(|group| &group.lines).map(|line| line.1).collect();
        let expected = BINDINGS.iter().map(|b| b.help).chain(MOUSE.iter().map(|line| line.1));
        assert!(listed.into_iter().eq(expected));
        assert!(groups.iter().all(|group| !group.lines.is_empty()));
    }

    #[test]
    fn a_filter_finds_keys_and_words_in_any_case() {
        let found = |filter: &str| -> Vec<&str> {
            let groups = help_groups().into_iter().map(|group| group.filtered(filter));
            groups.flat_map(|group| group.lines).map(|line| line.1).collect()
        };
        assert_eq!(found("CTRL+O"), ["open a model, a session or a picture's view"]);
        assert_eq!(found("Horizon LEVEL"), ["level the horizon"]);
        assert!(found("mouse wheel").contains(&"fly towards the cursor"));
        assert!(found("no such word").is_empty());
        assert_eq!(found("  ").len(), BINDINGS.len() + MOUSE.len());
    }

    #[test]
    fn help_lists_all_bindings() {
        let text = help_text();
        assert!(BINDINGS.iter().all(|b| text.contains(b.help) && text.contains(&b.keys())));
        assert!(text.contains("1-9"));
    }
}
