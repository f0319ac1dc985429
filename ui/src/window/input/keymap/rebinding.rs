//! Key bindings that the section `[keys]` of the settings changes.

use super::chord::Chord;
use super::table::{Action, BINDINGS, Binding};
use crate::settings::suggestion;
use anyhow::{Context, bail};
use clap::ValueEnum;
use std::sync::OnceLock;
use toml::{Table, Value};

/// Why `[keys]` is ignored: one message for each problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeysError(Vec<String>);

impl std::error::Error for KeysError {}

impl std::fmt::Display for KeysError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "[keys] is ignored and the default keys apply: {}", self.0.join("; "))
    }
}

static REBOUND: OnceLock<Vec<Binding>> = OnceLock::new();

/// The current bindings: [`BINDINGS`] with the changes of [`install`].
pub fn bindings() -> &'static [Binding] {
    REBOUND.get().map_or(BINDINGS, Vec::as_slice)
}

/// Changes bindings once at startup, before any key is shown or pressed.
///
/// # Errors
/// As [`rebound`]; the default keys then remain.
pub fn install(keys: &Table) -> Result<(), KeysError> {
    let table = rebound(keys)?;
    // A second call in one process has no effect, because the keys of the first are shown already.
    let _ = REBOUND.set(table);
    Ok(())
}

/// The default bindings with other keys for some actions: `add-reference = "B"`, `forward = ["W",
/// "Up"]`; an empty list removes the keys of an action.
///
/// # Errors
/// If an action or a key is unknown, or a key is bound to two actions: one message for all
/// problems.
pub fn rebound(keys: &Table) -> Result<Vec<Binding>, KeysError> {
    let names: Vec<String> = BINDINGS.iter().map(|b| b.action.name()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let (mut table, mut problems) = (BINDINGS.to_vec(), Vec::new());
    for (name, value) in keys {
        match (names.iter().position(|n| n == name), chords(value)) {
            (None, _) => problems.push(format!("there is no action '{name}', {}", suggestion(name, &names))),
            (_, Err(cause)) => problems.push(format!("{name}: {cause}")),
            // This runs once per process.
            (Some(at), Ok(chords)) => table[at].chords = chords.leak(),
        }
    }
    problems.extend(conflicts(&table));
    if problems.is_empty() { Ok(table) } else { Err(KeysError(problems)) }
}

/// Messages about keys that are bound to two actions. The key of a held action conflicts with other
/// held actions independently of modifiers, because held actions ignore these.
fn conflicts(table: &[Binding]) -> Vec<String> {
    let all: Vec<(&Binding, Chord)> =
        table.iter().flat_map(|b| b.chords.iter().map(move |c| (b, *c))).collect();
    let clash = |(a, x): &(&Binding, Chord), (b, y): &(&Binding, Chord)| {
        x == y || ((a.held && b.held) && x.key == y.key)
    };
    let mut problems = Vec::new();
    for (i, first) in all.iter().enumerate() {
        for second in all[i + 1..].iter().filter(|second| clash(first, second)) {
            let (a, b) = (first.0.action.name(), second.0.action.name());
            problems.push(format!("{} is bound to both {a} and {b}", second.1.name()));
        }
    }
    problems
}

fn chords(value: &Value) -> anyhow::Result<Vec<Chord>> {
    const EXPECTED: &str = "the value must be a key like \"Ctrl+K\" or a list of keys";
    match value {
        Value::String(text) => Ok(vec![Chord::parse(text)?]),
        Value::Array(list) => list.iter().map(|v| Chord::parse(v.as_str().context(EXPECTED)?)).collect(),
        _ => bail!(EXPECTED),
    }
}

impl Action {
    /// Name of the action in the settings file, such as `add-reference`.
    pub fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<Vec<Binding>, KeysError> {
        rebound(&text.parse().unwrap())
    }

    #[test]
    fn keys_can_be_changed() {
        let table = table("add-reference = 'B'\nforward = ['W', 'I']\nnext-view = []\nlevel = 'L'").unwrap();
        let keys = |action| table.iter().find(|b| b.action == action).map(Binding::keys);
        assert_eq!(keys(Action::AddReference).as_deref(), Some("B"));
        assert_eq!(keys(Action::Forward).as_deref(), Some("W, I"));
        assert_eq!(keys(Action::NextView).as_deref(), Some(""));
        assert_eq!(keys(Action::Level).as_deref(), Some("L"));
        assert_eq!(keys(Action::Back), BINDINGS.iter().find(|b| b.action == Action::Back).map(Binding::keys));
    }

    #[test]
    fn conflicts_and_mistakes_are_reported_in_one_message() {
        let text_of_error = |text| table(text).unwrap_err().to_string();
        let error = text_of_error("add-reference = 'K'\nadd-refrence = 'B'\nlevel = 'Hyper+J'\nfocus = 7");
        for words in [
            "K is bound to both add-path-key and add-reference",
            "did you mean 'add-reference'?",
            "no key 'Hyper+J'",
            "a key like",
            "the default keys apply",
        ] {
            assert!(error.contains(words), "'{words}' is not in: {error}");
        }
        assert!(text_of_error("pause = 'Tab'").contains("focus"));
        assert!(text_of_error("forward = 'Ctrl+W'\nback = 'W'").contains("both"));
    }
}
