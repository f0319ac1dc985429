//! A case as data and a function that measures it.

use crate::experiment::run::ExperimentError;
use crate::raster::color::ToneMap;
use crate::render::{Frame, aov::display_rows};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A property that must hold.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Letter and number of the catalogue in `docs/ROBUSTNESS.md`, and a few words.
    pub name: &'static str,
    /// What is measured, with its unit.
    pub expected: &'static str,
    /// Maximum of the measured value.
    pub bound: f64,
    /// True if the value depends on the clock: such a case is not a test, and its value differs
    /// from run to run.
    pub is_timed: bool,
    /// Why the case does not hold, if it is known not to.
    pub known_limit: &'static str,
    measure: fn(&Trial) -> Outcome,
}

/// How many random tries and frames a case takes.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Number of random rays, poses or angles.
    pub tries: u32,
    /// Number of successive frames.
    pub frames: u32,
}

impl Trial {
    /// Enough for a test.
    pub const QUICK: Self = Self { tries: 20_000, frames: 8 };
    /// The effort behind the figures of `docs/ROBUSTNESS.md`.
    pub const FULL: Self = Self { tries: 1_000_000, frames: 100 };
}

/// What a case found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Value that is compared with the bound; NaN never holds.
    pub value: f64,
    /// Details in words.
    pub note: String,
    /// A picture of the case: size and 8-bit sRGB pixels.
    pub picture: Option<([u32; 2], Vec<[u8; 3]>)>,
}

/// What a case measured, or why it could not be measured.
pub(super) type Outcome = Result<Measured, ExperimentError>;

impl From<f64> for Measured {
    fn from(value: f64) -> Self {
        Self { value, ..Self::default() }
    }
}

impl From<usize> for Measured {
    fn from(count: usize) -> Self {
        Self::from(count as f64)
    }
}

impl Measured {
    /// Adds details in words.
    pub(super) fn with_note(self, note: String) -> Self {
        Self { note, ..self }
    }

    /// Adds a picture.
    pub(super) fn with_picture(self, frame: &Frame) -> Self {
        let picture = Some((frame.view.size, display_rows(&frame.radiance, 0.0, ToneMap::Aces)));
        Self { picture, ..self }
    }
}

/// A case with its name, what is measured, the bound, and the function that measures it.
pub(super) const fn case(
    name: &'static str,
    expected: &'static str,
    bound: f64,
    measure: fn(&Trial) -> Outcome,
) -> Case {
    Case { name, expected, bound, is_timed: false, known_limit: "", measure }
}

impl Case {
    /// Marks a case whose value depends on the clock.
    pub(super) const fn timed(self) -> Self {
        Self { is_timed: true, ..self }
    }

    /// Marks a case that is known not to hold.
    #[allow(dead_code, reason = "every case holds now; the next one that does not needs it")]
    pub(super) const fn limited(self, known_limit: &'static str) -> Self {
        Self { known_limit, ..self }
    }

    /// Measures the case. A panic is a measurement that never holds.
    ///
    /// # Errors
    /// [`ExperimentError`] if a scene cannot be made or a file cannot be written.
    pub fn run(&self, trial: &Trial) -> Result<Measured, ExperimentError> {
        let panicked = || Measured::from(f64::NAN).with_note("it panicked".to_owned());
        catch_unwind(AssertUnwindSafe(|| (self.measure)(trial))).unwrap_or_else(|_| Ok(panicked()))
    }

    /// Returns true if a measured value is within the bound.
    pub fn holds(&self, measured: f64) -> bool {
        measured <= self.bound
    }
}

/// Adds up a count over values.
pub(super) fn total<T>(
    values: impl IntoIterator<Item = T>,
    count: impl FnMut(T) -> Result<usize, ExperimentError>,
) -> Outcome {
    Ok(values.into_iter().map(count).sum::<Result<usize, _>>()?.into())
}

/// Returns the maximum of a measure over values, at least 0.
pub(super) fn worst<T>(
    values: impl IntoIterator<Item = T>,
    mut measure: impl FnMut(T) -> Result<f64, ExperimentError>,
) -> Outcome {
    Ok(values.into_iter().try_fold(0.0, |worst, v| measure(v).map(|value| f64::max(worst, value)))?.into())
}
