//! The lights of two states of a scene: those that stay, and those that one of them has alone.

use crate::scene::{Light, Scene};
use std::collections::BTreeMap;

/// The lights that shadow rays find, but for the sky, which counts as smooth light.
pub(super) struct ChangedLights<'a> {
    /// Lights of both states.
    pub(super) both: Vec<&'a Light>,
    /// Lights that went, and lights that came.
    pub(super) only: [Vec<&'a Light>; 2],
}

/// The bits of the first number of a light, by which equal ones are found.
fn key_of(light: &Light) -> u32 {
    let first = match light {
        Light::Quad { corner, .. } => corner.x,
        Light::Triangles { area, .. } => *area,
        Light::Point { position, .. } => position.x,
        Light::Sun { direction, .. } => direction.x,
        Light::Sky | Light::SkySuns => 0.0,
    };
    first.to_bits()
}

impl<'a> ChangedLights<'a> {
    pub(super) fn between(states: [&'a Scene; 2]) -> Self {
        let has_same_sky = states[0].sky == states[1].sky;
        let by_key = states.map(|scene| {
            let mut lights: BTreeMap<u32, Vec<&Light>> = BTreeMap::new();
            scene.lights.iter().for_each(|light| lights.entry(key_of(light)).or_default().push(light));
            lights
        });
        let is_in = |other: usize, light: &Light| match light {
            Light::SkySuns => has_same_sky,
            light => by_key[other].get(&key_of(light)).is_some_and(|alike| alike.contains(&light)),
        };
        let direct = |state: usize| states[state].lights.iter().filter(|light| !matches!(light, Light::Sky));
        let only = [0, 1].map(|state| direct(state).filter(|light| !is_in(1 - state, light)).collect());
        Self { both: direct(0).filter(|light| is_in(1, light)).collect(), only }
    }
}
