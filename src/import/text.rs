//! Decoding bytes into text, and text into logical lines: repairs that every text file of a model
//! needs.

use encoding_rs::{Encoding, GB18030, UTF_16BE, UTF_16LE, WINDOWS_1252};
use std::borrow::Cow;

/// Maximum length of a line in bytes. A longer one is a binary file or an attack.
pub(super) const LINE_BYTES: usize = 16 << 20;

/// Text of a file.
#[derive(Debug)]
pub(super) struct Decoded {
    /// The text, without a byte order mark.
    pub(super) text: String,
    /// Name of the encoding where it was guessed.
    pub(super) guessed: Option<&'static str>,
}

/// Decodes the bytes of a file. Never fails: the last resort, Windows-1252, gives every byte a
/// meaning.
pub(super) fn decode(mut bytes: Vec<u8>) -> Decoded {
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

/// Returns the warning about a text whose encoding was guessed.
pub(super) fn guessed(encoding: &str) -> String {
    format!("the text is not UTF-8; it was read as {encoding}")
}

fn decode_legacy(bytes: &[u8]) -> Decoded {
    let chinese = GB18030.decode_without_bom_handling_and_without_replacement(bytes);
    if let Some(text) = chinese.filter(|_| looks_chinese(bytes)) {
        return Decoded { text: text.into_owned(), guessed: Some("GB18030") };
    }
    let (text, _) = WINDOWS_1252.decode_without_bom_handling(bytes);
    Decoded { text: text.into_owned(), guessed: Some("Windows-1252") }
}

/// True where a text that is valid GB18030 is probably Chinese. Nearly every Western text is valid
/// GB18030 as well ("Tür" holds a valid pair). But Chinese characters are mostly two bytes above
/// 0x80, and accented letters stand alone among ASCII.
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

/// A logical line: continuations are joined, the line end is removed.
#[derive(Debug)]
pub(super) struct Line<'a> {
    /// Number of its first physical line in the file, counted from 1.
    pub(super) number: u64,
    /// Text of the line. More than [`LINE_BYTES`] mean that the line is too long to be read.
    pub(super) text: Cow<'a, str>,
}

/// Iterator over the logical lines of a text. A line ends at LF, CR LF or a lone CR; `\` before the
/// end continues it.
#[derive(Clone, Debug)]
pub(super) struct Lines<'a> {
    rest: &'a str,
    next_number: u64,
}

impl<'a> Lines<'a> {
    /// Returns the lines of `text`, the first of which has the number `first`.
    pub(super) fn new(text: &'a str, first: u64) -> Self {
        Self { rest: text, next_number: first }
    }

    /// Returns the number that the next line has.
    pub(super) fn next_number(&self) -> u64 {
        self.next_number
    }

    /// Returns the number of bytes after the last line.
    pub(super) fn bytes_left(&self) -> usize {
        self.rest.len()
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

/// Returns the place of the first LF or CR. Eight bytes are looked at together.
fn line_end(bytes: &[u8]) -> Option<usize> {
    const ONES: u64 = 0x0101_0101_0101_0101;
    const HIGH: u64 = 0x8080_8080_8080_8080;
    // The highest bit of a byte is set where it is zero, and perhaps above the first such byte.
    let zeros = |word: u64| word.wrapping_sub(ONES) & !word & HIGH;
    let (words, rest) = bytes.as_chunks();
    for (i, word) in words.iter().enumerate() {
        let word = u64::from_le_bytes(*word);
        let found = zeros(word ^ (ONES * u64::from(b'\n'))) | zeros(word ^ (ONES * u64::from(b'\r')));
        if found != 0 {
            return Some(i * 8 + found.trailing_zeros() as usize / 8);
        }
    }
    let in_rest = rest.iter().position(|&b| b == b'\n' || b == b'\r');
    in_rest.map(|at| words.len() * 8 + at)
}

/// True where a backslash at the end of a line continues it: after a digit (`f 1 2 3\`) or a blank.
/// In a comment or after a letter it is the end of a Windows folder name, and joining would lose
/// the next line.
fn continues(line: &str) -> bool {
    let Some(before) = line.strip_suffix('\\') else { return false };
    let joins = before.bytes().last().is_none_or(|b| b.is_ascii_whitespace() || b.is_ascii_digit());
    joins && !before.trim_start().starts_with('#')
}

/// Cuts a text into pieces of about `bytes` at line ends that are not continued.
pub(super) fn pieces(mut text: &str, bytes: usize) -> Vec<&str> {
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

/// False between CR and LF, and after a backslash, whether it continues the line or not.
fn may_cut(text: &[u8], after: usize) -> bool {
    let inside_crlf = text[after - 1] == b'\r' && text.get(after) == Some(&b'\n');
    let line = text[..after].strip_suffix(b"\n").unwrap_or(&text[..after]);
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    !inside_crlf && !line.ends_with(b"\\")
}

/// Splits a line into its keyword and the rest, both trimmed. The keyword of a blank line or a
/// comment is empty.
pub(super) fn keyword(line: &str) -> (&str, &str) {
    let line = line.trim_ascii_start();
    if line.starts_with('#') {
        return ("", "");
    }
    let end = line.bytes().position(|b| b.is_ascii_whitespace()).unwrap_or(line.len());
    let (key, rest) = line.split_at(end);
    (key, rest.trim_ascii())
}

/// Parses a finite number, even one with a comment attached (`1.5#left`). NaN and infinities, which
/// some C libraries print as `1.#QNAN`, are `None`.
pub(super) fn number(token: &str) -> Option<f64> {
    let before_comment = || token.split_once('#').map(|(n, _)| n).filter(|n| !n.ends_with('.'));
    let parsed = token.parse::<f64>().ok().or_else(|| before_comment()?.parse().ok());
    parsed.filter(|n| n.is_finite())
}

/// Returns numbers that are written with decimal commas (`1,5 -0,25`) with decimal points; `None`
/// where a word is no such number.
pub(super) fn with_decimal_points(rest: &str) -> Option<String> {
    let is_number = |word: &str| {
        let (whole, part) = word.split_once(',').unwrap_or((word, ""));
        let is_part =
            |text: &str| text.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'e' | b'E' | b'-' | b'+'));
        !word.contains('.') && is_part(whole) && is_part(part)
    };
    let words = || rest.split_ascii_whitespace().take_while(|word| !word.starts_with('#'));
    (rest.contains(',') && words().all(is_number))
        .then(|| words().collect::<Vec<_>>().join(" ").replace(',', "."))
}

/// Returns a name without its quotes. A comment is kept, because `wood #2` is a name; see
/// [`without_comment`].
pub(super) fn name(rest: &str) -> &str {
    let quoted = rest.strip_prefix('"').and_then(|r| r.split_once('"')).map(|(inside, _)| inside);
    quoted.unwrap_or(rest).trim()
}

/// Returns a name up to a `#` that follows a blank.
pub(super) fn without_comment(name: &str) -> &str {
    let cut = name.match_indices('#').find(|(at, _)| name[..*at].ends_with([' ', '\t']));
    cut.map_or(name, |(at, _)| name[..at].trim_end())
}

#[cfg(test)]
mod tests {
    use super::line_end;

    /// The slow twin looks at one byte at a time.
    #[test]
    fn line_ends_are_found_at_every_place() {
        for length in 0..40 {
            for (at, end) in (0..length).flat_map(|at| [(at, b'\n'), (at, b'\r')]) {
                let mut bytes: Vec<u8> = (0..length as u8).map(|i| i.wrapping_mul(37) | 0x80).collect();
                bytes[at] = end;
                let slow = bytes.iter().position(|b| matches!(b, b'\n' | b'\r'));
                assert_eq!(line_end(&bytes), slow, "{bytes:?}");
                bytes[length - 1] = b'\n';
                assert_eq!(line_end(&bytes), Some(at), "{bytes:?}");
            }
            assert_eq!(line_end(&vec![b'\x0B'; length]), None);
        }
    }
}
