//! `[ground]` of a sidecar: a level ground below the model, or `off` for none.

use super::table::{Notes, Section};
use crate::scene::{Ground, Scene, SceneEdit};

/// Keys of `[ground]`.
pub(super) const GROUND_KEYS: [&str; 3] = ["height_m", "albedo", "off"];

/// Largest height in metres, up or down.
const MAX_HEIGHT_M: f64 = 1e6;

/// What a sidecar says of the ground. A height that is not given is that of the model's lowest
/// point.
#[derive(Clone, Copy, Debug)]
pub(super) struct GroundLine {
    height_m: Option<f64>,
    albedo: Option<f32>,
    is_off: bool,
}

pub(super) fn read(top: &Section, notes: &mut Notes) -> Option<GroundLine> {
    let section = top.section("ground", "[ground]", &GROUND_KEYS, notes)?;
    let [least, most] = [*Ground::ALBEDOS.start(), *Ground::ALBEDOS.end()].map(f64::from);
    Some(GroundLine {
        height_m: section.number("height_m", -MAX_HEIGHT_M..=MAX_HEIGHT_M, notes),
        albedo: section.number("albedo", least..=(most * 10.0).round() / 10.0, notes).map(|a| a as f32),
        is_off: section.flag("off", notes).unwrap_or(false),
    })
}

impl GroundLine {
    /// Returns the ground of a scene; `None` for none.
    pub(super) fn ground(&self, scene: &Scene) -> Option<Ground> {
        let lowest = scene.lowest_ground();
        (!self.is_off).then(|| Ground {
            height_m: self.height_m.unwrap_or(lowest.height_m),
            albedo: self.albedo.unwrap_or(lowest.albedo),
        })
    }
}

/// Adds the ground to the scene.
pub(super) fn apply(line: Option<GroundLine>, scene: Scene) -> Scene {
    let Some(line) = line else { return scene };
    let ground = line.ground(&scene);
    let mut scene = scene.with_edit(&SceneEdit { ground, ..scene.to_edit() });
    scene.is_ground_given = true;
    scene
}
