//! The position of the sun at a place and time, and the light of a clear day for it.

use super::{Sky, Sun};
use glam::{DVec3, Vec3};

/// The light from outside a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Daylight {
    /// The sun, if it shines.
    pub sun: Option<Sun>,
    /// The sky, if there is one.
    pub sky: Option<Sky>,
}

/// A moment in universal time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniversalTime {
    /// Year of the Gregorian calendar.
    pub year: i32,
    /// Month, 1 to 12.
    pub month: u32,
    /// Day of the month, from 1.
    pub day: u32,
    /// Hours since midnight. Values outside 0 to 24 belong to another day.
    pub hours: f64,
}

/// The position of the sun in the sky for an observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPosition {
    /// Azimuth in degrees, 0 to 360, from north over east.
    pub azimuth_deg: f64,
    /// Height above the horizon in degrees, without refraction.
    pub height_deg: f64,
}

impl UniversalTime {
    /// Returns the days since noon of 1 January 2000.
    fn days_since_2000(&self) -> f64 {
        // Julian day of a Gregorian date at noon, Fliegel and Van Flandern 1968.
        let (y, m, d) = (i64::from(self.year), i64::from(self.month), i64::from(self.day));
        let a = (m - 14) / 12;
        let noon = (1461 * (y + 4800 + a)) / 4 + (367 * (m - 2 - 12 * a)) / 12
            - (3 * ((y + 4900 + a) / 100)) / 4
            + d
            - 32075;
        (noon - 2_451_545) as f64 - 0.5 + self.hours / 24.0
    }
}

/// Returns the right ascension and the declination of the sun in radians, given the days since noon
/// of 1 January 2000.
///
/// Source: the low-precision formula of the Astronomical Almanac (Michalsky 1988, "The Astronomical
/// Almanac's algorithm for approximate solar position (1950-2050)"), accurate to 0.01 degrees in
/// those years.
fn equatorial(days: f64) -> [f64; 2] {
    let mean_longitude = 280.460 + 0.985_647_4 * days;
    let anomaly = (357.528 + 0.985_600_3 * days).to_radians();
    let longitude = (mean_longitude + 1.915 * anomaly.sin() + 0.020 * (2.0 * anomaly).sin()).to_radians();
    let obliquity = (23.439 - 0.000_000_4 * days).to_radians();
    let ascension = (obliquity.cos() * longitude.sin()).atan2(longitude.cos());
    [ascension, (obliquity.sin() * longitude.sin()).asin()]
}

/// Returns the position of the sun. Latitude is positive in the north and longitude in the east,
/// both in degrees.
pub fn sun_position(time: &UniversalTime, latitude_deg: f64, longitude_deg: f64) -> SunPosition {
    let days = time.days_since_2000();
    let [ascension, declination] = equatorial(days);
    // Greenwich sidereal time in hours, from the same source.
    let sidereal = 18.697_374_558 + 24.065_709_824_419_08 * days;
    let hour_angle = (sidereal * 15.0 + longitude_deg).to_radians() - ascension;
    let latitude = latitude_deg.to_radians();
    let height =
        (latitude.sin() * declination.sin() + latitude.cos() * declination.cos() * hour_angle.cos()).asin();
    let east = -declination.cos() * hour_angle.sin();
    let north = declination.sin() * latitude.cos() - declination.cos() * latitude.sin() * hour_angle.cos();
    SunPosition {
        azimuth_deg: east.atan2(north).to_degrees().rem_euclid(360.0),
        height_deg: height.to_degrees(),
    }
}

impl SunPosition {
    /// Returns the unit direction towards the sun, where +Y is up and north is turned by
    /// `north_deg` degrees from -Z towards +X.
    pub fn direction(&self, north_deg: f64) -> DVec3 {
        let (sin, cos) = (self.azimuth_deg + north_deg).to_radians().sin_cos();
        let (up, level) = self.height_deg.to_radians().sin_cos();
        DVec3::new(level * sin, up, -level * cos)
    }

    /// Returns the position that belongs to a direction towards the sun, with north along -Z.
    pub fn of_direction(direction: Vec3) -> Self {
        let d = direction.as_dvec3().normalize_or(DVec3::Y);
        Self {
            azimuth_deg: d.x.atan2(-d.z).to_degrees().rem_euclid(360.0),
            height_deg: d.y.clamp(-1.0, 1.0).asin().to_degrees(),
        }
    }
}

/// Optical depth of clean air towards the zenith at 610, 550 and 465 nm.
///
/// Source: Leckner 1978, "The spectral distribution of solar radiation at the earth's surface":
/// 0.008735 / w^4.08 with w in micrometres. Haze and ozone are neglected.
const AIR_DEPTH: Vec3 = Vec3::new(0.0656, 0.1001, 0.1985);

/// Height of the sun in degrees for which [`Sun::clear_day`] and [`Sky::CLEAR_DAY`] are meant.
const DEFAULT_HEIGHT_DEG: f64 = 55.0;

/// Height of the sun in degrees at which the sky is dark: the end of civil twilight.
const TWILIGHT_DEG: f64 = -6.0;

/// Returns the light of a clear day with the sun at a position. A low sun is weaker and redder
/// because its light crosses more air; below the horizon there is none. `north_deg` is that of
/// [`SunPosition::direction`].
pub fn clear_daylight(position: &SunPosition, north_deg: f64) -> Daylight {
    let clear = Sun::clear_day();
    let passed = |height_deg: f64| (-AIR_DEPTH * air_mass(height_deg)).map(f32::exp);
    let irradiance = clear.irradiance * passed(position.height_deg) / passed(DEFAULT_HEIGHT_DEG);
    let direction = position.direction(north_deg).as_vec3();
    let sun = (position.height_deg > 0.0).then_some(Sun { direction, irradiance, ..clear });
    let share = (sky_klux(position.height_deg) / sky_klux(DEFAULT_HEIGHT_DEG)) as f32;
    let Sky { zenith, horizon, ground } = Sky::CLEAR_DAY;
    let sky = Sky { zenith: zenith * share, horizon: horizon * share, ground: ground * share };
    Daylight { sun, sky: (share > 0.0).then_some(sky) }
}

/// Returns how much more air the light crosses than from the zenith.
///
/// Source: Kasten and Young 1989, "Revised optical air mass tables and approximation formula".
fn air_mass(height_deg: f64) -> f32 {
    let h = height_deg.max(0.0);
    (1.0 / (h.to_radians().sin() + 0.50572 * (h + 6.07995).powf(-1.6364))) as f32
}

/// Returns the illuminance in kilolux of level ground under a clear sky, without the sun itself.
///
/// Source: IESNA RP-21, clear sky: 0.8 + 15.5 sin(h)^0.5. We differ: below the horizon the 0.8 fade
/// to zero at the end of civil twilight.
fn sky_klux(height_deg: f64) -> f64 {
    const AT_HORIZON: f64 = 0.8;
    if height_deg < 0.0 {
        return AT_HORIZON * (1.0 - height_deg / TWILIGHT_DEG).max(0.0);
    }
    AT_HORIZON + 15.5 * height_deg.to_radians().sin().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(year: i32, month: u32, day: u32, hours: f64) -> UniversalTime {
        UniversalTime { year, month, day, hours }
    }

    #[test]
    fn right_ascension_and_declination_of_meeus_example_25a() {
        // Meeus, Astronomical Algorithms, example 25.a: 1992 October 13, 0h TD.
        let [ascension, declination] = equatorial(at(1992, 10, 13, 0.0).days_since_2000());
        assert!((ascension.to_degrees().rem_euclid(360.0) - 198.380_83).abs() < 0.02);
        assert!((declination.to_degrees() + 7.785_07).abs() < 0.01);
    }

    #[test]
    fn zenith_and_azimuth_of_the_example_of_the_solar_position_algorithm() {
        // Reda and Andreas 2004 (NREL/TP-560-34302), table A5.1: 2003 October 17, 12:30:30 at
        // UTC-7, 39.742476 N, 105.1786 W: zenith 50.11162, azimuth 194.34024 degrees. Refraction
        // lifts the sun by about 0.016 degrees there.
        let time = at(2003, 10, 17, 19.0 + 30.5 / 60.0);
        let sun = sun_position(&time, 39.742_476, -105.178_6);
        assert!((sun.azimuth_deg - 194.340_24).abs() < 0.02, "{sun:?}");
        assert!((90.0 - sun.height_deg - 0.016 - 50.111_62).abs() < 0.02, "{sun:?}");
    }

    #[test]
    fn heights_and_azimuths_follow_the_year_and_the_day() {
        let noon = |month, day| sun_position(&at(2024, month, day, 12.0), 0.0, 0.0).height_deg;
        assert!((noon(3, 20) - 90.0).abs() < 2.5, "nearly overhead at an equinox: {}", noon(3, 20));
        assert!((noon(6, 21) - (90.0 - 23.44)).abs() < 0.2, "{}", noon(6, 21));
        let berlin = |hours| sun_position(&at(2024, 6, 21, hours), 52.5, 13.4);
        assert!((60.0..120.0).contains(&berlin(6.0).azimuth_deg), "east in the morning");
        assert!((240.0..300.0).contains(&berlin(16.0).azimuth_deg), "west in the afternoon");
        assert!(berlin(23.0).height_deg < 0.0);
    }

    #[test]
    fn directions_and_positions_are_inverse() {
        for (azimuth_deg, height_deg) in [(0.0, 10.0), (90.0, 45.0), (200.0, 80.0), (359.0, 1.0)] {
            let position = SunPosition { azimuth_deg, height_deg };
            let back = SunPosition::of_direction(position.direction(0.0).as_vec3());
            assert!(
                (back.azimuth_deg - azimuth_deg).abs() < 1e-3 && (back.height_deg - height_deg).abs() < 1e-3
            );
        }
        let north = SunPosition { azimuth_deg: 0.0, height_deg: 0.0 };
        assert!((north.direction(0.0) - DVec3::NEG_Z).length() < 1e-12);
        assert!((north.direction(90.0) - DVec3::X).length() < 1e-12);
    }

    #[test]
    fn a_low_sun_is_red_and_a_sun_below_the_horizon_is_gone() {
        let light = |height_deg| clear_daylight(&SunPosition { azimuth_deg: 180.0, height_deg }, 0.0);
        let high = light(DEFAULT_HEIGHT_DEG).sun.unwrap().irradiance;
        assert!((high - Sun::clear_day().irradiance).length() < 1e-4);
        let low = light(2.0).sun.unwrap().irradiance;
        assert!(low.x > 2.0 * low.z && low.max_element() < high.max_element());
        assert_eq!(light(-1.0).sun, None);
        assert!(light(-1.0).sky.is_some() && light(-7.0).sky.is_none());
        assert!((air_mass(90.0) - 1.0).abs() < 1e-3 && (air_mass(0.0) - 37.9).abs() < 0.5, "as published");
    }
}
