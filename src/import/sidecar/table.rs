//! Reading values from a TOML table, with messages that name line, key and remedy.

use crate::import::units::UnknownWord;
use crate::scene::is_valid_position;
use glam::{DVec3, Vec3};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Messages about a sidecar.
pub(super) struct Notes<'a> {
    text: &'a str,
    /// Line, counted from 1, and message.
    pub(super) messages: Vec<(u64, String)>,
    /// Number of further messages, which are only counted.
    pub(super) more: u64,
}

/// Maximum number of messages about one file: more do not help, and each costs a count of the lines
/// before it.
const MAX_MESSAGES: usize = 100;

impl<'a> Notes<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, messages: Vec::new(), more: 0 }
    }

    /// Adds a message about the text at byte `at`.
    pub(super) fn add(&mut self, at: usize, message: String) {
        if self.messages.len() < MAX_MESSAGES {
            self.messages.push((self.line(at), message));
        } else {
            self.more += 1;
        }
    }

    pub(super) fn line(&self, at: usize) -> u64 {
        let before = &self.text.as_bytes()[..at.min(self.text.len())];
        before.iter().filter(|b| **b == b'\n').count() as u64 + 1
    }
}

/// A table of a sidecar.
#[derive(Clone, Copy)]
pub(super) struct Section<'t> {
    table: &'t DeTable<'t>,
    /// Name for messages, like `[sun]`; empty for the top of the file.
    name: &'static str,
    at: usize,
}

impl<'t> Section<'t> {
    /// Takes a table. Adds a message for each key that is not in `known`, with the likeliest
    /// meaning.
    pub(super) fn new(
        table: &'t DeTable<'t>,
        name: &'static str,
        at: usize,
        known: &[&str],
        notes: &mut Notes,
    ) -> Self {
        for key in table.keys().filter(|k| !known.contains(&k.get_ref().as_ref())) {
            let place = if name.is_empty() { String::new() } else { format!(" in {name}") };
            let message =
                format!("unknown key '{}'{place}; {}", key.get_ref(), suggestion(key.get_ref(), known));
            notes.add(key.span().start, message);
        }
        Self { table, name, at }
    }

    /// Returns the name for messages, like `[sun]`.
    pub(super) fn name(&self) -> &'static str {
        self.name
    }

    /// Returns the byte at which the section starts, for messages about it as a whole.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// Returns the value of a key as `read` converts it. Adds a message where `read` returns
    /// `None`.
    fn value<T>(
        &self,
        key: &str,
        expected: &str,
        notes: &mut Notes,
        read: impl FnOnce(&'t DeValue<'t>) -> Option<T>,
    ) -> Option<T> {
        let value = self.table.get(key)?;
        let found = read(value.get_ref());
        if found.is_none() {
            let place = if self.name.is_empty() { String::new() } else { format!(" in {}", self.name) };
            notes.add(value.span().start, format!("'{key}'{place} must be {expected}; it was ignored"));
        }
        found
    }

    pub(super) fn number(
        &self,
        key: &str,
        range: std::ops::RangeInclusive<f64>,
        notes: &mut Notes,
    ) -> Option<f64> {
        let expected = format!("a number from {} to {}", range.start(), range.end());
        self.value(key, &expected, notes, |v| number(v).filter(|n| range.contains(n)))
    }

    pub(super) fn flag(&self, key: &str, notes: &mut Notes) -> Option<bool> {
        self.value(key, "true or false", notes, DeValue::as_bool)
    }

    pub(super) fn text(&self, key: &str, notes: &mut Notes) -> Option<&'t str> {
        self.value(key, "a text in quotes", notes, DeValue::as_str)
    }

    /// Returns a text, parsed. The error of `FromStr` lists what is allowed.
    pub(super) fn word<T: std::str::FromStr<Err = UnknownWord>>(
        &self,
        key: &str,
        notes: &mut Notes,
    ) -> Option<T> {
        let word = self.text(key, notes)?;
        let parsed = word.parse();
        if let Err(error) = &parsed {
            let at = self.table.get(key).map_or(self.at, |v| v.span().start);
            notes.add(at, format!("{error}; it was ignored"));
        }
        parsed.ok()
    }

    pub(super) fn point(&self, key: &str, notes: &mut Notes) -> Option<DVec3> {
        self.value(key, "three numbers, like [1.0, 2.0, 3.0]", notes, |v| {
            let [x, y, z] =
                v.as_array()?.iter().map(|n| number(n.get_ref())).collect::<Option<Vec<_>>>()?[..]
            else {
                return None;
            };
            Some(DVec3::new(x, y, z)).filter(|p| is_valid_position(*p))
        })
    }

    /// Returns a list of texts.
    pub(super) fn texts(&self, key: &str, notes: &mut Notes) -> Option<Vec<String>> {
        let text = |v: &'t Spanned<DeValue<'t>>| v.get_ref().as_str().map(str::to_owned);
        self.value(key, "a list of texts, like [\"a\", \"b\"]", notes, |v| {
            v.as_array()?.iter().map(text).collect()
        })
    }

    /// Returns a colour or radiance: one number for grey, or three, each from 0 to `max`.
    pub(super) fn color(&self, key: &str, max: f32, notes: &mut Notes) -> Option<Vec3> {
        let expected = if max <= 1.0 {
            "a colour of three numbers from 0 to 1, like [0.8, 0.8, 0.8]"
        } else {
            "a colour of three numbers from 0, like [0.8, 0.8, 0.8]"
        };
        let allowed = |c: &Vec3| c.is_finite() && c.min_element() >= 0.0 && c.max_element() <= max;
        self.value(key, expected, notes, |v| match v.as_array() {
            None => number(v).map(|grey| Vec3::splat(grey as f32)).filter(allowed),
            Some(array) => {
                let numbers: Option<Vec<f64>> = array.iter().map(|n| number(n.get_ref())).collect();
                let [r, g, b] = numbers?[..] else { return None };
                Some(DVec3::new(r, g, b).as_vec3()).filter(allowed)
            }
        })
    }

    /// Returns a table in this one.
    pub(super) fn section(
        &self,
        key: &str,
        name: &'static str,
        known: &[&str],
        notes: &mut Notes,
    ) -> Option<Section<'t>> {
        let at = self.table.get(key)?.span().start;
        let table = self.value(key, &format!("a table: {name}"), notes, DeValue::as_table)?;
        Some(Section::new(table, name, at, known, notes))
    }

    /// Returns a list of tables in this one.
    pub(super) fn sections(
        &self,
        key: &str,
        name: &'static str,
        known: &[&str],
        notes: &mut Notes,
    ) -> Vec<Section<'t>> {
        let expected = format!("a list of tables: {name}");
        let tables = self.value(key, &expected, notes, |v| {
            let with_place = |v: &'t Spanned<DeValue<'t>>| Some((v.get_ref().as_table()?, v.span().start));
            v.as_array()?.iter().map(with_place).collect::<Option<Vec<_>>>()
        });
        let tables = tables.unwrap_or_default();
        tables.into_iter().map(|(table, at)| Section::new(table, name, at, known, notes)).collect()
    }
}

fn number(value: &DeValue) -> Option<f64> {
    let digits = match value {
        DeValue::Integer(i) if i.radix() == 10 => i.as_str(),
        DeValue::Float(f) => f.as_str(),
        _ => return None,
    };
    digits.parse().ok().filter(|n: &f64| n.is_finite())
}

/// Returns "did you mean ...?" where a known word is similar, else the list of known words.
pub(super) fn suggestion(word: &str, known: &[&str]) -> String {
    let distance = |k: &&&str| edit_distance(&word.to_lowercase(), &k.to_lowercase());
    match known.iter().min_by_key(distance) {
        Some(best) if distance(&best) <= word.chars().count().max(best.len()).div_ceil(2).min(3) => {
            format!("did you mean '{best}'?")
        }
        _ if known.len() <= 16 => format!("there are {}", known.join(", ")),
        _ => "nothing has that name".to_owned(),
    }
}

/// Returns the Levenshtein distance in characters.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let change = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
