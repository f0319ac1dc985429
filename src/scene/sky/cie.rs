//! The standard overcast and clear skies of the CIE.
//!
//! Source: CIE S 011/E:2003 (ISO 15469:2004), sky types 16 (the traditional overcast sky of Moon
//! and Spencer 1942) and 12 (the standard clear sky of Kittler 1967). We differ: the standard gives
//! luminances alone; the hues of the clear sky are those of [`Gradient::CLEAR_DAY`].

use super::gradient::{Gradient, below_horizon};
use crate::raster::color::luminance;
use glam::Vec3;
use std::f64::consts::PI;

/// A standard sky of the CIE. Radiances are linear Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CieSky {
    /// Which of the standard skies it is.
    pub kind: CieKind,
    /// Radiance from straight above.
    pub zenith: Vec3,
    /// Radiance from below the horizon.
    pub ground: Vec3,
    /// Unit direction towards the sun. The overcast sky is the same for all.
    pub sun_direction: Vec3,
}

/// A kind of standard sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CieKind {
    /// Clouds hide the sun: the zenith is three times as bright as the horizon.
    Overcast,
    /// No clouds: bright around the sun and at the horizon.
    Clear,
}

impl CieSky {
    /// Returns the overcast sky of a horizontal irradiance.
    pub fn overcast(irradiance: Vec3, ground: Vec3) -> Self {
        // The integral of (1 + 2 cos) / 3 times the cosine over the hemisphere is 7 pi / 9.
        let zenith = irradiance * (9.0 / (7.0 * PI)) as f32;
        Self { kind: CieKind::Overcast, zenith, ground, sun_direction: Vec3::Y }
    }

    /// Returns the clear sky of a horizontal irradiance, of which the luminance counts.
    pub fn clear(sun_direction: Vec3, irradiance: Vec3, ground: Vec3) -> Self {
        let of_zenith = |zenith| Self { kind: CieKind::Clear, zenith, ground, sun_direction };
        let tint = tint(1.0);
        let one = horizontal_irradiance(|d| of_zenith(tint).radiance(d));
        of_zenith(tint * (luminance(irradiance) / luminance(one)))
    }

    /// Returns the radiance that arrives from a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let up = direction.y.clamp(-1.0, 1.0);
        if up >= 0.0 {
            self.above_horizon(direction, up)
        } else {
            let level = Vec3::new(direction.x, 0.0, direction.z).normalize_or(Vec3::X);
            below_horizon(self.above_horizon(level, 0.0), self.ground, up)
        }
    }

    fn above_horizon(&self, direction: Vec3, up: f32) -> Vec3 {
        match self.kind {
            CieKind::Overcast => self.zenith * ((1.0 + 2.0 * up) / 3.0),
            CieKind::Clear => {
                let to_sun = self.sun_direction;
                let scattered = indicatrix(direction.dot(to_sun)) / indicatrix(to_sun.y);
                let hue = tint(up) / tint(1.0);
                self.zenith * hue * (scattered * gradation(up) / gradation(1.0))
            }
        }
    }
}

/// Returns the luminance of the clear sky relative to others at the same angle to the sun, given
/// the sine of the elevation: the gradation function, a = -1 and b = -0.32.
fn gradation(up: f32) -> f32 {
    1.0 - (-0.32 / up.max(f32::MIN_POSITIVE)).exp()
}

/// Returns the luminance of the clear sky relative to others at the same elevation, given the
/// cosine of the angle to the sun: the scattering indicatrix, c = 10, d = -3 and e = 0.45.
fn indicatrix(cos: f32) -> f32 {
    let cos = cos.clamp(-1.0, 1.0);
    let at_right_angle = (-3.0 * std::f32::consts::FRAC_PI_2).exp();
    1.0 + 10.0 * ((-3.0 * cos.acos()).exp() - at_right_angle) + 0.45 * cos * cos
}

/// Returns the hue of the clear sky at the sine of an elevation, with luminance one.
fn tint(up: f32) -> Vec3 {
    let Gradient { zenith, horizon, .. } = Gradient::CLEAR_DAY;
    let color = horizon.lerp(zenith, up.sqrt());
    color / luminance(color)
}

/// Returns the irradiance of level ground under the upper half of a sky, by the midpoint rule.
pub(crate) fn horizontal_irradiance(radiance: impl Fn(Vec3) -> Vec3) -> Vec3 {
    /// Steps of the elevation; the azimuth has four times as many. Against 400 steps, 48 are off by
    /// at most 0.05 % for the skies of the CIE and 0.3 % for physical ones.
    const STEPS: u32 = 48;
    let mut sum = glam::DVec3::ZERO;
    for i in 0..STEPS {
        // Equal steps of the squared sine have equal cosine-weighted solid angles.
        let up = ((f64::from(i) + 0.5) / f64::from(STEPS)).sqrt();
        let level = (1.0 - up * up).sqrt();
        for j in 0..4 * STEPS {
            let (sin, cos) = (2.0 * PI * (f64::from(j) + 0.5) / f64::from(4 * STEPS)).sin_cos();
            sum += radiance(glam::DVec3::new(level * cos, up, level * sin).as_vec3()).as_dvec3();
        }
    }
    (sum * (PI / f64::from(4 * STEPS * STEPS))).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_overcast_sky_lights_level_ground_with_seven_ninths_of_pi() {
        let zenith = Vec3::new(0.5, 1.0, 2.0);
        let sky = CieSky { kind: CieKind::Overcast, zenith, ground: Vec3::ZERO, sun_direction: Vec3::Y };
        let expected = zenith * (7.0 * PI / 9.0) as f32;
        let found = horizontal_irradiance(|d| sky.radiance(d));
        assert!(((found - expected) / expected).abs().max_element() < 2e-4, "{found} {expected}");
        let again = CieSky::overcast(expected, Vec3::ZERO);
        assert!((again.zenith - zenith).abs().max_element() < 1e-5);
        assert!((sky.radiance(Vec3::X) - zenith / 3.0).abs().max_element() < 1e-6, "a third at the horizon");
    }

    #[test]
    fn a_clear_sky_has_the_luminances_of_the_standard() {
        // The formula of Kittler 1967 in the words of CIE 22 (1973):
        // (0.91 + 10 exp(-3 g) + 0.45 cos^2 g) (1 - exp(-0.32 sec z)) / the same for the zenith.
        let height = 40f32.to_radians();
        let sun = Vec3::new(height.cos(), height.sin(), 0.0);
        let sky = CieSky::clear(sun, Vec3::ONE, Vec3::ZERO);
        for (azimuth, up) in [(0.0f32, 0.9f32), (1.0, 0.3), (3.0, 0.1), (2.0, 0.999)] {
            let level = (1.0 - up * up).sqrt();
            let d = Vec3::new(level * azimuth.cos(), up, level * azimuth.sin());
            let f = |g: f32| 0.91 + 10.0 * (-3.0 * g).exp() + 0.45 * g.cos() * g.cos();
            let phi = |up: f32| 1.0 - (-0.32 / up).exp();
            let expected = f(d.dot(sun).acos()) * phi(up) / (f(sun.y.acos()) * phi(1.0));
            let found = luminance(sky.radiance(d)) / luminance(sky.zenith);
            assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
        }
        let found = luminance(horizontal_irradiance(|d| sky.radiance(d)));
        assert!((found - 1.0).abs() < 1e-4, "{found}");
    }

    #[test]
    fn every_direction_has_a_finite_radiance() {
        for height in [-0.2f32, 0.0, 0.3, 1.5] {
            let sun = Vec3::new(height.cos(), height.sin(), 0.0);
            let sky = CieSky::clear(sun, Vec3::ONE, Vec3::splat(0.1));
            for d in [sun, -sun, Vec3::Y, -Vec3::Y, Vec3::X, -Vec3::X, Vec3::new(0.999_999, 1e-12, 0.0)] {
                let radiance = sky.radiance(d);
                assert!(radiance.is_finite() && radiance.min_element() > 0.0, "{height} {d} {radiance}");
            }
        }
    }
}
