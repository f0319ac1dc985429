//! `[sun]` and `[sky]` of a sidecar.

use super::table::{Notes, Section};
use crate::import::options::Limits;
use crate::import::search::Finder;
use crate::import::{sky_picture::load_sky, units::UnknownWord};
use crate::scene::daylight::GROUND_ALBEDO;
use crate::scene::place::{PlaceAndTime, parse_place};
use crate::scene::solar::SunPosition;
use crate::scene::{
    CieSky, DaylightModel, Gradient, PhysicalSky, PictureSky, SceneBuilder, SceneError, Sky, SkyKind, Sun,
};
use glam::{DVec3, Vec3};
use std::{str::FromStr, sync::Arc};

/// Keys of `[sky]`.
pub(super) const SKY_KEYS: [&str; 11] = [
    "off",
    "kind",
    "zenith",
    "horizon",
    "ground",
    "sun_direction",
    "turbidity",
    "albedo",
    "brightness",
    "picture",
    "rotation_deg",
];

/// Keys of `[sun]`.
pub(super) const SUN_KEYS: [&str; 8] =
    ["off", "direction", "irradiance", "lux", "angular_radius_deg", "place", "time", "north_deg"];

/// The light from outside, as far as a sidecar gives it.
#[derive(Debug, Default)]
pub(super) struct Light {
    sun: Option<SunValues>,
    sky: Option<SkyValues>,
    /// `off = true`: there is none, whatever the model has.
    is_sun_off: bool,
    is_sky_off: bool,
}

#[derive(Debug)]
struct SunValues {
    direction: Option<Vec3>,
    irradiance: Option<Vec3>,
    /// Illuminance of a surface that faces it, where no irradiance is given.
    lux: Option<f32>,
    angular_radius: Option<f32>,
    /// Position by place and time, and the angle of north in degrees.
    by_place: Option<(SunPosition, f64)>,
}

#[derive(Debug)]
struct SkyValues {
    kind: SkyKind,
    zenith: Option<Vec3>,
    horizon: Option<Vec3>,
    ground: Option<Vec3>,
    sun_direction: Option<Vec3>,
    turbidity: Option<f32>,
    albedo: Option<f32>,
    brightness: Option<f32>,
    /// Path of a picture, and the line that names it.
    picture: Option<(String, u64)>,
    rotation_deg: f32,
}

struct Kind(SkyKind);

impl FromStr for Kind {
    type Err = UnknownWord;

    fn from_str(text: &str) -> Result<Self, UnknownWord> {
        let known = "gradient, overcast, clear, physical, picture";
        let mut kinds = SkyKind::MODELS.into_iter().chain([SkyKind::Picture]);
        let kind = kinds.find(|kind| kind.name() == text);
        kind.map(Self).ok_or_else(|| UnknownWord::new(text, "a kind of sky", known))
    }
}

impl Light {
    pub(super) fn read(top: &Section, notes: &mut Notes) -> Self {
        let of_sun = top.section("sun", "[sun]", &SUN_KEYS, notes);
        let of_sky = top.section("sky", "[sky]", &SKY_KEYS, notes);
        let mut is_off =
            |section: Option<Section>| section.is_some_and(|s| s.flag("off", notes).unwrap_or(false));
        let (is_sun_off, is_sky_off) = (is_off(of_sun), is_off(of_sky));
        Self {
            sun: of_sun.filter(|_| !is_sun_off).map(|s| sun(&s, notes)),
            sky: of_sky.filter(|_| !is_sky_off).and_then(|s| sky(&s, notes)),
            is_sun_off,
            is_sky_off,
        }
    }

    /// Sets sun and sky of the builder. What the sidecar, a file of name `file_name`, does not give
    /// follows from the position of the sun, in the units of the model.
    pub(super) fn apply(self, file_name: &str, finder: &mut Finder, builder: &mut SceneBuilder) {
        let by_place = self.sun.as_ref().and_then(|sun| sun.by_place);
        let given = self.sun.as_ref().and_then(|sun| sun.direction);
        let direction = given.or(builder.sun.map(|sun| sun.direction)).unwrap_or(Sun::clear_day().direction);
        let (position, north_deg) = by_place.unwrap_or((SunPosition::of_direction(direction), 0.0));
        let kind = self.sky.as_ref().map_or(SkyKind::default(), |sky| sky.kind);
        let turbidity = self.sky.as_ref().and_then(|sky| sky.turbidity);
        let model = DaylightModel {
            north_deg,
            turbidity: turbidity.unwrap_or(DaylightModel::DEFAULT_TURBIDITY),
            nits_per_unit: builder.nits_per_unit(),
            ..DaylightModel::new(kind, position)
        };
        let light = model.daylight();
        if let Some(values) = self.sun {
            let lux = values.lux.map(|lux| Vec3::splat(lux / builder.nits_per_unit()));
            let default = match values.by_place {
                Some(_) => light.sun,
                None => Some(Sun { direction, ..Sun::clear_day() }),
            };
            builder.sun = default.map(|default| Sun {
                irradiance: values.irradiance.or(lux).unwrap_or(default.irradiance),
                angular_radius: values.angular_radius.unwrap_or(default.angular_radius),
                ..default
            });
        }
        (builder.is_sun_off, builder.is_sky_off) = (self.is_sun_off, self.is_sky_off);
        builder.sun = builder.sun.filter(|_| !self.is_sun_off);
        match self.sky {
            None if self.is_sky_off => builder.sky = None,
            None => {}
            Some(SkyValues { picture: Some((name, line)), rotation_deg, brightness, .. }) => {
                match picture(&name, finder, builder.nits_per_unit()) {
                    Ok(sky) => {
                        let brightness = brightness.unwrap_or(sky.brightness);
                        builder.sky = Some(Sky::Picture(PictureSky { rotation_deg, brightness, ..sky }));
                    }
                    Err(cause) => builder.warn(file_name, line, cause),
                }
            }
            Some(values) => builder.sky = values.sky(light.sky),
        }
    }
}

impl SkyValues {
    /// Returns the sky with the values that are given, others as in `model`; none at night.
    fn sky(self, model: Option<Sky>) -> Option<Sky> {
        match model {
            Some(Sky::Cie(cie)) => Some(Sky::Cie(CieSky {
                zenith: self.zenith.unwrap_or(cie.zenith),
                ground: self.ground.unwrap_or(cie.ground),
                sun_direction: self.sun_direction.unwrap_or(cie.sun_direction),
                ..cie
            })),
            Some(Sky::Physical(sky)) => Some(Sky::Physical(PhysicalSky::new(
                self.sun_direction.unwrap_or(sky.sun_direction()),
                sky.turbidity(),
                self.albedo.unwrap_or(GROUND_ALBEDO),
                self.brightness.unwrap_or(sky.brightness()),
                self.ground.unwrap_or(sky.ground()),
            ))),
            _ if self.kind == SkyKind::Gradient => {
                let default = Gradient::CLEAR_DAY;
                Some(Sky::Gradient(Gradient {
                    zenith: self.zenith.unwrap_or(default.zenith),
                    horizon: self.horizon.unwrap_or(default.horizon),
                    ground: self.ground.unwrap_or(default.ground),
                }))
            }
            _ => None,
        }
    }
}

/// Reads the picture of a sky, of which the sidecar gives the path relative to the model.
fn picture(name: &str, finder: &mut Finder, nits_per_unit: f32) -> Result<PictureSky, String> {
    let found = finder.library(name);
    let Some(file) = found.file else {
        let outside = if found.outside {
            "; files outside the scene's folder are opened only when that is allowed"
        } else {
            ""
        };
        let tried = found.tried.join(", ");
        return Err(format!(
            "the sky picture '{name}' was not found and is not used. Tried: {tried}{outside}"
        ));
    };
    let image = load_sky(&file, &Limits::default()).map_err(|error| match error {
        SceneError::Read { cause, remedy, .. } => {
            format!("the sky picture '{name}' is not used: {cause}; {remedy}")
        }
        other => other.to_string(),
    })?;
    Ok(PictureSky::new(Arc::new(image), nits_per_unit))
}

fn direction(s: &Section, key: &str, notes: &mut Notes) -> Option<Vec3> {
    let given = s.point(key, notes)?;
    let unit = given.try_normalize().map(|d: DVec3| d.as_vec3());
    if unit.is_none() {
        notes.add(s.at(), format!("'{key}' in {} has no length; the default direction is used", s.name()));
    }
    unit
}

fn sun(s: &Section, notes: &mut Notes) -> SunValues {
    let radius_deg = s.number("angular_radius_deg", 0.0..=90.0, notes);
    SunValues {
        direction: direction(s, "direction", notes),
        irradiance: s.color("irradiance", Limits::RADIANCE, notes),
        lux: s.number("lux", 0.0..=f64::from(Limits::RADIANCE), notes).map(|lux| lux as f32),
        angular_radius: radius_deg.map(|r| r.to_radians() as f32),
        by_place: by_place(s, notes),
    }
}

fn by_place(s: &Section, notes: &mut Notes) -> Option<(SunPosition, f64)> {
    let (place, time) = (s.text("place", notes), s.text("time", notes));
    let north_deg = s.number("north_deg", -360.0..=360.0, notes).unwrap_or(0.0);
    let (Some(place), Some(time)) = (place, time) else {
        if place.is_some() || time.is_some() {
            notes.add(s.at(), "[sun] needs both place and time; they were ignored".to_owned());
        }
        return None;
    };
    let position = parse_place(place).and_then(|place| PlaceAndTime::at(place, time)?.sun());
    match position {
        Ok(position) => Some((position, north_deg)),
        Err(error) => {
            notes.add(s.at(), format!("{error}; place and time in [sun] were ignored"));
            None
        }
    }
}

fn sky(s: &Section, notes: &mut Notes) -> Option<SkyValues> {
    let written = s.word::<Kind>("kind", notes).map(|kind| kind.0);
    let picture = s.text("picture", notes).map(|name| (name.to_owned(), notes.line(s.at())));
    let kind = written.unwrap_or(if picture.is_some() { SkyKind::Picture } else { SkyKind::default() });
    if kind == SkyKind::Picture && picture.is_none() {
        notes.add(s.at(), "[sky] of kind 'picture' needs a picture; it was ignored".to_owned());
        return None;
    }
    // The picture of another kind is kept in the file and not read.
    let picture = picture.filter(|_| kind == SkyKind::Picture);
    let rotation_deg = s.number("rotation_deg", -360.0..=360.0, notes).unwrap_or(0.0) as f32;
    let mut color = |key| s.color(key, Limits::RADIANCE, notes);
    let (zenith, horizon, ground) = (color("zenith"), color("horizon"), color("ground"));
    let mut number = |key, range| s.number(key, range, notes).map(|n| n as f32);
    let (turbidity, albedo) = (number("turbidity", 1.0..=10.0), number("albedo", 0.0..=1.0));
    let brightness = number("brightness", 0.0..=f64::from(Limits::RADIANCE));
    let sun_direction = direction(s, "sun_direction", notes);
    Some(SkyValues {
        kind,
        zenith,
        horizon,
        ground,
        sun_direction,
        turbidity,
        albedo,
        brightness,
        picture,
        rotation_deg,
    })
}
