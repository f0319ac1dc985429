//! Bytes to text, and text to logical lines: the repairs that every text file of a model needs.

use encoding_rs::{Encoding, GB18030, UTF_16BE, UTF_16LE, WINDOWS_1252};
use std::borrow::Cow;

/// Longest line looked at. A longer one is a binary file or an attack.
pub(crate) const LINE_BYTES: usize = 16 << 20;

/// A file's text.
#[derive(Debug)]
pub(crate) struct Decoded {
    /// As UTF-8, without a byte order mark.
    pub(crate) text: String,
    /// The encoding, where it had to be guessed.
    pub(crate) guessed: Option<&'static str>,
}

/// Takes a file's bytes; returns its text. Never fails: the last resort, Windows-1252, gives every byte a meaning.
pub(crate) fn decode(mut bytes: Vec<u8>) -> Decoded {
    if let Some((encoding, _)) = Encoding::for_bom(&bytes).filter(|(e, _)| *e == UTF_16LE || *e == UTF_16BE) {
        let (text, _) = encoding.decode_with_bom_removal(&bytes);
        return Decoded { text: text.into_owned(), guessed: None };
    }
    if bytes.starts_with(b"\xEF\xBB\xBF") {
        bytes.drain(..3);
    }
    match String::from_utf8(bytes) {
        Ok(text) => Decoded { text, guessed: None },
        Err(error) => decode_legacy(error.as_bytes()),
    }
}

fn decode_legacy(bytes: &[u8]) -> Decoded {
    let chinese = GB18030.decode_without_bom_handling_and_without_replacement(bytes);
    if let Some(text) = chinese.filter(|_| looks_chinese(bytes)) {
        return Decoded { text: text.into_owned(), guessed: Some("GB18030") };
    }
    let (text, _) = WINDOWS_1252.decode_without_bom_handling(bytes);
    Decoded { text: text.into_owned(), guessed: Some("Windows-1252") }
}

/// Nearly every Western text is also valid GB18030 ("Tür" holds a valid pair). What tells them apart: Chinese
/// characters are mostly two bytes above 0x80, accented letters stand alone among ASCII.
fn looks_chinese(bytes: &[u8]) -> bool {
    let (mut pairs, mut singles, mut i) = (0usize, 0usize, 0);
    while i < bytes.len() {
        let high = bytes[i] >= 0x80;
        let next_high = bytes.get(i + 1).is_some_and(|b| *b >= 0x80);
        pairs += usize::from(high && next_high);
        singles += usize::from(high && !next_high);
        i += if high { 2 } else { 1 };
    }
    pairs > singles
}

/// A logical line: continuations joined, line end removed.
#[derive(Debug)]
pub(crate) struct Line<'a> {
    /// Number of its first physical line in the file, from 1.
    pub(crate) number: u64,
    /// The text. Longer than [`LINE_BYTES`] only where the line is too long to be taken seriously.
    pub(crate) text: Cow<'a, str>,
}

/// The logical lines of a text. A line ends at LF, CR LF or a lone CR; `\` before the end continues it.
#[derive(Clone, Debug)]
pub(crate) struct Lines<'a> {
    rest: &'a str,
    next_number: u64,
}

impl<'a> Lines<'a> {
    /// The lines of `text`, whose first has number `first`.
    pub(crate) fn new(text: &'a str, first: u64) -> Self {
        Self { rest: text, next_number: first }
    }

    /// The number that the next line would have.
    pub(crate) fn next_number(&self) -> u64 {
        self.next_number
    }

    fn physical(&mut self) -> Option<&'a str> {
        if self.rest.is_empty() {
            return None;
        }
        let looked_at = &self.rest.as_bytes()[..self.rest.len().min(LINE_BYTES + 8)];
        let end = match line_end(looked_at) {
            Some(end) => end,
            None => self.rest.floor_char_boundary(looked_at.len()),
        };
        let (line, rest) = self.rest.split_at(end);
        self.rest = rest.strip_prefix("\r\n").or_else(|| rest.get(1..)).unwrap_or("");
        self.next_number += 1;
        Some(line)
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let number = self.next_number;
        let first = self.physical()?;
        if !continues(first) {
            return Some(Line { number, text: Cow::Borrowed(first) });
        }
        let mut joined = String::new();
        let mut part = first;
        loop {
            let more = continues(part);
            joined.push_str(if more { &part[..part.len() - 1] } else { part });
            joined.push(' ');
            if !more || joined.len() > LINE_BYTES {
                break;
            }
            match self.physical() {
                Some(next) => part = next,
                None => break,
            }
        }
        Some(Line { number, text: Cow::Owned(joined) })
    }
}

fn line_end(bytes: &[u8]) -> Option<usize> {
    bytes.iter().position(|&b| b == b'\n' || b == b'\r')
}

/// A backslash at the end continues numbers (`f 1 2 3\`) or stands after a blank. In a comment or after a letter it is
/// the end of a Windows folder name, and joining would swallow the next line.
fn continues(line: &str) -> bool {
    let Some(before) = line.strip_suffix('\\') else { return false };
    let joins = before.bytes().last().is_none_or(|b| b.is_ascii_whitespace() || b.is_ascii_digit());
    joins && !before.trim_start().starts_with('#')
}

/// Cuts a text into pieces of about `bytes` at line ends that are not continued.
pub(crate) fn pieces(mut text: &str, bytes: usize) -> Vec<&str> {
    let mut found = Vec::new();
    while text.len() > bytes {
        let mut at = bytes;
        let end = loop {
            let Some(offset) = line_end(&text.as_bytes()[at..]) else { break text.len() };
            let after = at + offset + 1;
            if may_cut(text.as_bytes(), after) {
                break after;
            }
            at = after;
        };
        let (piece, rest) = text.split_at(end);
        found.push(piece);
        text = rest;
    }
    found.push(text);
    found
}

/// Never between CR and LF, and never after a backslash, whether it continues the line or not.
fn may_cut(text: &[u8], after: usize) -> bool {
    let inside_crlf = text[after - 1] == b'\r' && text.get(after) == Some(&b'\n');
    let line = text[..after].strip_suffix(b"\n").unwrap_or(&text[..after]);
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    !inside_crlf && !line.ends_with(b"\\")
}

/// The keyword of a line and what follows it, both trimmed; empty keyword for a blank line or a comment.
pub(crate) fn keyword(line: &str) -> (&str, &str) {
    let line = line.trim_ascii_start();
    if line.starts_with('#') {
        return ("", "");
    }
    let end = line.bytes().position(|b| b.is_ascii_whitespace()).unwrap_or(line.len());
    let (key, rest) = line.split_at(end);
    (key, rest.trim_ascii())
}

/// A number, even one with a comment stuck to it (`1.5#left`). `None` also for NaN and infinities, which some C
/// libraries print as `1.#QNAN`.
pub(crate) fn number(token: &str) -> Option<f64> {
    let before_comment = || token.split_once('#').map(|(n, _)| n).filter(|n| !n.ends_with('.'));
    let parsed = token.parse::<f64>().ok().or_else(|| before_comment()?.parse().ok());
    parsed.filter(|n| n.is_finite())
}

/// A name as written: quotes stripped. A comment is kept, since `wood #2` is a name; see [`without_comment`].
pub(crate) fn name(rest: &str) -> &str {
    let quoted = rest.strip_prefix('"').and_then(|r| r.split_once('"')).map(|(inside, _)| inside);
    quoted.unwrap_or(rest).trim()
}

/// A name up to a `#` that follows a blank.
pub(crate) fn without_comment(name: &str) -> &str {
    let cut = name.match_indices('#').find(|(at, _)| name[..*at].ends_with([' ', '\t']));
    cut.map_or(name, |(at, _)| name[..at].trim_end())
}
