//! The exposure of display-referred pictures: a number of stops, or chosen from the light in the
//! scene.

use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::{fmt, str::FromStr};

/// Exposure of display-referred pictures. As text and in files it is `auto` or a number of stops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Exposure {
    /// Chosen from the light in the scene ([`crate::Tracer::metered`]).
    #[default]
    Auto,
    /// A number of stops (EV): radiance is multiplied by two to this power.
    #[serde(untagged)]
    Stops(f32),
}

impl Exposure {
    /// Range of a given exposure in stops. Beyond it, an f32 overflows soon.
    pub const STOPS: RangeInclusive<f32> = -64.0..=64.0;

    /// Returns the number of stops if it is given.
    pub fn stops(self) -> Option<f32> {
        match self {
            Self::Auto => None,
            Self::Stops(ev) => Some(ev),
        }
    }

    /// True for the automatic exposure, and for a number of stops within [`Self::STOPS`].
    pub fn is_valid(self) -> bool {
        self.stops().is_none_or(|ev| Self::STOPS.contains(&ev))
    }
}

impl fmt::Display for Exposure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Stops(ev) => write!(f, "{ev}"),
        }
    }
}

/// Returns a number of stops as people write it: 2.9 rather than 2.9000000953674316, which is the
/// same f32.
pub fn decimal(ev: f32) -> f64 {
    ev.to_string().parse().unwrap_or_else(|_| f64::from(ev))
}

/// Serializes a number of stops by [`decimal`].
#[cfg(feature = "experiments")]
pub(crate) fn serialize_decimal<S: serde::Serializer>(ev: &f32, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(decimal(*ev))
}

/// A text is no exposure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it must be 'auto' or from -64 to 64 stops")]
pub struct ExposureError;

impl FromStr for Exposure {
    type Err = ExposureError;

    fn from_str(text: &str) -> Result<Self, ExposureError> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let stops = text.parse().map(Self::Stops).map_err(|_| ExposureError)?;
        if stops.is_valid() { Ok(stops) } else { Err(ExposureError) }
    }
}

/// The exposure that suits the light in a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Metered {
    /// A number of stops (EV), finite and rounded to tenths.
    Stops(f32),
    /// No light was found.
    Dark,
}

impl Metered {
    /// Display value, before the tone map, of the geometric mean of the typical light and the
    /// bright surfaces.
    ///
    /// Chosen by eye on the start views of six models and the gallery at steps of half a stop.
    /// Instead of the two, the log-average luminance at 0.18 (Reinhard et al. 2002, equation 1)
    /// shows pale buildings in the sun as grey soup, and burns out a room with dark walls: a stop
    /// too dark and too bright.
    const KEY: f64 = 0.46;

    /// Chooses the exposure from measurements all over a scene: the light that arrives at surfaces,
    /// as the radiance of white ones, and the luminance that they show.
    ///
    /// Typical light is the median of what arrives: it ignores windows, dark corners and the
    /// colours of surfaces. Bright surfaces are those of the 90th percentile: they must not burn
    /// out. Doubled light lowers the exposure by one stop.
    pub fn of(light: Vec<f64>, luminance: Vec<f64>) -> Self {
        let (mut light, mut luminance) = (light, luminance);
        let logs = [percentile_log2(&mut light, 0.5), percentile_log2(&mut luminance, 0.9)];
        let [Some(typical), Some(bright)] = logs else { return Self::Dark };
        Self::of_logs(typical, bright)
    }

    /// Chooses the exposure from the luminance at points of one picture, which are sorted; `None`
    /// where all of them are black. The light that arrives is not known there: surfaces are taken
    /// to scatter half of it.
    pub fn of_view(luminance: &mut [f64]) -> Option<Self> {
        const SCATTERED: f64 = 0.5;
        let typical = percentile_of(luminance, 0.5)? - SCATTERED.log2();
        Some(Self::of_logs(typical, percentile_of(luminance, 0.9)?))
    }

    /// Chooses the exposure from the logarithms of typical light and of bright surfaces.
    fn of_logs(typical: f64, bright: f64) -> Self {
        let ev = Self::KEY.log2() - (typical + bright) / 2.0;
        let [low, high] = [Exposure::STOPS.start(), Exposure::STOPS.end()];
        Self::Stops(((ev * 10.0).round() / 10.0).clamp(f64::from(*low), f64::from(*high)) as f32)
    }

    /// The exposure in stops; 0 in the dark.
    pub fn ev(self) -> f32 {
        match self {
            Self::Stops(ev) => ev,
            Self::Dark => 0.0,
        }
    }
}

/// Returns the logarithm of a percentile (nearest rank, `share` in 0..1) of those values that are
/// positive and finite.
fn percentile_log2(values: &mut Vec<f64>, share: f64) -> Option<f64> {
    values.retain(|value| *value > 0.0 && value.is_finite());
    percentile_of(values, share)
}

/// The same for values that may be zero, which are left out. They are sorted.
fn percentile_of(values: &mut [f64], share: f64) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let first = values.partition_point(|value| *value <= 0.0);
    let values = &values[first..];
    let rank = ((values.len() as f64 * share).ceil() as usize).max(1) - 1;
    values.get(rank).map(|value| value.log2())
}
