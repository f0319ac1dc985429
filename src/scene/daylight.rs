//! The light of the sun and the sky for a position of the sun.

use super::sky::{CieSky, PhysicalSky, horizontal_irradiance};
use super::{Gradient, Sky, SkyKind, Sun, solar::SunPosition};
use glam::Vec3;

/// The light from outside a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Daylight {
    /// The sun, if it shines.
    pub sun: Option<Sun>,
    /// The sky, if there is one.
    pub sky: Option<Sky>,
}

/// A model of daylight: from the position of the sun to the light of the sun and the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DaylightModel {
    /// Kind of the sky; a picture is no model, and gives the light of [`SkyKind::Gradient`].
    pub kind: SkyKind,
    /// Position of the sun.
    pub position: SunPosition,
    /// Angle of north from -Z towards +X, in degrees.
    pub north_deg: f64,
    /// Haze of the air, for [`SkyKind::Physical`]: [`PhysicalSky::TURBIDITIES`].
    pub turbidity: f32,
    /// Luminance in cd/m2 of a radiance of one:
    /// [`Scene::nits_per_unit`](super::Scene::nits_per_unit).
    pub nits_per_unit: f32,
}

/// Luminance in cd/m2 of a radiance of one in scenes whose files do not use photometric units: the
/// sun of a clear day then has an irradiance of about ten.
const DEFAULT_NITS_PER_UNIT: f32 = 10_000.0;

/// Returns the luminance in cd/m2 of a radiance of one.
pub(super) fn nits_per_unit(is_photometric: bool) -> f32 {
    if is_photometric { 1.0 } else { DEFAULT_NITS_PER_UNIT }
}

/// Albedo of the ground below the horizon: grass, soil and asphalt reflect 0.1 to 0.3.
pub(crate) const GROUND_ALBEDO: f32 = 0.2;

/// Optical depth of clean air towards the zenith at 610, 550 and 465 nm.
///
/// Source: Leckner 1978, "The spectral distribution of solar radiation at the earth's surface":
/// 0.008735 / w^4.08 with w in micrometres. Haze and ozone are neglected.
const AIR_DEPTH: Vec3 = Vec3::new(0.0656, 0.1001, 0.1985);

/// Height of the sun in degrees for which [`Sun::clear_day`] and [`Gradient::CLEAR_DAY`] are meant.
const DEFAULT_HEIGHT_DEG: f64 = 55.0;

impl DaylightModel {
    /// Default of [`Self::turbidity`]: a clear day.
    pub const DEFAULT_TURBIDITY: f32 = 3.0;

    /// Height of the sun in degrees at which the sky is dark: the end of civil twilight.
    pub const NIGHT_DEG: f64 = -6.0;

    /// Returns the model of a kind of sky for a position of the sun, with north along -Z, in a
    /// scene without photometric units.
    pub fn new(kind: SkyKind, position: SunPosition) -> Self {
        let (turbidity, nits_per_unit) = (Self::DEFAULT_TURBIDITY, DEFAULT_NITS_PER_UNIT);
        Self { kind, position, north_deg: 0.0, turbidity, nits_per_unit }
    }

    /// Returns the light of the sun and the sky. A low sun is weaker and redder because its light
    /// crosses more air. Under an overcast sky there is no sun; below the
    /// horizon there is none either, and the sky fades to black until the end of civil twilight.
    pub fn daylight(&self) -> Daylight {
        let sun = self.sun().filter(|_| self.position.height_deg > 0.0 && self.kind != SkyKind::Overcast);
        Daylight { sun, sky: (self.position.height_deg > DaylightModel::NIGHT_DEG).then(|| self.sky(sun)) }
    }

    /// Returns radiances of one unit, for 10,000 cd/m2.
    fn unit(&self) -> f32 {
        DEFAULT_NITS_PER_UNIT / self.nits_per_unit
    }

    fn sun(&self) -> Option<Sun> {
        let height = self.position.height_deg;
        let irradiance = if self.kind == SkyKind::Physical {
            SUN_ABOVE_AIR * (-(AIR_DEPTH + haze_depth(self.turbidity)) * air_mass(height)).map(f32::exp)
        } else {
            let passed = |height_deg: f64| (-AIR_DEPTH * air_mass(height_deg)).map(f32::exp);
            Sun::clear_day().irradiance * passed(height) / passed(DEFAULT_HEIGHT_DEG)
        };
        let direction = self.position.direction(self.north_deg).as_vec3();
        Some(Sun { direction, irradiance: irradiance * self.unit(), ..Sun::clear_day() })
    }

    fn sky(&self, sun: Option<Sun>) -> Sky {
        let (height, unit) = (self.position.height_deg, self.unit());
        let direction = self.position.direction(self.north_deg).as_vec3();
        // Light of the sun on level ground.
        let of_sun = sun.map_or(Vec3::ZERO, |s| s.irradiance * s.direction.y.max(0.0));
        let ground = |of_sky: Vec3| (of_sky + of_sun) * (GROUND_ALBEDO / std::f32::consts::PI);
        match self.kind {
            SkyKind::Gradient | SkyKind::Picture => {
                let share = (clear_klux(height) / clear_klux(DEFAULT_HEIGHT_DEG)) as f32 * unit;
                let Gradient { zenith, horizon, ground } = Gradient::CLEAR_DAY;
                let [zenith, horizon, ground] = [zenith, horizon, ground].map(|part| part * share);
                Sky::Gradient(Gradient { zenith, horizon, ground })
            }
            SkyKind::Overcast => {
                let irradiance = Vec3::splat(overcast_klux(height) as f32 / 10.0 * unit);
                Sky::Cie(CieSky::overcast(irradiance, ground(irradiance)))
            }
            SkyKind::Clear => {
                let irradiance = Vec3::splat(clear_klux(height) as f32 / 10.0 * unit);
                Sky::Cie(CieSky::clear(direction, irradiance, ground(irradiance)))
            }
            SkyKind::Physical => {
                let brightness = PhysicalSky::NITS / self.nits_per_unit * after_sunset(height) as f32;
                let sky =
                    |ground| PhysicalSky::new(direction, self.turbidity, GROUND_ALBEDO, brightness, ground);
                let dark = sky(Vec3::ZERO);
                Sky::Physical(sky(ground(horizontal_irradiance(|d| dark.radiance(d)))))
            }
        }
    }
}

/// Irradiance of the sun outside the atmosphere, in units of 10 klux: 133 klux (IESNA RP-21: 127.5;
/// Darula, Kittler and Gueymard 2005: 133.3), with the hue of a black body of 5,800 K.
const SUN_ABOVE_AIR: Vec3 = Vec3::new(14.1, 13.15, 12.3);

/// Returns the optical depth of haze and ozone towards the zenith at 610, 550 and 465 nm.
///
/// Source: Preetham, Shirley and Smits 1999, "A Practical Analytic Model for Daylight", appendix
/// A.1: Angstrom's formula b / w^1.3 with b = 0.04608 T - 0.04586, and 0.35 cm of ozone.
fn haze_depth(turbidity: f32) -> Vec3 {
    const ANGSTROM: Vec3 = Vec3::new(1.901, 2.175, 2.706);
    const OZONE: Vec3 = Vec3::new(0.042, 0.030, 0.004);
    ANGSTROM * (0.04608 * turbidity - 0.04586).max(0.0) + OZONE
}

/// Returns how much more air the light crosses than from the zenith.
///
/// Source: Kasten and Young 1989, "Revised optical air mass tables and approximation formula".
fn air_mass(height_deg: f64) -> f32 {
    let h = height_deg.max(0.0);
    (1.0 / (h.to_radians().sin() + 0.50572 * (h + 6.07995).powf(-1.6364))) as f32
}

/// Returns the share of the light at sunset that the sky still has: 1 while the sun is up, and 0 at
/// the end of civil twilight.
fn after_sunset(height_deg: f64) -> f64 {
    (1.0 - height_deg.min(0.0) / DaylightModel::NIGHT_DEG).max(0.0)
}

/// Returns the illuminance in kilolux of level ground under a clear sky, without the sun itself.
///
/// Source: IESNA RP-21, clear sky: 0.8 + 15.5 sin(h)^0.5. We differ: below the horizon the 0.8 fade
/// to zero at the end of civil twilight.
fn clear_klux(height_deg: f64) -> f64 {
    0.8 * after_sunset(height_deg) + 15.5 * height_deg.to_radians().sin().max(0.0).sqrt()
}

/// Returns the illuminance in kilolux of level ground under an overcast sky.
///
/// Source: IESNA RP-21, cloudy sky: 0.3 + 21 sin(h). We differ below the horizon, as above.
fn overcast_klux(height_deg: f64) -> f64 {
    0.3 * after_sunset(height_deg) + 21.0 * height_deg.to_radians().sin().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::color::luminance;

    fn model(kind: SkyKind, height_deg: f64) -> DaylightModel {
        DaylightModel::new(kind, SunPosition { azimuth_deg: 180.0, height_deg })
    }

    #[test]
    fn a_low_sun_is_red_and_a_sun_below_the_horizon_is_gone() {
        for kind in [SkyKind::Gradient, SkyKind::Clear, SkyKind::Physical] {
            let light = |height_deg| model(kind, height_deg).daylight();
            let high = light(DEFAULT_HEIGHT_DEG).sun.unwrap().irradiance;
            let low = light(2.0).sun.unwrap().irradiance;
            assert!(low.x > 2.0 * low.z && low.max_element() < high.max_element(), "{kind:?}");
            assert_eq!(light(-1.0).sun, None);
            assert!(light(-1.0).sky.is_some() && light(-7.0).sky.is_none());
        }
        let clear = model(SkyKind::Gradient, DEFAULT_HEIGHT_DEG).daylight();
        assert!((clear.sun.unwrap().irradiance - Sun::clear_day().irradiance).length() < 1e-4);
        assert_eq!(clear.sky, Some(Sky::CLEAR_DAY));
        assert!((air_mass(90.0) - 1.0).abs() < 1e-3 && (air_mass(0.0) - 37.9).abs() < 0.5, "as published");
    }

    #[test]
    fn skies_have_the_illuminance_of_the_standard_and_a_fitting_sun() {
        for height in [5.0, 30.0, 55.0, 85.0] {
            for kind in SkyKind::MODELS {
                let Daylight { sun, sky } = model(kind, height).daylight();
                let sky = sky.unwrap();
                let klux = 10.0 * luminance(horizontal_irradiance(|d| sky.radiance(d)));
                let expected =
                    if kind == SkyKind::Overcast { overcast_klux(height) } else { clear_klux(height) } as f32;
                // The gradient and the model of scattering are not fitted to the standard.
                let off = if matches!(kind, SkyKind::Gradient | SkyKind::Physical) { 2.0 } else { 1.001 };
                assert!((1.0 / off..off).contains(&(klux / expected)), "{kind:?} {height}: {klux}");
                assert_eq!(sun.is_none(), kind == SkyKind::Overcast);
                // A sun near the horizon is weaker than the sky.
                if let Some(sun) = sun.filter(|_| height >= 30.0) {
                    let share = klux / 10.0 / luminance(sun.irradiance * sun.direction.y);
                    assert!((0.05..0.6).contains(&share), "{kind:?} {height}: {share}");
                }
            }
        }
    }

    #[test]
    fn photometric_scenes_get_their_light_in_nits() {
        for kind in SkyKind::MODELS {
            let units = model(kind, 40.0);
            let nits = DaylightModel { nits_per_unit: 1.0, ..units }.daylight();
            let (units, d) = (units.daylight(), Vec3::new(0.6, 0.8, 0.0));
            let [a, b] = [&units, &nits].map(|light| light.sky.as_ref().unwrap().radiance(d));
            assert!((b / a / 1e4 - 1.0).abs().max_element() < 1e-4, "{kind:?}");
        }
    }
}
