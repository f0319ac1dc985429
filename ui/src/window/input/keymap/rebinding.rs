//! Other keys than the usual ones, as `[keys]` of the settings names them.

use crate::settings::suggestion;
use crate::window::input::keymap::chord::Chord;
use crate::window::input::keymap::{Action, BINDINGS, Binding};
use std::sync::OnceLock;
use toml::{Table, Value};

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

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<Vec<Binding>, String> {
        rebound(&text.parse().unwrap())
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
