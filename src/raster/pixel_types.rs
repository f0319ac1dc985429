//! The picture of how each pixel came to its colour. Told apart by colour-blind people, and in grey.

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
    /// Type 3, traced and looked up, but the look-up is a guess, so lit with few rays.
    Uncertain = 3,
}

impl PixelType {
    /// The paper's number, 1 to 3.
    pub fn number(self) -> u8 {
        match self {
            Self::Reused => 1,
            Self::Secondary => 2,
            Self::Unseen | Self::Uncertain => 3,
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
    pub unseen_percent: f64,
    pub uncertain_percent: f64,
}

impl TypeCounts {
    /// Counts a map.
    pub fn of(map: &[PixelType]) -> Self {
        let mut counts = [0usize; 4];
        map.iter().for_each(|&t| counts[t as usize] += 1);
        let [unseen, reused, secondary, uncertain] = counts;
        Self { reused, secondary, unseen, uncertain }
    }

    /// All Type 3.
    pub fn type3(&self) -> usize {
        self.unseen + self.uncertain
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
            unseen_percent: percent(self.unseen),
            uncertain_percent: percent(self.uncertain),
        }
    }
}

/// Type 1: reused.
pub const TYPE1_SRGB: [u8; 3] = [0x00, 0x72, 0xb2];

/// Type 2: mirror or glass.
pub const TYPE2_SRGB: [u8; 3] = [0xf0, 0xe4, 0x42];

/// Type 3: traced.
pub const TYPE3_SRGB: [u8; 3] = [0xd5, 0x5e, 0x00];

/// The colour of a pixel's type, by the paper's number. Exactly one of three, never a blend.
pub fn type_color(number: u8) -> [u8; 3] {
    match number {
        1 => TYPE1_SRGB,
        2 => TYPE2_SRGB,
        _ => TYPE3_SRGB,
    }
}
