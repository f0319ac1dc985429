//! A clear sky computed from the scattering of sunlight in the atmosphere.
//!
//! Source: Hosek and Wilkie 2012, "An Analytic Model for Full Spectral Sky-Dome Radiance", with the
//! published coefficients for linear Rec. 709. We differ below the horizon: the sky of a sun that
//! has set is that of a sun at the horizon, dimmed.

use super::gradient::below_horizon;
use glam::Vec3;
use hw_skymodel::rgb::{SkyParams, SkyState};

/// A clear sky of given haze. Radiances are linear Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhysicalSky {
    sun_direction: Vec3,
    turbidity: f32,
    albedo: f32,
    brightness: f32,
    ground: Vec3,
    state: SkyState,
}

impl PhysicalSky {
    /// Range of the turbidity: 1 is pure air, 2 very clear, 3 clear, 6 warm and moist, 10 hazy.
    pub const TURBIDITIES: std::ops::RangeInclusive<f32> = 1.0..=10.0;

    /// Luminance in cd/m2 of one unit of the model, which integrates radiances in W/(m2 sr nm) with
    /// the curves of the standard observer: the luminous efficacy of 683 lm/W.
    pub const NITS: f32 = 683.0;

    /// Returns the sky for a unit direction towards the sun. `albedo` is that of the ground, 0 to
    /// 1, and `ground` the radiance from below the horizon; `brightness` is a factor of the model's
    /// radiances. Values out of range are clamped.
    pub fn new(sun_direction: Vec3, turbidity: f32, albedo: f32, brightness: f32, ground: Vec3) -> Self {
        let clamp = |v: f32, low: f32, high: f32| if v.is_nan() { low } else { v.clamp(low, high) };
        let turbidity = clamp(turbidity, *Self::TURBIDITIES.start(), *Self::TURBIDITIES.end());
        let (albedo, brightness) = (clamp(albedo, 0.0, 1.0), clamp(brightness, 0.0, 1e9));
        let elevation = clamp(sun_direction.y, 0.0, 1.0).asin();
        let elevation = elevation.clamp(0.0, std::f32::consts::FRAC_PI_2);
        let state = SkyState::new(&SkyParams { elevation, turbidity, albedo: [albedo; 3] });
        let state = state.expect("the parameters are clamped to the ranges above");
        Self { sun_direction, turbidity, albedo, brightness, ground, state }
    }

    /// Returns the unit direction towards the sun.
    pub fn sun_direction(&self) -> Vec3 {
        self.sun_direction
    }

    /// Returns the haze of the air.
    pub fn turbidity(&self) -> f32 {
        self.turbidity
    }

    /// Returns the albedo of the ground, whose light the air scatters back.
    pub fn albedo(&self) -> f32 {
        self.albedo
    }

    /// Returns the factor of the model's radiances.
    pub fn brightness(&self) -> f32 {
        self.brightness
    }

    /// Returns the radiance from below the horizon.
    pub fn ground(&self) -> Vec3 {
        self.ground
    }

    pub(super) fn ground_mut(&mut self) -> &mut Vec3 {
        &mut self.ground
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

    /// Evaluates equation 8 of the paper for the three channels.
    fn above_horizon(&self, direction: Vec3, up: f32) -> Vec3 {
        let (parameters, radiances) = self.state.raw();
        let cos = direction.dot(self.sun_direction).clamp(-1.0, 1.0);
        let (gamma, cos2) = (cos.acos(), cos * cos);
        let channel = |c: usize| {
            let [a, b, c0, d, e, f, g, i, h] = std::array::from_fn(|k| parameters[9 * c + k]);
            let mie = (1.0 + cos2) / (1.0 + h * h - 2.0 * h * cos).max(f32::MIN_POSITIVE).powf(1.5);
            let falloff = 1.0 + a * (b / (up + 0.01)).exp();
            let glow = c0 + d * (e * gamma).exp() + f * cos2 + g * mie + i * up.sqrt();
            (radiances[c] * falloff * glow).max(0.0)
        };
        Vec3::new(channel(0), channel(1), channel(2)) * self.brightness
    }
}

#[cfg(test)]
mod tests {
    use super::super::cie::horizontal_irradiance;
    use super::*;
    use crate::raster::color::luminance;
    use hw_skymodel::rgb::Channel;

    fn sun(height_deg: f32) -> Vec3 {
        let (sin, cos) = height_deg.to_radians().sin_cos();
        Vec3::new(cos, sin, 0.0)
    }

    #[test]
    fn the_radiance_is_that_of_the_published_model() {
        let sky = PhysicalSky::new(sun(35.0), 3.5, 0.2, 1.0, Vec3::ZERO);
        for d in [Vec3::Y, Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.48, 0.6, 0.64)] {
            let (theta, gamma) = (d.y.acos(), d.dot(sun(35.0)).acos());
            let of = |channel| sky.state.radiance(theta, gamma, channel);
            let expected = Vec3::new(of(Channel::R), of(Channel::G), of(Channel::B));
            assert!(((sky.radiance(d) - expected) / expected).abs().max_element() < 1e-3);
        }
    }

    #[test]
    fn skies_are_finite_and_as_bright_as_measured_ones() {
        for height in [0.0f32, 1.0, 20.0, 55.0, 90.0] {
            for turbidity in [1.0, 3.0, 7.5, 10.0] {
                let sky = PhysicalSky::new(sun(height), turbidity, 0.2, PhysicalSky::NITS, Vec3::ZERO);
                let lux = horizontal_irradiance(|d| sky.radiance(d));
                assert!(lux.is_finite() && lux.min_element() > 0.0, "{height} {turbidity} {lux}");
                for d in [sun(height), -sun(height), Vec3::Y, -Vec3::Y, Vec3::X] {
                    assert!(sky.radiance(d).is_finite() && sky.radiance(d).min_element() >= 0.0);
                }
            }
        }
        // IESNA RP-21: 14.8 klux under a clear sky with the sun at 55 degrees.
        let sky = PhysicalSky::new(sun(55.0), 3.0, 0.2, PhysicalSky::NITS, Vec3::ZERO);
        let lux = luminance(horizontal_irradiance(|d| sky.radiance(d)));
        assert!((10_000.0..25_000.0).contains(&lux), "{lux}");
    }

    #[test]
    fn parameters_out_of_range_are_clamped() {
        let sky = PhysicalSky::new(-Vec3::Y, f32::NAN, 7.0, 1.0, Vec3::ZERO);
        assert_eq!((sky.turbidity(), sky.albedo()), (1.0, 1.0));
        assert!(sky.radiance(Vec3::Y).is_finite());
    }
}
