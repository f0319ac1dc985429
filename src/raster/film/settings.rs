//! Settings of a film.

/// Size, speed and quality of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmSettings {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Frames per second.
    pub rate: u32,
    /// How coarsely the film is coded.
    pub quality: FilmQuality,
    /// Number of threads that encode.
    pub threads: usize,
}

/// How coarsely a film is coded, the same for all of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilmQuality {
    /// Small files; fine detail is lost.
    Small,
    /// As the numbered pictures at a normal distance.
    #[default]
    Good,
    /// As the numbered pictures side by side.
    Best,
}

impl FilmQuality {
    /// All of them, with their names.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Small, "small"), (Self::Good, "good"), (Self::Best, "best")];

    /// Quantizer of AV1, 0 (finest) to 255.
    pub(super) fn quantizer(self) -> u8 {
        match self {
            Self::Small => 140,
            Self::Good => 90,
            Self::Best => 50,
        }
    }
}

/// A film of this size cannot be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a film is {MIN_SIDE} to {MAX_SIDE} pixels wide and high, both even; {}x{} is not, {}x{} is",
    .0[0], .0[1], .0.map(even)[0], .0.map(even)[1]
)]
pub struct FilmSizeError(pub [u32; 2]);

/// Limits of width and height in pixels: of the encoder, and of the largest level.
const MIN_SIDE: u32 = 16;
const MAX_SIDE: u32 = 8704;

/// The nearest side that a film can have, downwards where there is one.
pub fn even(side: u32) -> u32 {
    (side & !1).clamp(MIN_SIDE, MAX_SIDE)
}

/// Seconds from one key frame to the next: a player can jump to these.
const KEY_SECS: u32 = 2;

/// Levels of AV1: number, and the maxima of pixels, width, height and pixels per second. Source:
/// AV1 Bitstream and Decoding Process Specification, annex A.3.
const LEVELS: [(u8, u64, u32, u32, u64); 12] = [
    (0, 147_456, 2048, 1152, 4_423_680),
    (1, 278_784, 2816, 1584, 8_363_520),
    (4, 665_856, 4352, 2448, 19_975_680),
    (5, 1_065_024, 5504, 3096, 31_950_720),
    (8, 2_359_296, 6144, 3456, 70_778_880),
    (9, 2_359_296, 6144, 3456, 141_557_760),
    (12, 8_912_896, 8192, 4352, 267_386_880),
    (13, 8_912_896, 8192, 4352, 534_773_760),
    (14, 8_912_896, 8192, 4352, 1_069_547_520),
    (16, 35_651_584, 16384, 8704, 1_069_547_520),
    (17, 35_651_584, 16384, 8704, 2_139_095_040),
    (18, 35_651_584, 16384, 8704, 4_278_190_080),
];

/// The level without limits.
const NO_LEVEL: u8 = 31;

impl FilmSettings {
    /// Checks the size.
    ///
    /// # Errors
    /// [`FilmSizeError`] with the nearest size that is possible.
    pub fn check(&self) -> Result<(), FilmSizeError> {
        if self.size.map(even) == self.size { Ok(()) } else { Err(FilmSizeError(self.size)) }
    }

    /// Number of frames from one key frame to the next.
    pub fn key_interval(&self) -> u32 {
        (KEY_SECS * self.rate).max(1)
    }

    /// Number of the lowest level of AV1 that allows the film.
    pub(super) fn level(&self) -> u8 {
        let ([width, height], pixels) = (self.size, self.size.map(u64::from).iter().product::<u64>());
        let per_sec = pixels * u64::from(self.rate);
        let fits = |&(_, most, wide, high, fast): &(u8, u64, u32, u32, u64)| {
            pixels <= most && width <= wide && height <= high && per_sec <= fast
        };
        LEVELS.iter().find(|level| fits(level)).map_or(NO_LEVEL, |level| level.0)
    }
}
