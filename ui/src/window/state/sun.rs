//! Position of the sun: by direction, or by place and time.

use afterimage::scene::Daylight;
use afterimage::scene::solar::{SunPosition, UniversalTime, clear_daylight, sun_position};

/// A place on earth and a moment there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceAndTime {
    /// Latitude in degrees, positive in the north.
    pub latitude_deg: f64,
    /// Longitude in degrees, positive in the east.
    pub longitude_deg: f64,
    /// Year of the Gregorian calendar.
    pub year: i32,
    /// Month of the year, 1 to 12.
    pub month: u32,
    /// Day of the month, 1 to 31.
    pub day: u32,
    /// Local time in hours since midnight.
    pub hours: f64,
    /// Local time minus universal time, in hours.
    pub utc_offset_hours: f64,
}

impl Default for PlaceAndTime {
    fn default() -> Self {
        Self {
            latitude_deg: 52.5,
            longitude_deg: 13.4,
            year: 2026,
            month: 6,
            day: 21,
            hours: 12.0,
            utc_offset_hours: 2.0,
        }
    }
}

impl PlaceAndTime {
    /// Returns the position of the sun at this place and time.
    pub fn sun(&self) -> SunPosition {
        let time = UniversalTime {
            year: self.year,
            month: self.month,
            day: self.day,
            hours: self.hours - self.utc_offset_hours,
        };
        sun_position(&time, self.latitude_deg, self.longitude_deg)
    }
}

/// Position of the sun, as its controls show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunControls {
    /// Place and time decide, not azimuth and height.
    pub is_by_place: bool,
    /// Azimuth from north over east, and height over the horizon.
    pub direction: SunPosition,
    /// Place and time from which the position of the sun follows.
    pub place: PlaceAndTime,
    /// Angle of north from -Z towards +X, in degrees.
    pub north_deg: f64,
}

impl Default for SunControls {
    fn default() -> Self {
        let direction = SunPosition { azimuth_deg: 180.0, height_deg: 45.0 };
        Self { is_by_place: false, direction, place: PlaceAndTime::default(), north_deg: 0.0 }
    }
}

impl SunControls {
    /// Returns the position of the sun.
    pub fn position(&self) -> SunPosition {
        if self.is_by_place { self.place.sun() } else { self.direction }
    }

    /// Sets the direction to that of a scene's sun.
    pub fn show(&mut self, daylight: &Daylight) {
        if let Some(sun) = daylight.sun {
            let shown = SunPosition::of_direction(sun.direction);
            let azimuth_deg = (shown.azimuth_deg - self.north_deg).rem_euclid(360.0);
            self.direction = SunPosition { azimuth_deg, ..shown };
        }
    }

    /// Returns the daylight of a clear day with this sun, with or without sun and sky.
    pub fn moved(&self, has_sun: bool, has_sky: bool) -> Daylight {
        let Daylight { sun, sky } = clear_daylight(&self.position(), self.north_deg);
        Daylight { sun: sun.filter(|_| has_sun), sky: sky.filter(|_| has_sky) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_controls_show_the_sun_that_they_set() {
        let mut controls = SunControls { north_deg: 30.0, ..SunControls::default() };
        controls.direction = SunPosition { azimuth_deg: 250.0, height_deg: 20.0 };
        let daylight = controls.moved(true, false);
        assert!(daylight.sun.is_some() && daylight.sky.is_none());
        let mut shown = SunControls { north_deg: 30.0, ..SunControls::default() };
        shown.show(&daylight);
        assert!((shown.direction.azimuth_deg - 250.0).abs() < 1e-3);
        assert!((shown.direction.height_deg - 20.0).abs() < 1e-3);
    }

    #[test]
    fn noon_is_in_the_south_by_the_clocks_of_the_place() {
        let place = PlaceAndTime { hours: 13.1, ..PlaceAndTime::default() };
        let sun = place.sun();
        assert!((sun.azimuth_deg - 180.0).abs() < 3.0 && (sun.height_deg - 60.9).abs() < 0.5, "{sun:?}");
    }
}
