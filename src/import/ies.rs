//! Photometric files of lamps: IES LM-63 of 1986, 1991, 1995, 2002 and 2019.
//!
//! Source: ANSI/IES LM-63-19, "Standard File Format for the Electronic Transfer of Photometric
//! Data". We differ: numbers may be spread over any lines, as in files of all ages; keywords, the
//! size of the lamp and its power are not needed; and what the lamp loses when it is tilted counts
//! only where it hangs as it was measured.

use super::{files, options::Limits, search::Finder, text};
use crate::scene::{LightProfile, ProfileAngles};

/// Maximum size of a file, in bytes. A grid of one degree has less than 1 MB.
const MAX_BYTES: u64 = 4 << 20;

/// Maximum number of angles in one direction.
const MAX_ANGLES: usize = 1 << 14;

/// A photometric file.
#[derive(Debug)]
pub(super) struct IesFile {
    pub(super) profile: LightProfile,
    /// Largest intensity, in candela.
    pub(super) candela: f64,
    /// A part of the file without effect, and what follows; `None` where there is none.
    pub(super) note: Option<String>,
}

/// Why a photometric file is not used.
#[derive(Debug, thiserror::Error)]
#[error("line {line}: {cause}; {remedy}")]
pub(super) struct IesError {
    /// Line, counted from 1.
    line: u64,
    cause: String,
    remedy: &'static str,
}

const EXPORT: &str = "ask its maker for a correct file, or leave out the profile";

/// Reads a file that a model names. The error says why it is not used, and what to do.
pub(super) fn load(name: &str, finder: &mut Finder) -> Result<IesFile, String> {
    let found = finder.library(name);
    let Some(file) = found.file else {
        let outside = if found.outside {
            "; files outside the scene's folder are opened only when that is allowed"
        } else {
            ""
        };
        return Err(format!("the file was not found. Tried: {}{outside}", found.tried.join(", ")));
    };
    read(&files::read_limited(&file, MAX_BYTES).map_err(|error| error.to_string())?)
}

/// Reads the bytes of a file. The error says where and why it is not used, and what to do.
pub(super) fn read(bytes: &[u8]) -> Result<IesFile, String> {
    if bytes.len() as u64 > MAX_BYTES {
        return Err(format!("it is larger than {} MB; {EXPORT}", MAX_BYTES >> 20));
    }
    parse(&text::decode(bytes.to_vec()).text).map_err(|error| error.to_string())
}

/// Parses the text of a file.
fn parse(text: &str) -> Result<IesFile, IesError> {
    let mut reader = Reader::new(text);
    let (tilt_factor, note) = match reader.skip_to_tilt()? {
        Tilt::None => (1.0, None),
        Tilt::Include => (reader.tilt_factor()?, None),
        Tilt::File(name) => (
            1.0,
            Some(format!(
                "the file '{name}' of its light when tilted is not read; the lamp is as bright as it was measured"
            )),
        ),
    };
    let head = Head::read(&mut reader)?;
    let (profile, most) = grid(&head, &mut reader)?;
    let candela = most * head.factor * tilt_factor;
    if candela > 0.0 && candela <= f64::from(Limits::RADIANCE) {
        Ok(IesFile { profile, candela, note })
    } else {
        let cause =
            format!("with its factors the largest intensity is {candela:e} candela, which no lamp has");
        Err(reader.error(reader.line, cause))
    }
}

/// Reads angles and intensities. Returns the profile and the largest intensity.
fn grid(head: &Head, reader: &mut Reader) -> Result<(LightProfile, f64), IesError> {
    let vertical = reader.angles(head.vertical, "vertical")?;
    let horizontal = reader.angles(head.horizontal, "horizontal")?;
    // Every intensity takes two bytes at least.
    let (count, columns) = (head.vertical * head.horizontal, head.vertical);
    if count > reader.bytes_left().div_ceil(2) {
        let cause = format!("{count} intensities are announced, and the file ends before");
        return Err(reader.error(reader.line, cause));
    }
    let intensities = (0..count).map(|_| reader.intensity()).collect::<Result<Vec<f64>, IesError>>()?;
    let (planes, heights) = (head.planes(&horizontal, reader)?, head.heights(&vertical, reader)?);
    let of_plane = |(_, plane): &(f64, usize)| {
        heights.iter().map(|(_, height)| intensities[plane * columns + height]).collect::<Vec<f64>>()
    };
    let all: Vec<f64> = planes.iter().flat_map(of_plane).collect();
    let [horizontal, vertical] =
        [&planes, &heights].map(|of| of.iter().map(|(a, _)| *a).collect::<Vec<f64>>());
    let profile = LightProfile::new(head.angles, [&horizontal, &vertical], &all);
    profile.ok_or_else(|| reader.error(reader.line, "all intensities are zero".to_owned()))
}

enum Tilt {
    None,
    Include,
    File(String),
}

/// The numbers before the angles.
struct Head {
    /// Candela for an intensity of one.
    factor: f64,
    angles: ProfileAngles,
    vertical: usize,
    horizontal: usize,
}

impl Head {
    fn read(reader: &mut Reader) -> Result<Self, IesError> {
        let _lamps = reader.number("the number of lamps")?;
        let _lumens = reader.number("the lumens of a lamp")?;
        let multiplier = reader.number("the factor of the intensities")?;
        let vertical = reader.count("vertical")?;
        let horizontal = reader.count("horizontal")?;
        let angles = match reader.number("the type of photometry")? {
            1.0 => ProfileAngles::AroundAim,
            2.0 => ProfileAngles::AroundSide,
            3.0 => ProfileAngles::AroundUp,
            other => {
                let cause = format!("{other} is not a type of photometry, which are 1, 2 and 3");
                return Err(reader.error(reader.line, cause));
            }
        };
        for what in ["the unit of length", "the width", "the length", "the height"] {
            reader.number(what)?;
        }
        let ballast = reader.number("the ballast factor")?;
        // Of LM-63-1986 and 1991; one in later files.
        let ballast_lamp = reader.number("the ballast-lamp factor")?;
        let _watts = reader.number("the power")?;
        let or_one = |factor: f64| if factor > 0.0 { factor } else { 1.0 };
        let factor = or_one(multiplier) * or_one(ballast) * or_one(ballast_lamp);
        Ok(Self { factor, angles, vertical, horizontal })
    }

    /// Horizontal angles of all planes, ascending, each with the index of the plane in the file
    /// that it repeats by the symmetry that their range stands for.
    fn planes(&self, angles: &[f64], reader: &Reader) -> Result<Vec<(f64, usize)>, IesError> {
        let [first, last] = [angles[0], angles[angles.len() - 1]];
        if self.angles != ProfileAngles::AroundAim {
            return match first >= -90.0 && last <= 90.0 {
                true => Ok(both_sides(angles)),
                false => Err(reader.error(reader.line, "a horizontal angle is beyond 90 degrees".to_owned())),
            };
        }
        let images: fn(f64) -> Vec<f64> = match [first, last] {
            _ if angles.len() == 1 => return Ok(vec![(0.0, 0)]),
            [0.0, 90.0] => |a| vec![a, 180.0 - a, 180.0 + a, 360.0 - a],
            [0.0, 180.0] => |a| vec![a, 360.0 - a],
            [90.0, 270.0] => |a| vec![a, 180.0 - a, 540.0 - a],
            // The plane at 360 degrees is that at 0, and may be left out.
            [first, last] if first >= 0.0 && last > 180.0 && last <= 360.0 => |a| vec![a],
            _ => {
                let cause = format!(
                    "the horizontal angles go from {first} to {last} degrees, and not from 0 to 0, 90, 180 or 360"
                );
                return Err(reader.error(reader.line, cause));
            }
        };
        let of_plane = |(plane, &angle): (usize, &f64)| {
            let turns = |a: f64| [a - 360.0, a, a + 360.0];
            images(angle).into_iter().flat_map(turns).map(move |a| (a, plane)).collect::<Vec<_>>()
        };
        let mut planes: Vec<(f64, usize)> = angles.iter().enumerate().flat_map(of_plane).collect();
        planes.sort_by(|a, b| a.0.total_cmp(&b.0));
        planes.dedup_by(|a, b| a.0 == b.0);
        // Keep one turn, and the planes around its ends.
        let begin = planes.partition_point(|(a, _)| *a <= 0.0).saturating_sub(1);
        let end = planes.partition_point(|(a, _)| *a < 360.0) + 1;
        Ok(planes[begin..end.min(planes.len())].to_vec())
    }

    /// Vertical angles, ascending, each with the index of the one in the file that it repeats.
    fn heights(&self, angles: &[f64], reader: &Reader) -> Result<Vec<(f64, usize)>, IesError> {
        let is_around_aim = self.angles == ProfileAngles::AroundAim;
        let allowed = if is_around_aim { 0.0..=180.0 } else { -90.0..=90.0 };
        if let Some(angle) = angles.iter().find(|angle| !allowed.contains(*angle)) {
            let (from, to) = (allowed.start(), allowed.end());
            let cause = format!("the vertical angle {angle} is not from {from} to {to} degrees");
            return Err(reader.error(reader.line, cause));
        }
        Ok(if is_around_aim { angles.iter().copied().zip(0..).collect() } else { both_sides(angles) })
    }
}

/// Angles with their indices; those from zero on stand for both sides.
fn both_sides(angles: &[f64]) -> Vec<(f64, usize)> {
    let given = || angles.iter().enumerate().map(|(at, angle)| (*angle, at));
    let is_one_sided = angles.len() > 1 && angles[0] == 0.0;
    let mirrored = given().skip(1).rev().filter(|_| is_one_sided).map(|(angle, at)| (-angle, at));
    mirrored.chain(given()).collect()
}

/// The numbers of a file, one after another.
struct Reader<'t> {
    rest: &'t str,
    /// Line of the last number, counted from 1.
    line: u64,
}

impl<'t> Reader<'t> {
    fn new(text: &'t str) -> Self {
        Self { rest: text, line: 1 }
    }

    fn error(&self, line: u64, cause: String) -> IesError {
        IesError { line, cause, remedy: EXPORT }
    }

    fn bytes_left(&self) -> usize {
        self.rest.len()
    }

    /// Skips name and keywords, up to the numbers.
    fn skip_to_tilt(&mut self) -> Result<Tilt, IesError> {
        while !self.rest.is_empty() {
            let end = self.rest.find(['\n', '\r']).unwrap_or(self.rest.len());
            let (line, rest) = self.rest.split_at(end);
            self.rest = rest.strip_prefix("\r\n").or_else(|| rest.get(1..)).unwrap_or("");
            let tilt = line.trim().split_once('=').filter(|(key, _)| key.trim().eq_ignore_ascii_case("TILT"));
            self.line += 1;
            if let Some((_, value)) = tilt {
                let value = value.trim();
                let short = value.chars().take(100).collect::<String>();
                return Ok(match () {
                    _ if value.eq_ignore_ascii_case("NONE") => Tilt::None,
                    _ if value.eq_ignore_ascii_case("INCLUDE") => Tilt::Include,
                    _ => Tilt::File(short),
                });
            }
        }
        Err(self.error(1, "it has no line TILT=, so it is not an IES file".to_owned()))
    }

    fn word(&mut self) -> Option<&'t str> {
        let is_between = |c: char| c.is_whitespace() || c == ',';
        let start = self.rest.find(|c| !is_between(c)).unwrap_or(self.rest.len());
        let between = &self.rest[..start];
        // CR LF counts once.
        let returns = between.matches('\r').count() - between.matches("\r\n").count();
        self.line += (between.matches('\n').count() + returns) as u64;
        self.rest = &self.rest[start..];
        let end = self.rest.find(is_between).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    fn number(&mut self, what: &str) -> Result<f64, IesError> {
        let Some(word) = self.word() else {
            return Err(self.error(self.line, format!("the file ends before {what}")));
        };
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => {
                let shown: String = word.chars().take(40).collect();
                Err(self.error(self.line, format!("{what} must be a number, and it is '{shown}'")))
            }
        }
    }

    /// A number of angles.
    fn count(&mut self, kind: &str) -> Result<usize, IesError> {
        let number = self.number(&format!("the number of {kind} angles"))?;
        if (1.0..=MAX_ANGLES as f64).contains(&number) && number.fract() == 0.0 {
            return Ok(number as usize);
        }
        let cause =
            format!("the number of {kind} angles is {number}, and not a whole number from 1 to {MAX_ANGLES}");
        Err(self.error(self.line, cause))
    }

    fn angles(&mut self, count: usize, kind: &str) -> Result<Vec<f64>, IesError> {
        let mut angles = Vec::new();
        for _ in 0..count {
            let angle = self.number(&format!("a {kind} angle"))?;
            if angles.last().is_some_and(|last| *last >= angle) {
                let cause = format!("the {kind} angle {angle} is not above the one before");
                return Err(self.error(self.line, cause));
            }
            angles.push(angle);
        }
        Ok(angles)
    }

    fn intensity(&mut self) -> Result<f64, IesError> {
        let number = self.number("an intensity")?;
        if number >= 0.0 {
            return Ok(number);
        }
        Err(self.error(self.line, format!("the intensity {number} is negative")))
    }

    /// The share of its light that the lamp gives as it was measured, from `TILT=INCLUDE`.
    fn tilt_factor(&mut self) -> Result<f64, IesError> {
        self.number("how the lamp lies in the luminaire")?;
        let count = self.count("tilt")?;
        let angles = self.angles(count, "tilt")?;
        let mut factor = 1.0;
        for angle in angles {
            let value = self.number("a factor of a tilt")?;
            factor = if angle == 0.0 && value > 0.0 { value } else { factor };
        }
        Ok(factor)
    }
}

#[cfg(test)]
mod tests;
