//! A sky and a position of the sun that the user asks for, whatever the scene has.

use super::{options::Limits, sky_picture::load_sky};
use crate::scene::place::PlaceAndTime;
use crate::scene::solar::SunPosition;
use crate::scene::{
    Daylight, DaylightModel, NO_LIGHT, PictureSky, Scene, SceneEdit, Sky, SkyKind, Sun, Warning,
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

/// Daylight that the user asks for. The default leaves that of the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DaylightOptions {
    /// The sky.
    pub sky: Option<SkyChoice>,
    /// Place and time, from which the position of the sun follows.
    pub sun: Option<PlaceAndTime>,
    /// Angle of north from -Z towards +X in degrees, for the sun and for sky pictures.
    pub north_deg: f64,
}

impl DaylightOptions {
    /// Returns the scene in this daylight. A sky that cannot be used is a warning of the scene,
    /// which keeps its own.
    #[must_use]
    pub fn apply(&self, scene: Scene) -> Scene {
        if self.sky.is_none() && self.sun.is_none() {
            return scene;
        }
        let (daylight, problem) = self.daylight(&scene.at_full());
        let mut lit = scene.with_edit(&SceneEdit { daylight, ..scene.to_edit() });
        match problem {
            Some(problem) => lit.warnings.push(problem),
            // The light that was added for want of another is gone.
            None => lit.warnings.retain(|w| w.message != NO_LIGHT),
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
