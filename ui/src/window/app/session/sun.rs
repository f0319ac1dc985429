//! The controls of the sun in a session file.

use crate::window::state::SunControls;
use afterimage::scene::SkyKind;
use afterimage::scene::place::PlaceAndTime;
use afterimage::scene::solar::SunPosition;
use serde::{Deserialize, Serialize};

/// The controls of the sun, as a session file holds them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SunTable {
    has_sun: bool,
    has_sky: bool,
    is_by_place: bool,
    azimuth_deg: f64,
    height_deg: f64,
    latitude_deg: f64,
    longitude_deg: f64,
    year: i32,
    month: u32,
    day: u32,
    hours: f64,
    zone: String,
    north_deg: f64,
    kind: String,
    turbidity: f32,
}

impl SunTable {
    pub(super) fn of(sun: &SunControls) -> Self {
        let place = sun.place.clone();
        Self {
            has_sun: sun.has_sun,
            has_sky: sun.has_sky,
            is_by_place: sun.is_by_place,
            azimuth_deg: sun.direction.azimuth_deg,
            height_deg: sun.direction.height_deg,
            latitude_deg: place.latitude_deg,
            longitude_deg: place.longitude_deg,
            year: place.year,
            month: place.month,
            day: place.day,
            hours: place.hours,
            zone: place.zone,
            north_deg: sun.north_deg,
            kind: sun.kind.name().to_owned(),
            turbidity: sun.turbidity,
        }
    }

    /// Returns the controls in a scene of these units.
    pub(super) fn controls(&self, nits_per_unit: f32) -> SunControls {
        let mut kinds = SkyKind::MODELS.into_iter().chain([SkyKind::Picture]);
        let kind = kinds.find(|kind| kind.name() == self.kind).unwrap_or_default();
        SunControls {
            has_sun: self.has_sun,
            has_sky: self.has_sky,
            is_by_place: self.is_by_place,
            direction: SunPosition { azimuth_deg: self.azimuth_deg, height_deg: self.height_deg },
            place: PlaceAndTime {
                latitude_deg: self.latitude_deg,
                longitude_deg: self.longitude_deg,
                year: self.year,
                month: self.month,
                day: self.day,
                hours: self.hours,
                zone: self.zone.clone(),
            },
            north_deg: self.north_deg,
            kind,
            turbidity: self.turbidity,
            nits_per_unit,
        }
    }

    /// True where every number is one.
    pub(super) fn is_valid(&self) -> bool {
        let angles =
            [self.azimuth_deg, self.height_deg, self.latitude_deg, self.longitude_deg, self.north_deg];
        angles.iter().all(|angle| angle.abs() <= 1e4)
            && (0.0..=24.0).contains(&self.hours)
            && (1.0..=10.0).contains(&self.turbidity)
    }
}
