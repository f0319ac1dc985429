//! `[[point_light]]` of a sidecar: lamps by intensity, in photometric units, or by an IES profile.

use super::table::{Notes, Section};
use crate::import::ies::{self, IesFile};
use crate::import::{options::Limits, search::Finder};
use crate::scene::{AimedProfile, LightProfile, ProfileLight, SceneBuilder};
use glam::{DVec3, Vec3};
use std::{collections::HashMap, f32::consts::PI, sync::Arc};

/// Keys of `[[point_light]]`.
const KEYS: [&str; 9] =
    ["position_m", "intensity", "candela", "lumens", "ies", "color", "factor", "aim", "front"];

const NEEDS: &str = "[[point_light]] needs position_m and one of intensity, candela, lumens and ies; \
                     it was ignored";

/// A lamp of the file.
#[derive(Debug)]
pub(super) struct Lamp {
    /// Line of the file, for messages.
    line: u64,
    position_m: DVec3,
    strength: Strength,
    color: Vec3,
    /// Name of its profile, and the directions of its aim and its front.
    profile: Option<(String, [Vec3; 2])>,
}

/// Brightness of a `[[point_light]]`, by the one of its keys that gives it.
#[derive(Clone, Copy, Debug)]
enum Strength {
    /// Intensity in radiance times square metres.
    Intensity(Vec3),
    /// Largest intensity in candela.
    Candela(f32),
    /// Luminous flux.
    Lumens(f32),
    /// A factor of what the profile says.
    Profile(f32),
}

/// A profile and its largest intensity in candela; `None` where it could not be read.
type Loaded = Option<(Arc<LightProfile>, f64)>;

/// Reads the lamps of a file.
pub(super) fn read(top: &Section, notes: &mut Notes) -> Vec<Lamp> {
    let sections = top.sections("point_light", "[[point_light]]", &KEYS, notes);
    sections.iter().filter_map(|s| lamp(s, notes)).collect()
}

fn lamp(s: &Section, notes: &mut Notes) -> Option<Lamp> {
    let position_m = s.point("position_m", notes);
    let strength = strength(s, notes);
    let (Some(position_m), Some(strength)) = (position_m, strength) else {
        notes.add(s.at(), NEEDS.to_owned());
        return None;
    };
    let mut direction = |key: &str, or: Vec3| match s.point(key, notes) {
        None => or,
        Some(given) => given.try_normalize().map_or_else(
            || {
                notes.add(s.at(), format!("'{key}' in [[point_light]] has no length; the default is used"));
                or
            },
            |unit| unit.as_vec3(),
        ),
    };
    let axes = [direction("aim", Vec3::NEG_Y), direction("front", Vec3::X)];
    let profile = s.text("ies", notes).map(|name| (name.to_owned(), axes));
    let color = s.color("color", 1.0, notes).unwrap_or(Vec3::ONE);
    Some(Lamp { line: notes.line(s.at()), position_m, strength, color, profile })
}

/// The one strength that a lamp gives.
fn strength(s: &Section, notes: &mut Notes) -> Option<Strength> {
    let range = 0.0..=f64::from(Limits::RADIANCE);
    let intensity = s.color("intensity", Limits::RADIANCE, notes).map(Strength::Intensity);
    let mut number = |key: &str| s.number(key, range.clone(), notes).map(|n| n as f32);
    let candela = number("candela").map(Strength::Candela);
    let lumens = number("lumens").map(Strength::Lumens);
    let factor = number("factor");
    let profile = s.text("ies", notes).map(|_| Strength::Profile(factor.unwrap_or(1.0)));
    let given: Vec<Strength> = [intensity, candela, lumens].into_iter().flatten().collect();
    if factor.is_some() && (profile.is_none() || !given.is_empty()) {
        let cause = "'factor' in [[point_light]] has no effect; it multiplies the candela of 'ies' alone";
        notes.add(s.at(), cause.to_owned());
    }
    match (given.as_slice(), profile) {
        ([one], _) => Some(*one),
        ([], profile) => profile,
        _ => None,
    }
}

/// Adds the lamps of a file, whose photometric units become those of the model.
pub(super) fn apply(lamps: Vec<Lamp>, file_name: &str, finder: &mut Finder, builder: &mut SceneBuilder) {
    let mut loaded: HashMap<String, Loaded> = HashMap::new();
    for lamp in lamps {
        let Some((name, axes)) = &lamp.profile else {
            let intensity = lamp.intensity(None, builder.nits_per_unit());
            builder.point_lights.push((lamp.position_m, intensity));
            continue;
        };
        if !loaded.contains_key(name) {
            let profile = load(name, (file_name, lamp.line), finder, builder);
            loaded.insert(name.clone(), profile);
        }
        let Some(Some((profile, candela))) = loaded.get(name) else { continue };
        let intensity = lamp.intensity(Some((profile, *candela)), builder.nits_per_unit());
        let profile = AimedProfile::new(profile.clone(), axes[0], axes[1]);
        builder.profile_lights.push(ProfileLight { position_m: lamp.position_m, intensity, profile });
    }
}

impl Lamp {
    /// Largest intensity in radiance times square metres, of a lamp with or without a profile and
    /// its candela.
    fn intensity(&self, profile: Option<(&LightProfile, f64)>, nits_per_unit: f32) -> Vec3 {
        let flux = profile.map_or(4.0 * PI, |(profile, _)| profile.flux());
        let candela = match self.strength {
            Strength::Intensity(intensity) => return intensity * self.color,
            Strength::Candela(candela) => candela,
            Strength::Lumens(lumens) => lumens / flux.max(f32::MIN_POSITIVE),
            Strength::Profile(factor) => factor * profile.map_or(0.0, |(_, candela)| candela as f32),
        };
        self.color * (candela / nits_per_unit)
    }
}

/// Reads a profile that the file at a line names. Where it cannot be read, its lamps are left out
/// with a warning.
fn load(
    name: &str,
    (file_name, line): (&str, u64),
    finder: &mut Finder,
    builder: &mut SceneBuilder,
) -> Loaded {
    match ies::load(name, finder) {
        Ok(IesFile { profile, candela, note }) => {
            if let Some(note) = note {
                builder.warn(file_name, line, format!("the light profile '{name}': {note}"));
            }
            Some((Arc::new(profile), candela))
        }
        Err(cause) => {
            let message = format!("the lamps with the light profile '{name}' are left out: {cause}");
            builder.warn(file_name, line, message);
            None
        }
    }
}
