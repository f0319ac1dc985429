//! The lines of numbers of an OBJ file (`v`, `vt`, `vn`): where they are, and how they are written
//! for `tobj`.
//!
//! Nearly all numbers are plain. Those are checked without being parsed, and copied as they are:
//! only `tobj` parses them.

use super::piece::Counts;
use crate::import::text::{self, Lines};
use crate::import::{tally::Tally, trouble::Trouble};
use glam::Vec3;

/// Largest texture coordinate of which f64 keeps an eighth of a picture.
const UV_MAX: f64 = 1e15;

/// Maximum number of digits before the decimal point of a number that is plain: it is below
/// [`UV_MAX`].
const PLAIN_DIGITS: usize = 15;

/// The lines of numbers in one piece of text.
#[derive(Debug, Default)]
pub(super) struct NumberLines {
    /// The byte in the piece at which each line begins.
    pub(super) positions: Vec<u32>,
    pub(super) uvs: Vec<u32>,
    pub(super) normals: Vec<u32>,
    /// Indices in the piece of the vertices that are refused, ascending.
    pub(super) refused: Vec<u32>,
    /// A vertex has a colour.
    pub(super) has_colors: bool,
    lines: u64,
    /// Troubles, with lines counted from the first of the piece.
    pub(super) tally: Tally,
}

impl NumberLines {
    /// Finds the lines of numbers in a piece of text, and checks them.
    pub(super) fn find(text: &str) -> Self {
        let mut found = Self::default();
        let mut lines = Lines::new(text, 0);
        loop {
            // A piece is longer than 4 GB only where it is no text; its lines are then not found
            // again.
            let at = u32::try_from(text.len() - lines.bytes_left()).unwrap_or(u32::MAX);
            let Some(line) = lines.next() else { break };
            let (key, rest) = text::keyword(&line.text);
            match key {
                "v" => found.position(at, line.number, rest),
                "vt" => found.uv(at, line.number, rest),
                "vn" => found.normal(at, line.number, rest),
                _ => {}
            }
        }
        found.lines = lines.next_number();
        found
    }

    pub(super) fn counts(&self) -> Counts {
        let Self { lines, positions, uvs, normals, .. } = self;
        Counts { lines: *lines, positions: positions.len(), uvs: uvs.len(), normals: normals.len() }
    }

    fn position(&mut self, at: u32, line: u64, rest: &str) {
        match plain_end(rest, 3) {
            Some(end) if end == rest.len() => {}
            Some(_) => self.has_colors = self.has_colors || color(rest).is_some(),
            None if self.can_be_read::<3>(line, rest) => {
                self.has_colors = self.has_colors || color(rest).is_some();
            }
            None => {
                self.tally.add(Trouble::VERTEX_UNREADABLE, line, || rest.to_owned());
                self.refused.push(self.positions.len() as u32);
            }
        }
        self.positions.push(at);
    }

    fn normal(&mut self, at: u32, line: u64, rest: &str) {
        if plain_end(rest, 3).is_none() && !self.can_be_read::<3>(line, rest) {
            self.tally.add(Trouble::NORMAL_UNREADABLE, line, || rest.to_owned());
        }
        self.normals.push(at);
    }

    fn uv(&mut self, at: u32, line: u64, rest: &str) {
        if plain_end(rest, 2).is_none() {
            self.can_be_read::<2>(line, rest);
            if uv(rest).is_none() {
                self.tally.add(Trouble::UV_UNREADABLE, line, || rest.to_owned());
            }
        }
        self.uvs.push(at);
    }

    /// True where a line begins with `N` numbers, which may have decimal commas.
    fn can_be_read<const N: usize>(&mut self, line: u64, rest: &str) -> bool {
        let has_points = numbers::<N>(rest).is_some();
        let has_commas = !has_points && numbers_with_commas::<N>(rest).is_some();
        if has_commas {
            self.tally.add(Trouble::DECIMAL_COMMA, line, || rest.to_owned());
        }
        has_points || has_commas
    }
}

/// Writes a vertex: NaN where it is refused, and with a colour where the vertices of the file have
/// colours, NaN where this one has none.
pub(super) fn write_position(text: &mut String, rest: &str, has_colors: bool) {
    text.push('v');
    if let Some(end) = plain_end(rest, 3) {
        push_plain(text, &rest[..end]);
    } else {
        push(text, numbers(rest).or_else(|| numbers_with_commas(rest)).unwrap_or([f64::NAN; 3]));
    }
    if has_colors {
        push(text, color(rest).map_or([f64::NAN; 3], |color| color.as_dvec3().to_array()));
    }
    text.push('\n');
}

/// Writes a normal: zero where it cannot be read.
pub(super) fn write_normal(text: &mut String, rest: &str) {
    text.push_str("vn");
    if let Some(end) = plain_end(rest, 3) {
        push_plain(text, &rest[..end]);
    } else {
        push(text, numbers(rest).or_else(|| numbers_with_commas(rest)).unwrap_or([0.0; 3]));
    }
    text.push('\n');
}

/// Writes a texture coordinate: zero where it cannot be read.
pub(super) fn write_uv(text: &mut String, rest: &str) {
    text.push_str("vt");
    if let Some(end) = plain_end(rest, 2) {
        push_plain(text, &rest[..end]);
    } else {
        push(text, uv(rest).unwrap_or([0.0; 2]));
    }
    text.push('\n');
}

fn push_plain(text: &mut String, numbers: &str) {
    text.push(' ');
    text.push_str(numbers);
}

fn push<const N: usize>(text: &mut String, numbers: [f64; N]) {
    numbers.iter().for_each(|number| text.push_str(&format!(" {number:e}")));
}

/// Returns the end of the first `count` numbers of a line where all of them are plain.
fn plain_end(line: &str, count: usize) -> Option<usize> {
    let bytes = line.as_bytes();
    let mut at = 0;
    for _ in 0..count {
        at += bytes[at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
        at += plain_number(&bytes[at..])?;
    }
    Some(at)
}

/// Returns the length of a number at the start of a text that every parser reads alike: digits with
/// a point and an exponent that is not positive, which may be left out.
fn plain_number(bytes: &[u8]) -> Option<usize> {
    let digits = |from: usize| bytes.iter().skip(from).take_while(|b| b.is_ascii_digit()).count();
    let sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let whole = digits(sign);
    let mut end = sign + whole;
    let mut all = whole;
    if bytes.get(end) == Some(&b'.') {
        let part = digits(end + 1);
        (end, all) = (end + 1 + part, all + part);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let exponent = digits(end + 2);
        let is_small = bytes.get(end + 1) == Some(&b'-') && (1..=3).contains(&exponent);
        end = is_small.then_some(end + 2 + exponent)?;
    }
    let is_whole = bytes.get(end).is_none_or(u8::is_ascii_whitespace);
    (is_whole && all > 0 && whole <= PLAIN_DIGITS).then_some(end)
}

/// Returns the colour of a vertex, red, green and blue, where three numbers or more follow the
/// position. `v x y z w` has none; of seven numbers, the last is alpha.
fn color(rest: &str) -> Option<Vec3> {
    let mut tokens = rest.split_ascii_whitespace().skip(3).take_while(|token| !token.starts_with('#'));
    let mut channel = || tokens.next().and_then(text::number).map(|number| number as f32);
    Some(Vec3::new(channel()?, channel()?, channel()?)).filter(|color| color.is_finite())
}

/// Returns a texture coordinate. `vt u` alone is valid; v is then 0.
fn uv(rest: &str) -> Option<[f64; 2]> {
    let both = numbers(rest).or_else(|| numbers_with_commas(rest));
    let uv = both.or_else(|| numbers::<1>(rest).map(|[u]| [u, 0.0]));
    uv.filter(|uv| uv.iter().all(|c| c.abs() <= UV_MAX))
}

/// Returns the first `N` numbers of a line. What follows (a weight, a colour) is ignored.
fn numbers<const N: usize>(rest: &str) -> Option<[f64; N]> {
    let mut tokens = rest.split_ascii_whitespace();
    let mut found = [0.0; N];
    for slot in &mut found {
        *slot = text::number(tokens.next()?)?;
    }
    Some(found)
}

/// Returns the first `N` numbers of a line that is written with decimal commas.
fn numbers_with_commas<const N: usize>(rest: &str) -> Option<[f64; N]> {
    numbers(&text::with_decimal_points(rest)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is copied is a number below the limit for every parser; nothing else is.
    #[test]
    fn plain_numbers_are_numbers() {
        for plain in ["0", "-1", "+1.", ".5", "-.5e-10", "1.25", "1E-3", "123456789012345.9", "5e-300"] {
            assert_eq!(plain_number(plain.as_bytes()), Some(plain.len()), "{plain}");
            let followed = format!("{plain}\t7");
            assert_eq!(plain_number(followed.as_bytes()), Some(plain.len()), "{plain}");
            assert!(plain.parse::<f64>().unwrap().abs() < UV_MAX, "{plain}");
        }
        let others = [
            "",
            "-",
            ".",
            "+.",
            "1e5",
            "e-5",
            "1e-",
            "1e-0000",
            "1,5",
            "1#",
            "nan",
            "0x1",
            "1234567890123456",
        ];
        for other in others {
            assert_eq!(plain_number(other.as_bytes()), None, "{other}");
        }
    }

    #[test]
    fn what_cannot_be_copied_is_written_from_its_numbers() {
        let written = |rest: &str, has_colors: bool| {
            let mut text = String::new();
            write_position(&mut text, rest, has_colors);
            text
        };
        assert_eq!(written("1  2\t3 4", false), "v 1  2\t3\n");
        assert_eq!(written("1,5 2 1e3", false), "v 1.5e0 2e0 1e3\n");
        assert_eq!(written("1 2 x", false), "v NaN NaN NaN\n");
        assert_eq!(written("1 2 3 1 0.5 0 1", true), "v 1 2 3 1e0 5e-1 0e0\n");
        assert_eq!(written("1 2 3", true), "v 1 2 3 NaN NaN NaN\n");
    }
}
