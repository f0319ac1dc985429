//! Colour conversions: linear scene-referred Rec. 709 to and from sRGB, exposure, tone map. The
//! only place with a power function.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Curve from scene-referred radiance to display-referred colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMap {
    /// Narkowicz's fit of the ACES curve. Bright lamps keep their hue, shadows keep some contrast.
    #[default]
    Aces,
    /// No curve, clipped at 1, for measurements.
    Linear,
}

impl ToneMap {
    /// Name on the command line and in the metadata of pictures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Aces => "aces",
            Self::Linear => "linear",
        }
    }
}

/// Returns the display-referred linear colour, in 0..1, of a radiance at an exposure in stops (EV).
///
/// Negative or NaN radiance is a bug elsewhere. It is shown as black, never as a random colour.
pub fn display_linear(radiance: Vec3, exposure_ev: f32, tone_map: ToneMap) -> Vec3 {
    let x = (radiance * exposure_ev.exp2()).max(Vec3::ZERO).min(Vec3::splat(65504.0));
    match tone_map {
        ToneMap::Linear => x.min(Vec3::ONE),
        ToneMap::Aces => {
            (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(Vec3::ZERO, Vec3::ONE)
        }
    }
}

/// Returns the radiance, the same in all channels, that has a display-referred linear value (0..1)
/// at an exposure in stops (EV): the inverse of [`display_linear`].
pub fn radiance_shown_as(display: f32, exposure_ev: f32, tone_map: ToneMap) -> f32 {
    let y = display.clamp(0.0, 1.0);
    let exposed = match tone_map {
        ToneMap::Linear => y,
        // The positive root of (2.51 - 2.43 y) x^2 + (0.03 - 0.59 y) x - 0.14 y.
        ToneMap::Aces => {
            let (a, b, c) = (2.51 - 2.43 * y, 0.03 - 0.59 * y, -0.14 * y);
            (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
        }
    };
    exposed * (-exposure_ev).exp2()
}

/// Returns the 8-bit sRGB colour of a radiance at an exposure in stops (EV).
pub fn srgb8(radiance: Vec3, exposure_ev: f32, tone_map: ToneMap) -> [u8; 3] {
    display_linear(radiance, exposure_ev, tone_map)
        .to_array()
        .map(|c| (srgb_from_linear(c) * 255.0 + 0.5) as u8)
}

/// Encodes one channel as sRGB (IEC 61966-2-1). Both values are in 0..1.
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Decodes one channel from sRGB, the inverse of [`srgb_from_linear`].
pub fn linear_from_srgb(srgb: f32) -> f32 {
    if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

/// Returns the Rec. 709 luminance of a linear colour.
pub fn luminance(linear: Vec3) -> f32 {
    linear.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Returns the exposure in stops, rounded to halves, that maps the log-average luminance of a
/// picture to middle grey (0.18). `None` if the picture is completely black.
///
/// Source: Reinhard et al., "Photographic Tone Reproduction for Digital Images", SIGGRAPH 2002,
/// equation 1. We differ: black pixels are left out instead of replaced by a small constant.
pub fn metered_exposure_ev(radiance: &[Vec3]) -> Option<f32> {
    const MIDDLE_GREY: f64 = 0.18;
    let lit = radiance.iter().map(|&r| f64::from(luminance(r))).filter(|l| *l > 0.0 && l.is_finite());
    let (sum, count) = lit.fold((0.0, 0u64), |(sum, count), l| (sum + l.log2(), count + 1));
    let ev = MIDDLE_GREY.log2() - sum / count.max(1) as f64;
    (count > 0).then(|| ((ev * 2.0).round() / 2.0) as f32)
}
