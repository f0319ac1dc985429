//! A case as data and a function that measures it.

use crate::experiment::run::ExperimentError;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// One thing that must hold.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Letter and number of the catalogue in `docs/ROBUSTNESS.md`, and a few words.
    pub name: &'static str,
    /// What must hold, with the unit of the measured number.
    pub expected: &'static str,
    /// What is measured may be this large.
    pub bound: f64,
    /// True where it depends on the clock: such a case is no test, and its number differs from run to run.
    pub is_timed: bool,
    /// Why it does not hold, for a case that is known not to.
    pub known_limit: &'static str,
    /// Measures it.
    measure: fn(&Trial) -> Result<Measured, ExperimentError>,
}

/// How much is tried.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Random rays, poses or angles.
    pub tries: u32,
    /// Frames, where one is made after the other.
    pub frames: u32,
}

impl Trial {
    /// Enough for a test.
    pub const QUICK: Self = Self { tries: 20_000, frames: 8 };
    /// What the figures of `docs/ROBUSTNESS.md` are made with.
    pub const FULL: Self = Self { tries: 1_000_000, frames: 100 };
}

/// What a case found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Held against the bound; NaN never holds.
    pub value: f64,
    /// More, in words.
    pub note: String,
    /// A picture that shows it: size, 8-bit sRGB.
    pub picture: Option<([u32; 2], Vec<[u8; 3]>)>,
}

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

impl Case {
    /// A case of a name, what must hold, the bound, and how it is measured.
    pub(super) const fn new(
        name: &'static str,
        expected: &'static str,
        bound: f64,
        measure: fn(&Trial) -> Result<Measured, ExperimentError>,
    ) -> Self {
        Self { name, expected, bound, is_timed: false, known_limit: "", measure }
    }

    /// The same, as one that depends on the clock.
    pub(super) const fn timed(self) -> Self {
        Self { is_timed: true, ..self }
    }

    /// The same, as one that is known not to hold.
    pub(super) const fn limited(self, known_limit: &'static str) -> Self {
        Self { known_limit, ..self }
    }

    /// Measures; a panic is a measurement too, one that never holds.
    ///
    /// # Errors
    /// [`ExperimentError`] where a scene cannot be made or a file not be written.
    pub fn run(&self, trial: &Trial) -> Result<Measured, ExperimentError> {
        let panicked = || Measured { value: f64::NAN, note: "it panicked".to_owned(), picture: None };
        catch_unwind(AssertUnwindSafe(|| (self.measure)(trial))).unwrap_or_else(|_| Ok(panicked()))
    }

    /// True where a measured number is within the bound.
    pub fn holds(&self, measured: f64) -> bool {
        measured <= self.bound
    }
}

/// What a case measured, or why it could not be measured.
pub(super) type Outcome = Result<Measured, ExperimentError>;
