//! Step 3: what is known of each pixel decides its type.
//!
//! Source: the paper, section 3, step 3. Type 3 is split by what is done about it; the paper traces them all.

use super::WarpBuffer;
use crate::reference::ReferenceFrame;
use serde::Serialize;

/// How a pixel came to its colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum PixelType {
    /// Type 3: traced and shaded in full.
    #[default]
    Unseen = 0,
    /// Type 1: copied, no ray.
    Reused = 1,
    /// Type 2: first hit known, secondary rays traced.
    Secondary = 2,
    /// Type 3 by its neighbours' agreement: interpolated.
    Gap = 3,
    /// Type 3, traced, then looked up.
    Disoccluded = 4,
    /// Type 3, traced and looked up, but the look-up is a guess, so lit with few rays.
    Uncertain = 5,
}

impl PixelType {
    /// The paper's number, 1 to 3.
    pub fn number(self) -> u8 {
        match self {
            Self::Reused => 1,
            Self::Secondary => 2,
            Self::Unseen | Self::Gap | Self::Disoccluded | Self::Uncertain => 3,
        }
    }
}

/// The type of each pixel, row-major.
pub type PixelMap = Vec<PixelType>;

/// Pixels of each type; they sum to the pixel count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TypeCounts {
    /// Type 1.
    pub reused: usize,
    /// Type 2.
    pub secondary: usize,
    /// Type 3, interpolated.
    pub gap: usize,
    /// Type 3, traced and looked up.
    pub disoccluded: usize,
    /// Type 3, traced and shaded.
    pub unseen: usize,
    /// Type 3, traced and looked up, then lit with few rays.
    pub uncertain: usize,
}

/// [`TypeCounts`] as percentages, with the names of the command line's contract: types 1 to 3 sum to 100, and gap,
/// disoccluded and unseen sum to type 3. Uncertain pixels are traced and looked up too, so they are a part of the
/// disoccluded ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[allow(missing_docs, reason = "the names say it")]
pub struct TypePercentages {
    pub type1_percent: f64,
    pub type2_percent: f64,
    pub type3_percent: f64,
    pub gap_percent: f64,
    pub disoccluded_percent: f64,
    pub unseen_percent: f64,
    pub uncertain_percent: f64,
}

impl TypeCounts {
    /// Counts a map.
    pub fn of(map: &[PixelType]) -> Self {
        let mut counts = [0usize; 6];
        map.iter().for_each(|&t| counts[t as usize] += 1);
        let [unseen, reused, secondary, gap, disoccluded, uncertain] = counts;
        Self { reused, secondary, gap, disoccluded, unseen, uncertain }
    }

    /// All Type 3.
    pub fn type3(&self) -> usize {
        self.gap + self.disoccluded + self.unseen + self.uncertain
    }

    /// All pixels.
    pub fn total(&self) -> usize {
        self.reused + self.secondary + self.type3()
    }

    /// In percent of all pixels; all zero for an empty picture.
    pub fn percentages(&self) -> TypePercentages {
        let percent = |n: usize| 100.0 * n as f64 / self.total().max(1) as f64;
        TypePercentages {
            type1_percent: percent(self.reused),
            type2_percent: percent(self.secondary),
            type3_percent: percent(self.type3()),
            gap_percent: percent(self.gap),
            disoccluded_percent: percent(self.disoccluded + self.uncertain),
            unseen_percent: percent(self.unseen),
            uncertain_percent: percent(self.uncertain),
        }
    }
}

/// The type of one pixel, by the sample that landed on it.
#[inline]
pub fn classify(warped: &WarpBuffer, references: &[&ReferenceFrame], pixel: usize) -> PixelType {
    match warped.sample(pixel) {
        None => PixelType::Unseen,
        Some((sample, _)) => match references[sample.slot()].reflections(sample.pixel()) {
            0 => PixelType::Reused,
            _ => PixelType::Secondary,
        },
    }
}
