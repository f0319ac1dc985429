//! The position of the sun for a place on earth and a local time there.
//!
//! Source: Reda and Andreas 2004, "Solar position algorithm for solar radiation applications", in
//! the crate `solar-positioning`. Time zones are those of the IANA database in the program, so that
//! all systems agree.

use super::solar::SunPosition;
use jiff::civil::{Date, DateTime};
use jiff::tz::{TimeZone, db};
use jiff::{SignedDuration, Timestamp, ZonedDateTime};
use solar_positioning::{
    Horizon, Location, RefractionCorrection, SolarEvents, SolarPositions, delta_t, time::JulianDate,
};

/// A place on earth and a local time there.
#[derive(Clone, Debug, PartialEq)]
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
    /// Local time in hours since midnight, with summer time where the zone has it.
    pub hours: f64,
    /// Time zone by its name in the IANA database, such as `Europe/Berlin`.
    pub zone: String,
}

/// When the sun rises and sets on a day at a place, by the clocks there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SunTimes {
    /// Hours since midnight of the first sunrise and the first sunset of the day; one of them may
    /// be missing where the sun is up around midnight.
    Changes {
        /// Local time of sunrise in hours.
        sunrise: Option<f64>,
        /// Local time of sunset in hours.
        sunset: Option<f64>,
    },
    /// The sun is up all day.
    AlwaysUp,
    /// The sun stays below the horizon.
    AlwaysDown,
}

/// A place or time that cannot be used, with the reason and an example.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PlaceError(String);

impl Default for PlaceAndTime {
    /// Noon of midsummer in Berlin.
    fn default() -> Self {
        Self {
            latitude_deg: 52.52,
            longitude_deg: 13.40,
            year: 2026,
            month: 6,
            day: 21,
            hours: 12.0,
            zone: "Europe/Berlin".to_owned(),
        }
    }
}

impl PlaceAndTime {
    /// Years for which the position of the sun is computed.
    pub const YEARS: std::ops::RangeInclusive<i32> = 1900..=2200;

    /// Parses a place, `LATITUDE,LONGITUDE` in degrees, and a time as RFC 9557 writes it:
    /// `2026-06-21T12:00[Europe/Berlin]`, or `2026-06-21T10:00Z` for universal time.
    ///
    /// # Errors
    /// [`PlaceError`] where one of them cannot be read or is out of range.
    pub fn parse(place: &str, time: &str) -> Result<Self, PlaceError> {
        Self::at(parse_place(place)?, time)
    }

    /// [`Self::parse`] for a place given as latitude and longitude.
    ///
    /// # Errors
    /// As there.
    pub fn at([latitude_deg, longitude_deg]: [f64; 2], time: &str) -> Result<Self, PlaceError> {
        let local = parse_time(time)?;
        let zone = local.time_zone().iana_name().unwrap_or("UTC").to_owned();
        let (date, clock) = (local.date(), local.time().duration_since(jiff::civil::Time::midnight()));
        let parsed = Self {
            latitude_deg,
            longitude_deg,
            year: date.year().into(),
            month: date.month().unsigned_abs().into(),
            day: date.day().unsigned_abs().into(),
            hours: clock.as_secs_f64() / 3600.0,
            zone,
        };
        parsed.sun().map(|_| parsed)
    }

    /// Returns the position of the sun, raised by refraction in standard air.
    ///
    /// # Errors
    /// [`PlaceError`] where the date or zone does not exist, or a value is out of range.
    pub fn sun(&self) -> Result<SunPosition, PlaceError> {
        let time = self.timestamp()?;
        let location = self.location();
        let position = delta_t::estimate_from_date(self.year, self.month)
            .and_then(|delta| JulianDate::new(julian_day(time), delta))
            .and_then(|day| {
                let refraction = Some(RefractionCorrection::standard());
                SolarPositions::new().at_from_julian(day, location, 0.0, refraction)
            });
        let position = position.map_err(|error| PlaceError(error.to_string()))?;
        Ok(SunPosition { azimuth_deg: position.azimuth(), height_deg: position.elevation_angle() })
    }

    /// Returns when the sun rises and sets on the day: when its upper edge, raised by refraction,
    /// touches the horizon, as calendars have it.
    ///
    /// # Errors
    /// As [`Self::sun`].
    pub fn sun_times(&self) -> Result<SunTimes, PlaceError> {
        let midnight = |hours| Self { hours, ..self.clone() }.timestamp().map(julian_day);
        let (start, end) = (midnight(0.0)?, midnight(24.0)?);
        let events = delta_t::estimate_from_date(self.year, self.month).and_then(|delta| {
            let (events, horizon) = (SolarEvents::new(), Horizon::SunriseSunset);
            events.for_interval_from_julian(start, end, self.location(), delta, horizon)
        });
        let events = events.map_err(|error| PlaceError(error.to_string()))?;
        if events.always_above() {
            return Ok(SunTimes::AlwaysUp);
        }
        if events.always_below() {
            return Ok(SunTimes::AlwaysDown);
        }
        let clock = |days: &[f64]| days.first().and_then(|day| self.clock_at(*day));
        Ok(SunTimes::Changes { sunrise: clock(&events.rises), sunset: clock(&events.sets) })
    }

    /// Returns the name of the clocks at the time, such as `CEST`, or the offset where the zone has
    /// none; empty where the time is not valid.
    pub fn clock_name(&self) -> String {
        let zoned = |at: Timestamp| TimeZone::get(&self.zone).map(|zone| at.to_zoned_datetime(zone));
        let zoned = self.timestamp().ok().and_then(|at| zoned(at).ok());
        zoned.map_or_else(String::new, |zoned| zoned.strftime("%Z").to_string())
    }

    /// Returns the local time in hours of a Julian day in universal time.
    fn clock_at(&self, julian: f64) -> Option<f64> {
        let seconds = (julian - JULIAN_DAY_OF_1970) * 86_400.0;
        let time = Timestamp::from_duration(SignedDuration::from_secs_f64(seconds)).ok()?;
        let local = time.to_zoned_datetime(TimeZone::get(&self.zone).ok()?).time();
        Some(local.duration_since(jiff::civil::Time::midnight()).as_secs_f64() / 3600.0)
    }

    fn location(&self) -> Location {
        Location { latitude: self.latitude_deg, longitude: self.longitude_deg }
    }

    /// Returns the moment in universal time. Of a time that a change of the clocks skips or
    /// repeats, the one after the gap or the first one counts.
    fn timestamp(&self) -> Result<Timestamp, PlaceError> {
        let wrong = |what: String| PlaceError(what);
        if !Self::YEARS.contains(&self.year) {
            return Err(wrong(format!("the year {} is not from 1900 to 2200", self.year)));
        }
        let narrow = |value: u32| i8::try_from(value).unwrap_or(i8::MAX);
        let date = Date::new(self.year as i16, narrow(self.month), narrow(self.day))
            .map_err(|_| wrong(format!("there is no day {}-{}-{}", self.year, self.month, self.day)))?;
        let hours = if (0.0..=24.0).contains(&self.hours) { self.hours } else { 12.0 };
        let since_midnight = SignedDuration::from_secs_f64(hours * 3600.0);
        let local = DateTime::from(date).checked_add(since_midnight);
        let zone = TimeZone::get(&self.zone).map_err(|_| unknown_zone(&self.zone))?;
        local
            .and_then(|local| zone.into_ambiguous_zoned_datetime(local).compatible())
            .map(|local| local.timestamp())
            .map_err(|error| wrong(error.to_string()))
    }
}

/// Julian day of the start of 1 January 1970 in universal time.
const JULIAN_DAY_OF_1970: f64 = 2_440_587.5;

fn julian_day(time: Timestamp) -> f64 {
    time.as_duration().as_secs_f64() / 86_400.0 + JULIAN_DAY_OF_1970
}

/// Returns the names of all time zones, sorted.
pub fn zones() -> Vec<String> {
    db().available().map(|name| name.to_string()).collect()
}

fn unknown_zone(name: &str) -> PlaceError {
    PlaceError(format!("there is no time zone '{name}'; zones have names like Europe/Berlin"))
}

/// Parses latitude and longitude in degrees, like `52.52,13.40`.
///
/// # Errors
/// [`PlaceError`] where there are not two numbers in range.
pub fn parse_place(text: &str) -> Result<[f64; 2], PlaceError> {
    let numbers =
        text.split_once(',').and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    numbers.filter(is_place).ok_or_else(|| {
        let help = "latitude from -90 to 90 and longitude from -180 to 180, in degrees, like 52.52,13.40";
        PlaceError(format!("'{text}' is not a place; give {help}"))
    })
}

/// True for a latitude from -90 to 90 and a longitude from -180 to 180.
pub(crate) fn is_place(place: &[f64; 2]) -> bool {
    place[0].abs() <= 90.0 && place[1].abs() <= 180.0
}

fn parse_time(text: &str) -> Result<ZonedDateTime, PlaceError> {
    if let Ok(zoned) = text.parse::<ZonedDateTime>() {
        return Ok(zoned);
    }
    if let Ok(timestamp) = text.parse::<Timestamp>() {
        return Ok(timestamp.to_zoned_datetime(TimeZone::UTC));
    }
    let zone = text.split_once('[').and_then(|(_, rest)| rest.strip_suffix(']'));
    if let Some(unknown) = zone.filter(|name| TimeZone::get(name).is_err()) {
        return Err(unknown_zone(unknown));
    }
    let help = "give date, time and zone like 2026-06-21T12:00[Europe/Berlin]";
    Err(PlaceError(format!("'{text}' is not a time at a place; {help}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions by PyEphem 4.2 (VSOP87), airless: place, time, azimuth and height in degrees. The
    /// second is that of Reda and Andreas 2004, table A5.1.
    const ALMANAC: [(&str, &str, f64, f64); 5] = [
        ("52.52,13.40", "2026-06-21T12:00[Europe/Berlin]", 149.355, 58.144),
        ("39.742476,-105.1786", "2003-10-17T19:30:30Z", 194.340, 39.872),
        ("52.52,13.40", "2026-12-21T12:00[Europe/Berlin]", 178.949, 14.035),
        ("-33.87,151.21", "2026-01-15T09:00[Australia/Sydney]", 93.413, 35.143),
        ("52.52,13.40", "2026-06-21T10:00Z", 149.355, 58.144),
    ];

    #[test]
    fn the_sun_stands_where_an_almanac_has_it_in_summer_time_too() {
        for (place, time, azimuth_deg, height_deg) in ALMANAC {
            let sun = PlaceAndTime::parse(place, time).unwrap().sun().unwrap();
            assert!((sun.azimuth_deg - azimuth_deg).abs() < 0.02, "{place} {time} {sun:?}");
            // Refraction raises the sun by 0.017 degrees at 45, and by 0.06 at 15.
            assert!((-0.001..0.075).contains(&(sun.height_deg - height_deg)), "{place} {time} {sun:?}");
        }
        let winter_clock = PlaceAndTime::parse("52.52,13.40", "2026-06-21T11:00Z").unwrap().sun().unwrap();
        let off = winter_clock.azimuth_deg - ALMANAC[0].2;
        assert!((26.0..28.0).contains(&off), "an hour at noon in June is 27 degrees: {off}");
    }

    #[test]
    fn places_and_times_that_do_not_exist_are_refused_with_a_reason() {
        for (place, time, part) in [
            ("52.5", "2026-06-21T12:00[Europe/Berlin]", "like 52.52,13.40"),
            ("91,0", "2026-06-21T12:00[Europe/Berlin]", "latitude from -90"),
            ("nan,0", "2026-06-21T12:00[Europe/Berlin]", "latitude from -90"),
            ("52.5,13.4", "2026-06-21T12:00[Europe/Bärlin]", "no time zone 'Europe/Bärlin'"),
            ("52.5,13.4", "2026-06-31T12:00[Europe/Berlin]", "is not a time"),
            ("52.5,13.4", "2026-06-21T12:00", "like 2026-06-21T12:00[Europe/Berlin]"),
            ("52.5,13.4", "1066-10-14T12:00[Europe/London]", "1900 to 2200"),
            ("52.5,13.4", "", "is not a time"),
        ] {
            let error = PlaceAndTime::parse(place, time).unwrap_err().to_string();
            assert!(error.contains(part), "{place} {time}: {error}");
        }
        let none = PlaceAndTime { day: 31, ..PlaceAndTime::default() };
        assert!(none.sun().unwrap_err().to_string().contains("no day 2026-6-31"));
    }

    #[test]
    fn midnight_at_the_end_of_a_day_and_skipped_hours_exist() {
        let last = PlaceAndTime { hours: 24.0, ..PlaceAndTime::default() };
        let next = PlaceAndTime { hours: 0.0, day: 22, ..PlaceAndTime::default() };
        assert_eq!(last.sun(), next.sun());
        let skipped = PlaceAndTime { month: 3, day: 29, hours: 2.5, ..PlaceAndTime::default() };
        let after = PlaceAndTime { hours: 3.5, ..skipped.clone() };
        assert_eq!(skipped.sun(), after.sun());
        assert!(zones().len() > 400 && zones().iter().any(|zone| zone == "Asia/Tokyo"));
    }

    #[test]
    fn the_sun_rises_and_sets_when_calendars_say() {
        // Times of the almanac for Berlin, Sydney and Nairobi, to the minute.
        for (place, time, rise, set, clocks) in [
            ("52.52,13.40", "2026-06-21T12:00[Europe/Berlin]", 4.72, 21.55, "CEST"),
            ("52.52,13.40", "2026-12-21T12:00[Europe/Berlin]", 8.25, 15.9, "CET"),
            ("-1.29,36.82", "2026-03-21T12:00[Africa/Nairobi]", 6.57, 18.68, "EAT"),
        ] {
            let place = PlaceAndTime::parse(place, time).unwrap();
            let SunTimes::Changes { sunrise: Some(up), sunset: Some(down) } = place.sun_times().unwrap()
            else {
                panic!("{place:?}")
            };
            assert!((up - rise).abs() < 0.05 && (down - set).abs() < 0.05, "{time}: {up} {down}");
            assert_eq!(place.clock_name(), clocks);
        }
        let north = |time| PlaceAndTime::parse("78.2,15.6", time).unwrap().sun_times().unwrap();
        assert_eq!(north("2026-06-21T12:00[Europe/Oslo]"), SunTimes::AlwaysUp);
        assert_eq!(north("2026-12-21T12:00[Europe/Oslo]"), SunTimes::AlwaysDown);
    }
}
