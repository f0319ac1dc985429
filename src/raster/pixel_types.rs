//! Pixel types: how each pixel got its colour, how often each type occurs, and how it is shown.

use serde::Serialize;

/// How a pixel got its colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum PixelType {
    /// Type 3: no reference holds its light; traced and shaded in full.
    #[default]
    Unseen = 0,
    /// Type 1: its light was reused from references.
    Reused = 1,
    /// Type 2: mirror or glass; secondary rays were traced from the first hit.
    Secondary = 2,
    /// Type 3: its looked-up light was a guess, so that it was due to be checked by tracing. It may
    /// show the guess still: a cached point confirmed it, or the frame was stopped before the
    /// check.
    Uncertain = 3,
}

impl PixelType {
    /// The paper's number of the type, 1 to 3.
    pub fn number(self) -> u8 {
        match self {
            Self::Reused => 1,
            Self::Secondary => 2,
            Self::Unseen | Self::Uncertain => 3,
        }
    }

    /// Colour of the type in pictures of types: exactly one of [`TYPE_SRGB`], never a blend.
    pub fn srgb(self) -> [u8; 3] {
        TYPE_SRGB[usize::from(self.number()) - 1]
    }
}

/// Supplier of a pixel that no reference supplied.
pub const NO_SUPPLIER: u8 = u8::MAX;

/// 8-bit sRGB colours of Types 1, 2 and 3. Colour-blind people can distinguish them, also by
/// brightness.
pub const TYPE_SRGB: [[u8; 3]; 3] = [[0x00, 0x72, 0xb2], [0xf0, 0xe4, 0x42], [0xd5, 0x5e, 0x00]];

/// Type of each pixel, row-major.
pub type PixelMap = Vec<PixelType>;

/// Number of pixels of each type. They add up to the number of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TypeCounts {
    /// Pixels of Type 1.
    pub reused: usize,
    /// Pixels of Type 2.
    pub secondary: usize,
    /// Pixels of Type 3 without a look-up result.
    pub unseen: usize,
    /// Pixels of Type 3 with an uncertain look-up result.
    pub uncertain: usize,
}

/// [`TypeCounts`] in percent, with the key names of the command line's JSON. Types 1 to 3 add up to
/// 100; unseen and uncertain add up to Type 3.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[allow(missing_docs, reason = "the names say it")]
pub struct TypePercentages {
    pub type1_percent: f64,
    pub type2_percent: f64,
    pub type3_percent: f64,
    pub unseen_percent: f64,
    pub uncertain_percent: f64,
}

impl TypeCounts {
    /// Counts the types in a map.
    pub fn of(map: &[PixelType]) -> Self {
        let mut counts = [0usize; 4];
        for &pixel in map {
            counts[pixel as usize] += 1;
        }
        let [unseen, reused, secondary, uncertain] = counts;
        Self { reused, secondary, unseen, uncertain }
    }

    /// Number of pixels of Type 3.
    pub fn type3(&self) -> usize {
        self.unseen + self.uncertain
    }

    /// Number of all pixels.
    pub fn total(&self) -> usize {
        self.reused + self.secondary + self.type3()
    }

    /// Percentages of all pixels; all zero for an empty picture.
    pub fn percentages(&self) -> TypePercentages {
        let percent = |n: usize| 100.0 * n as f64 / self.total().max(1) as f64;
        TypePercentages {
            type1_percent: percent(self.reused),
            type2_percent: percent(self.secondary),
            type3_percent: percent(self.type3()),
            unseen_percent: percent(self.unseen),
            uncertain_percent: percent(self.uncertain),
        }
    }
}
