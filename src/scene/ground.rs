//! A ground below a model that has none: a level square far wider than the building, on which
//! shadows fall and from which light is scattered.

use super::object_edits::LoadedGeometry;
use std::str::FromStr;

/// A level ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Height in metres.
    pub height_m: f64,
    /// Share of the light that it scatters, grey, 0..1.
    pub albedo: f32,
}

/// Which ground a scene gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GroundChoice {
    /// One at the lowest point of the building, where the model has no ground and there is
    /// daylight.
    Auto,
    /// None.
    Off,
    /// One at a height in metres.
    At(f64),
}

/// A text is no choice of a ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it must be 'auto', 'off' or a height in metres")]
pub struct GroundError;

impl FromStr for GroundChoice {
    type Err = GroundError;

    fn from_str(text: &str) -> Result<Self, GroundError> {
        match text {
            "auto" => Ok(Self::Auto),
            "off" => Ok(Self::Off),
            number => number.parse().ok().filter(|h: &f64| h.is_finite()).map(Self::At).ok_or(GroundError),
        }
    }
}

/// Why a scene has a ground by default, or has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GroundAdvice {
    /// The model has no ground of its own, and there is daylight.
    #[default]
    Wanted,
    /// The model brings its own.
    HasOwn,
    /// Neither sun nor sky lights a ground.
    NoDaylight,
}

/// The ground of a scene, and the geometry without it.
#[derive(Debug)]
pub struct GroundedGeometry {
    pub(super) ground: Ground,
    pub(super) bare: LoadedGeometry,
}

impl Ground {
    /// Default of [`Self::albedo`]: gravel or dry concrete.
    pub const DEFAULT_ALBEDO: f32 = 0.3;

    /// Range of [`Self::albedo`].
    pub const ALBEDOS: std::ops::RangeInclusive<f32> = 0.0..=0.9;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_parsed() {
        assert_eq!("auto".parse(), Ok(GroundChoice::Auto));
        assert_eq!("off".parse(), Ok(GroundChoice::Off));
        assert_eq!("-0.45".parse(), Ok(GroundChoice::At(-0.45)));
        for text in ["", "nan", "inf", "on"] {
            assert_eq!(text.parse::<GroundChoice>(), Err(GroundError));
        }
    }
}
