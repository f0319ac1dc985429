//! A measured work plane as a table and as JSON: the same from the command line and the window.

use afterimage::render::lighting::{PlaneStatistics, Reading, Sensor};
use serde_json::{Value, json};
use std::fmt::Write;

/// Unit of what was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Lux.
    Lux,
    /// Lux of a scene without photometric units: only their ratios mean something.
    RelativeLux,
    /// Percent: daylight factors.
    Percent,
    /// Hours of direct sun.
    Hours,
}

impl Unit {
    /// The unit of a scene's illuminances, or of its daylight factors.
    pub fn new(is_factor: bool, is_photometric: bool) -> Self {
        match (is_factor, is_photometric) {
            (true, _) => Self::Percent,
            (false, true) => Self::Lux,
            (false, false) => Self::RelativeLux,
        }
    }

    /// The unit in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Lux => "lux",
            Self::RelativeLux => "lux, relative",
            Self::Percent => "% daylight factor",
            Self::Hours => "hours of direct sun",
        }
    }
}

/// The sensors of a plane with what they read.
#[derive(Clone, Debug)]
pub struct MeasuredPlane {
    /// The sensors.
    pub sensors: Vec<Sensor>,
    /// Readings of the sensors, in lux or percent.
    pub readings: Vec<Reading>,
    /// What the readings say together.
    pub statistics: PlaneStatistics,
    /// Unit of the readings.
    pub unit: Unit,
}

impl MeasuredPlane {
    /// The readings of sensors; `None` without any.
    pub fn new(sensors: Vec<Sensor>, readings: Vec<Reading>, unit: Unit) -> Option<Self> {
        let statistics = PlaneStatistics::new(&readings)?;
        Some(Self { sensors, readings, statistics, unit })
    }

    /// The readings as a table: position, value, and its standard error.
    pub fn csv(&self) -> String {
        let mut text = match self.unit {
            Unit::Percent => "x_m,y_m,z_m,daylight_factor_percent,standard_error_percent\n".to_owned(),
            Unit::Hours => "x_m,y_m,z_m,hours,standard_error_hours\n".to_owned(),
            _ => "x_m,y_m,z_m,lux,standard_error_lux\n".to_owned(),
        };
        for (Sensor { position_m: p, .. }, reading) in self.sensors.iter().zip(&self.readings) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{},{},{},{},{}", p.x, p.y, p.z, reading.lux, reading.standard_error_lux);
        }
        text
    }

    /// Statistics and readings as JSON.
    pub fn json(&self) -> Value {
        let point = |(sensor, reading): (&Sensor, &Reading)| {
            let p = sensor.position_m;
            json!([p.x, p.y, p.z, reading.lux])
        };
        let s = &self.statistics;
        let (quantity, unit) = match self.unit {
            Unit::Percent => ("daylight-factor", "percent"),
            Unit::Hours => ("sun-hours", "hours"),
            Unit::Lux | Unit::RelativeLux => ("illuminance", "lux"),
        };
        let named = |of: &str| format!("{of}_{unit}");
        json!({
            "quantity": quantity,
            "is_photometric": self.unit != Unit::RelativeLux,
            (named("mean")): s.mean_lux,
            (named("min")): s.min_lux,
            (named("max")): s.max_lux,
            "uniformity": s.uniformity,
            "error_percent": finite(s.error_percent),
            "point_error_percent": finite(s.point_error_percent),
            "points": self.sensors.iter().zip(&self.readings).map(point).collect::<Vec<_>>(),
        })
    }

    /// Mean, extremes, uniformity and error, in words.
    pub fn rows(&self) -> [(&'static str, String); 6] {
        let (s, unit) = (&self.statistics, self.unit.words());
        [
            ("points", self.sensors.len().to_string()),
            ("mean", format!("{:.1} {unit}, +-{:.2} % of it", s.mean_lux, s.error_percent)),
            ("smallest", format!("{:.1} {unit}", s.min_lux)),
            ("largest", format!("{:.1} {unit}", s.max_lux)),
            ("uniformity", format!("{:.2}", s.uniformity)),
            ("a point", format!("+-{:.1} %", s.point_error_percent)),
        ]
    }
}

/// The number, or null where it is not known.
fn finite(number: f64) -> Option<f64> {
    Some(number).filter(|number| number.is_finite())
}
