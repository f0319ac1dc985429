//! Sun and sky as their controls show them: the sun by direction, or by place and time.

use afterimage::scene::{Daylight, DaylightModel, Sky, SkyKind, place::PlaceAndTime, solar::SunPosition};
use glam::Vec3;

/// Sun and sky, as their controls show them. What is wanted is kept here, also where there is none
/// of it at the moment: at night, or where clouds hide the sun.
#[derive(Clone, Debug, PartialEq)]
pub struct SunControls {
    /// The sun shines whenever it is up.
    pub has_sun: bool,
    /// There is a sky, which is dark at night.
    pub has_sky: bool,
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

/// Largest difference in degrees of two positions that are the same; directions are stored as
/// `f32`.
const SAME_DEG: f64 = 0.01;

impl Default for SunControls {
    fn default() -> Self {
        let direction = SunPosition { azimuth_deg: 180.0, height_deg: 45.0 };
        let DaylightModel { kind, turbidity, nits_per_unit, north_deg, .. } =
            DaylightModel::new(SkyKind::default(), direction);
        Self {
            has_sun: false,
            has_sky: false,
            is_by_place: false,
            direction,
            place: PlaceAndTime::default(),
            north_deg,
            kind,
            turbidity,
            nits_per_unit,
        }
    }
}

impl SunControls {
    /// Returns the position of the sun: the direction, where place and time are not valid.
    pub fn position(&self) -> SunPosition {
        let by_place = self.is_by_place.then(|| self.place.sun().ok()).flatten();
        by_place.unwrap_or(self.direction)
    }

    /// Sets the controls to the sun and the sky of a scene. Controls that lead to this daylight
    /// stay as they are: at night, or by place and time.
    pub fn show(&mut self, daylight: &Daylight) {
        if self.daylight() == *daylight {
            return;
        }
        if let Some(sun) = daylight.sun {
            self.show_sun(sun.direction);
        }
        let is_overcast = daylight.sky.as_ref().is_some_and(|sky| sky.kind() == SkyKind::Overcast);
        self.has_sun = daylight.sun.is_some() || is_overcast;
        self.has_sky = daylight.sky.is_some();
        if let Some(sky) = &daylight.sky {
            self.kind = sky.kind();
        }
        if let Some(Sky::Physical(sky)) = &daylight.sky {
            self.turbidity = sky.turbidity();
        }
    }

    /// Shows the direction of a sun, unless it stands there by these controls.
    fn show_sun(&mut self, direction: Vec3) {
        let wanted = self.position().direction(self.north_deg);
        if wanted.angle_between(direction.as_dvec3()).to_degrees() > SAME_DEG {
            let shown = SunPosition::of_direction(direction);
            let azimuth_deg = (shown.azimuth_deg - self.north_deg).rem_euclid(360.0);
            self.direction = SunPosition { azimuth_deg, ..shown };
            self.is_by_place = false;
        }
    }

    /// Returns the daylight of these controls. There is no sun below the horizon.
    pub fn daylight(&self) -> Daylight {
        let model = DaylightModel {
            kind: self.kind,
            position: self.position(),
            north_deg: self.north_deg,
            turbidity: self.turbidity,
            nits_per_unit: self.nits_per_unit,
        };
        let Daylight { sun, sky } = model.daylight();
        Daylight { sun: sun.filter(|_| self.has_sun), sky: sky.filter(|_| self.has_sky) }
    }

    /// Returns the daylight after the controls were changed from `before`, in a scene that shows
    /// `now`. What the change does not concern stays as the scene has it.
    pub fn changed(&self, before: &Self, now: &Daylight) -> Daylight {
        let is_other_kind = self.kind != before.kind || self.turbidity != before.turbidity;
        // While a place is not valid, the sun stays where it is.
        let is_known = !self.is_by_place || self.place.sun().is_ok();
        let has_moved =
            is_known && (self.position() != before.position() || self.north_deg != before.north_deg);
        let made = self.daylight();
        let is_new = |has: bool, had: bool| has != had || is_other_kind || has_moved;
        let picture = now.sky.as_ref().filter(|sky| sky.kind() == SkyKind::Picture && !is_other_kind);
        let keeps_sky = (picture.is_some() && self.has_sky) || !is_new(self.has_sky, before.has_sky);
        Daylight {
            sun: if is_new(self.has_sun, before.has_sun) { made.sun } else { now.sun },
            sky: if keeps_sky { now.sky.clone() } else { made.sky },
        }
    }

    /// Returns what the light outside is like, in words; empty where it is an ordinary day.
    pub fn words(&self) -> &'static str {
        let height_deg = self.position().height_deg;
        if !self.has_sun && !self.has_sky {
            ""
        } else if height_deg <= DaylightModel::NIGHT_DEG {
            "Night: the sun is far below the horizon."
        } else if height_deg <= 0.0 {
            "The sun is below the horizon."
        } else if self.has_sun && self.kind == SkyKind::Overcast {
            "Clouds hide the sun."
        } else {
            ""
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn day() -> SunControls {
        SunControls { has_sun: true, has_sky: true, ..SunControls::default() }
    }

    #[test]
    fn the_controls_show_the_sun_that_they_set() {
        let mut controls = SunControls { north_deg: 30.0, has_sky: false, ..day() };
        controls.direction = SunPosition { azimuth_deg: 250.0, height_deg: 20.0 };
        let daylight = controls.daylight();
        assert!(daylight.sun.is_some() && daylight.sky.is_none());
        let mut shown = SunControls { north_deg: 30.0, ..SunControls::default() };
        shown.show(&daylight);
        assert!((shown.direction.azimuth_deg - 250.0).abs() < 1e-3);
        assert!((shown.direction.height_deg - 20.0).abs() < 1e-3);
        assert!(shown.has_sun && !shown.has_sky);
    }

    #[test]
    fn noon_is_in_the_south_by_the_clocks_of_the_place() {
        let place = PlaceAndTime { hours: 13.1, ..PlaceAndTime::default() };
        let sun = place.sun().unwrap();
        assert!((sun.azimuth_deg - 180.0).abs() < 3.0 && (sun.height_deg - 60.9).abs() < 0.5, "{sun:?}");
    }

    #[test]
    fn showing_what_the_controls_lead_to_changes_nothing() {
        for hours in [0.0, 4.5, 9.0, 17.3, 23.9] {
            let place = PlaceAndTime { hours, ..PlaceAndTime::default() };
            let mut controls = SunControls { is_by_place: true, place, ..day() };
            let before = controls.clone();
            controls.show(&before.daylight());
            assert_eq!(controls, before);
        }
    }

    #[test]
    fn a_night_between_two_days_changes_nothing() {
        let at = |hours| SunControls {
            is_by_place: true,
            place: PlaceAndTime { hours, ..PlaceAndTime::default() },
            ..day()
        };
        let (noon, night) = (at(12.0), at(1.0));
        let dark = night.changed(&noon, &noon.daylight());
        assert_eq!(dark, Daylight::default());
        assert!(night.words().starts_with("Night"));
        assert_eq!(noon.changed(&night, &dark), noon.daylight());
    }

    #[test]
    fn only_changed_parts_of_daylight_change() {
        let own = Daylight { sky: Some(Sky::even(Vec3::X)), sun: None };
        let without = SunControls { has_sun: false, ..day() };
        let lit = day().changed(&without, &own);
        assert!(lit.sun.is_some() && lit.sky == own.sky, "the sky stays");
        let mut moved = day();
        moved.direction.height_deg = 10.0;
        let evening = moved.changed(&day(), &lit);
        assert!(evening.sky != lit.sky && evening.sun != lit.sun);
        let off = SunControls { has_sun: false, has_sky: false, ..day() };
        assert_eq!(off.changed(&day(), &lit), Daylight::default());
    }

    #[test]
    fn clouds_hide_the_sun_until_another_sky_is_chosen() {
        let clouded = SunControls { kind: SkyKind::Overcast, ..day() };
        let overcast = clouded.changed(&day(), &day().daylight());
        assert!(overcast.sun.is_none() && overcast.sky.as_ref().unwrap().kind() == SkyKind::Overcast);
        assert_eq!(day().changed(&clouded, &overcast), day().daylight());
        let mut shown = day();
        shown.show(&overcast);
        assert!(shown.has_sun && shown.words() == "Clouds hide the sun.");
    }

    #[test]
    fn a_zone_that_does_not_exist_leaves_the_sun_where_it_is() {
        let by_place = SunControls { is_by_place: true, ..day() };
        let mut wrong = by_place.clone();
        wrong.place.zone = "Europe/Berli".to_owned();
        assert_eq!(wrong.changed(&by_place, &by_place.daylight()), by_place.daylight());
    }
}
