//! The troubles of an import, counted by kind and turned into warnings; quotations for messages.

use super::trouble::Trouble;
use crate::scene::Warning;

/// A kind of trouble, its number, and the place of the first.
#[derive(Clone, Debug)]
struct Entry {
    trouble: Trouble,
    count: u64,
    /// Line of the first, counted from 1; 0 for files without lines.
    line: u64,
    detail: String,
}

/// The troubles of one file, counted by kind: a broken exporter repeats its mistake a hundred
/// thousand times.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    entries: Vec<Entry>,
}

/// Maximum length of a quotation from a file in a message, in characters.
const QUOTE_CHARS: usize = 100;

impl Tally {
    /// Counts a trouble. `detail` is called only for the first of its kind.
    pub(super) fn add(&mut self, trouble: Trouble, line: u64, detail: impl FnOnce() -> String) {
        match self.entries.iter_mut().find(|e| e.trouble == trouble) {
            Some(entry) => entry.count += 1,
            None => self.entries.push(Entry { trouble, count: 1, line, detail: quote(&detail()) }),
        }
    }

    /// True where a trouble of this kind was counted.
    pub(super) fn has(&self, trouble: Trouble) -> bool {
        self.entries.iter().any(|e| e.trouble == trouble)
    }

    /// Returns the troubles of a part of the file with their lines counted from that of its start.
    pub(super) fn moved(mut self, lines: u64) -> Self {
        self.entries.iter_mut().for_each(|e| e.line += lines);
        self
    }

    /// Adds the troubles of a later part of the file.
    pub(super) fn append(&mut self, later: Tally) {
        for entry in later.entries {
            match self.entries.iter_mut().find(|e| e.trouble == entry.trouble) {
                Some(mine) => mine.count += entry.count,
                None => self.entries.push(entry),
            }
        }
    }

    /// Returns the troubles as warnings about `file`, ordered by first line.
    pub(super) fn warnings(mut self, file: &str) -> Vec<Warning> {
        self.entries.sort_by_key(|e| e.line);
        let warning = |e: &Entry| Warning { file: file.to_owned(), line: e.line, message: e.sentence() };
        self.entries.iter().map(warning).collect()
    }
}

impl Entry {
    /// Returns the message: how many things of which kind, where the first one is, and what was
    /// done.
    fn sentence(&self) -> String {
        let Trouble { noun, plural, fault, done } = self.trouble;
        let (first, things) = if self.count == 1 { ("", noun) } else { ("first ", plural) };
        let place = match (self.line, self.detail.as_str()) {
            (0, "") => String::new(),
            (0, detail) => format!(" ({first}{detail})"),
            (line, "") => format!(", {first}in line {line}"),
            (line, detail) => format!(", {first}in line {line} ({detail})"),
        };
        format!("{} {things} {fault}{place}; {done}", self.count)
    }
}

/// Returns a text from a file, shortened and without control characters, for a message.
pub(super) fn quote(text: &str) -> String {
    let clean = |c: char| if c.is_control() { ' ' } else { c };
    let short: String = text.chars().take(QUOTE_CHARS).map(clean).collect();
    if text.chars().nth(QUOTE_CHARS).is_some() { format!("{short}...") } else { short }
}

/// Returns a list of names for a message: the first few, and the number of the others.
pub(super) fn list(names: &[String]) -> String {
    const SHOWN: usize = 8;
    let shown: Vec<String> = names.iter().take(SHOWN).map(|n| format!("'{}'", quote(n))).collect();
    let more = names.len().saturating_sub(SHOWN);
    if more == 0 { shown.join(", ") } else { format!("{} and {more} more", shown.join(", ")) }
}
