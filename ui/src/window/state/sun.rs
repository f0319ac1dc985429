//! Sun and sky as their controls show them: the sun by direction, or by place and time.

use afterimage::scene::{Daylight, DaylightModel, Sky, SkyKind, place::PlaceAndTime, solar::SunPosition};

/// Position of the sun, as its controls show it.
#[derive(Clone, Debug, PartialEq)]
pub struct SunControls {
    /// Place and time decide, not azimuth and height.
    pub is_by_place: bool,
    /// Azimuth from north over east, and height over the horizon.
    pub direction: SunPosition,
    /// Place and time from which the position of the sun follows.
    pub place: PlaceAndTime,
    /// Angle of north from -Z towards +X, in degrees.
    pub north_deg: f64,
    /// Kind of the sky.
    pub kind: SkyKind,
    /// Haze of the physical sky.
    pub turbidity: f32,
    /// Luminance in cd/m2 of a radiance of one in the scene that is shown.
    pub nits_per_unit: f32,
}

impl Default for SunControls {
    fn default() -> Self {
        let direction = SunPosition { azimuth_deg: 180.0, height_deg: 45.0 };
        let DaylightModel { kind, turbidity, nits_per_unit, north_deg, .. } =
            DaylightModel::new(SkyKind::default(), direction);
        let place = PlaceAndTime::default();
        Self { is_by_place: false, direction, place, north_deg, kind, turbidity, nits_per_unit }
    }
}

impl SunControls {
    /// Returns the position of the sun: the direction, where place and time are not valid.
    pub fn position(&self) -> SunPosition {
        let by_place = self.is_by_place.then(|| self.place.sun().ok()).flatten();
        by_place.unwrap_or(self.direction)
    }

    /// Sets the controls to the sun and the sky of a scene.
    pub fn show(&mut self, daylight: &Daylight) {
        if let Some(sun) = daylight.sun {
            let shown = SunPosition::of_direction(sun.direction);
            let azimuth_deg = (shown.azimuth_deg - self.north_deg).rem_euclid(360.0);
            self.direction = SunPosition { azimuth_deg, ..shown };
        }
        if let Some(sky) = &daylight.sky {
            self.kind = sky.kind();
        }
        if let Some(Sky::Physical(sky)) = &daylight.sky {
            self.turbidity = sky.turbidity();
        }
    }

    /// Returns the daylight with this sun and kind of sky, with or without sun and sky.
    pub fn moved(&self, has_sun: bool, has_sky: bool) -> Daylight {
        let model = DaylightModel {
            kind: self.kind,
            position: self.position(),
            north_deg: self.north_deg,
            turbidity: self.turbidity,
            nits_per_unit: self.nits_per_unit,
        };
        let Daylight { sun, sky } = model.daylight();
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
        let sun = place.sun().unwrap();
        assert!((sun.azimuth_deg - 180.0).abs() < 3.0 && (sun.height_deg - 60.9).abs() < 0.5, "{sun:?}");
    }
}
