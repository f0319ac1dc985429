//! A sky and a position of the sun that the user asks for, whatever the scene has.

use super::{options::Limits, sky_picture::load_sky};
use crate::scene::place::PlaceAndTime;
use crate::scene::solar::SunPosition;
use crate::scene::{
    Daylight, DaylightModel, GroundChoice, LightSetting, NO_LIGHT, PictureSky, Scene, SceneEdit, Sky,
    SkyKind, Sun, Warning,
};
use std::path::{Path, PathBuf};
use std::{convert::Infallible, str::FromStr, sync::Arc};

/// The sky that the user asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SkyChoice {
    /// No sky.
    None,
    /// A sky of a kind that follows from the position of the sun.
    Model(SkyKind),
    /// A picture from a file.
    Picture(PathBuf),
}

impl FromStr for SkyChoice {
    type Err = Infallible;

    /// Any word that is not a kind of sky is the path of a picture.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "none" => Self::None,
            "default" => Self::Model(SkyKind::Gradient),
            word => SkyKind::MODELS
                .into_iter()
                .find(|kind| kind.name() == word)
                .map_or_else(|| Self::Picture(word.into()), Self::Model),
        })
    }
}

/// How the user wants a group of lights, given by its name, to be set.
#[derive(Clone, Debug, PartialEq)]
pub struct LightChoice {
    /// Name of the group.
    pub name: String,
    /// Factor, colour and switch of the light.
    pub setting: LightSetting,
}

impl FromStr for LightChoice {
    type Err = String;

    /// Reads `NAME=FACTOR`, where the factor is a number, `on` or `off`.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("NAME=FACTOR with a factor from 0 to {}", LightSetting::MAX_INTENSITY);
        let (name, factor) = text.rsplit_once('=').ok_or_else(|| format!("it must be {}", expected()))?;
        let full = LightSetting::FULL;
        let setting = match factor.trim() {
            "on" => full,
            "off" => LightSetting { is_on: false, ..full },
            number => {
                let intensity =
                    number.parse().ok().filter(|n| (0.0..=LightSetting::MAX_INTENSITY).contains(n));
                LightSetting {
                    intensity: intensity.ok_or_else(|| format!("it must be {}", expected()))?,
                    ..full
                }
            }
        };
        Ok(Self { name: name.trim().to_owned(), setting })
    }
}

/// Daylight, lights and ground that the user asks for. The default leaves those of the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DaylightOptions {
    /// Groups of lights that are set differently.
    pub lights: Vec<LightChoice>,
    /// The sky.
    pub sky: Option<SkyChoice>,
    /// Place and time, from which the position of the sun follows.
    pub sun: Option<PlaceAndTime>,
    /// Angle of north from -Z towards +X in degrees, for the sun and for sky pictures.
    pub north_deg: f64,
    /// The ground.
    pub ground: Option<GroundChoice>,
}

impl DaylightOptions {
    /// Returns the scene in this daylight. A sky that cannot be used is a warning of the scene,
    /// which keeps its own.
    #[must_use]
    pub fn apply(&self, scene: Scene) -> Scene {
        let scene = self.set_lights(self.apply_daylight(scene));
        match self.ground {
            Some(choice) => scene.with_ground_choice(choice),
            None => scene,
        }
    }

    /// Sets groups of lights. A name that no group has is a warning of the scene.
    fn set_lights(&self, scene: Scene) -> Scene {
        if self.lights.is_empty() {
            return scene;
        }
        let (mut edit, groups) = (scene.to_edit(), &scene.light_groups.list);
        let mut problems = Vec::new();
        for LightChoice { name, setting } in &self.lights {
            match groups.iter().find(|group| group.name.eq_ignore_ascii_case(name)) {
                Some(group) => edit.lights.set(&group.name, *setting),
                None => {
                    let names: Vec<&str> = groups.iter().map(|group| group.name.as_str()).collect();
                    let message =
                        format!("no group of lights is named '{name}'; there are {}", names.join(", "));
                    problems.push(warning("", message));
                }
            }
        }
        let mut lit = scene.with_edit(&edit);
        lit.warnings.extend(problems);
        lit
    }

    fn apply_daylight(&self, scene: Scene) -> Scene {
        if self.sky.is_none() && self.sun.is_none() {
            return scene;
        }
        let (daylight, problem) = self.daylight(&scene.at_full());
        let mut lit = scene.with_edit(&SceneEdit { daylight, ..scene.to_edit() });
        match problem {
            Some(problem) => lit.warnings.push(problem),
            // The light that was added for want of another is gone.
            None => lit.warnings.retain(|w| !w.message.starts_with(NO_LIGHT)),
        }
        lit
    }

    fn daylight(&self, scene: &Scene) -> (Daylight, Option<Warning>) {
        let position = self.sun.as_ref().map(PlaceAndTime::sun).transpose();
        let given = match position {
            Ok(position) => position,
            Err(error) => return (unchanged(scene), Some(warning("", error.to_string()))),
        };
        let of_scene = scene.sun.unwrap_or_else(Sun::clear_day).direction;
        let shown = SunPosition::of_direction(of_scene);
        let kept = scene.sky.as_ref().map(Sky::kind).filter(|_| self.sky.is_none());
        let kind = match &self.sky {
            Some(SkyChoice::Model(kind)) => *kind,
            _ => kept.unwrap_or_default(),
        };
        let model = DaylightModel {
            // A position from the scene needs no turning: it is measured from -Z.
            north_deg: if given.is_some() { self.north_deg } else { 0.0 },
            nits_per_unit: scene.nits_per_unit(),
            ..DaylightModel::new(kind, given.unwrap_or(shown))
        };
        let light = model.daylight();
        // Without a position that is asked for, the sun of the scene stays where one shines.
        let sun = if given.is_some() { light.sun } else { scene.sun };
        match &self.sky {
            Some(SkyChoice::Model(SkyKind::Gradient)) => (Daylight { sun, ..light }, None),
            Some(SkyChoice::Model(_)) => (light, None),
            Some(SkyChoice::None) => (Daylight { sun, sky: None }, None),
            Some(SkyChoice::Picture(path)) => match picture(path, scene.nits_per_unit()) {
                // A picture has its own sun, unless one is asked for.
                Ok(sky) => {
                    let sky = PictureSky { rotation_deg: self.north_deg as f32, ..sky };
                    (
                        Daylight { sun: light.sun.filter(|_| given.is_some()), sky: Some(Sky::Picture(sky)) },
                        None,
                    )
                }
                Err(problem) => (unchanged(scene), Some(problem)),
            },
            None if kept == Some(SkyKind::Picture) => (Daylight { sun, sky: scene.sky.clone() }, None),
            None => (Daylight { sun, sky: light.sky.filter(|_| scene.sky.is_some()) }, None),
        }
    }
}

fn unchanged(scene: &Scene) -> Daylight {
    Daylight { sun: scene.sun, sky: scene.sky.clone() }
}

fn picture(path: &Path, nits_per_unit: f32) -> Result<PictureSky, Warning> {
    let image = load_sky(path, &Limits::default()).map_err(|error| {
        let kinds: Vec<&str> = SkyKind::MODELS.iter().map(|kind| kind.name()).collect();
        let help = if path.exists() {
            String::new()
        } else {
            format!(", or name a kind of sky: none, default, {}", kinds.join(", "))
        };
        warning("", format!("{error}{help}; the sky of the scene stays"))
    })?;
    Ok(PictureSky::new(Arc::new(image), nits_per_unit))
}

fn warning(file: &str, message: String) -> Warning {
    Warning { file: file.to_owned(), line: 0, message }
}
