//! The groups of the lights of a scene: by default sky, sun, and one for each emitting material.

use super::light_groups::{LightGroup, LightGroupKind, LightGroups, MAX_LAMP_GROUPS, NO_LIGHT_GROUP};
use super::{Light, MaterialId, Scene};
use crate::raster::color::luminance;
use std::collections::HashMap;
use std::f32::consts::PI;

/// Names of the groups that do not follow from materials.
const SKY: &str = "Sky";
const SUN: &str = "Sun";
const POINT_LIGHTS: &str = "Point lights";
const OTHER_LAMPS: &str = "Other lamps";

/// Lamps that are set together.
struct Lamps {
    name: String,
    /// Luminous flux, in any unit.
    flux: f32,
    /// Put together by the user, so it keeps a group of its own.
    is_chosen: bool,
}

/// Groups the lights of a scene. `materials` has the material of each light that is a surface.
pub(super) fn group(scene: &Scene, materials: &[Option<MaterialId>]) -> LightGroups {
    let (lamps, lamps_of_light) = lamps_of(scene, materials);
    let order = by_flux(&lamps);
    let has = |kind: fn(&Light) -> bool| scene.lights.iter().any(kind);
    let mut list = Vec::new();
    let mut add = |name: String, kind| {
        list.push(LightGroup { name, kind });
        (list.len() - 1) as u8
    };
    let sky = has(|light| matches!(light, Light::Sky | Light::SkySuns))
        .then(|| add(SKY.to_owned(), LightGroupKind::Sky));
    let sun =
        has(|light| matches!(light, Light::Sun { .. })).then(|| add(SUN.to_owned(), LightGroupKind::Sun));
    // The strongest lamps have groups of their own.
    let (mut group_of_lamps, is_crowded) = (vec![0; lamps.len()], lamps.len() > MAX_LAMP_GROUPS);
    let mut last = NO_LIGHT_GROUP;
    for (place, &at) in order.iter().enumerate() {
        let shares = is_crowded && place >= MAX_LAMP_GROUPS - 1;
        if !shares || last == NO_LIGHT_GROUP || place == MAX_LAMP_GROUPS - 1 {
            let name = if shares { OTHER_LAMPS } else { &lamps[at].name };
            last = add(name.to_owned(), LightGroupKind::Lamps);
        }
        group_of_lamps[at] = last;
    }
    let group_of = |(light, lamps): (&Light, &Option<usize>)| match light {
        Light::Sky | Light::SkySuns => sky.unwrap_or(NO_LIGHT_GROUP),
        Light::Sun { .. } => sun.unwrap_or(NO_LIGHT_GROUP),
        _ => lamps.map_or(NO_LIGHT_GROUP, |lamps| group_of_lamps[lamps]),
    };
    let of_light: Vec<u8> = scene.lights.iter().zip(&lamps_of_light).map(group_of).collect();
    let mut of_material = vec![NO_LIGHT_GROUP; scene.materials.len()];
    for (material, &group) in materials.iter().zip(&of_light) {
        if let Some(material) = material {
            of_material[material.0 as usize] = group;
        }
    }
    LightGroups { list, of_light, of_material }
}

/// Lamps by name, and those that each light belongs to.
fn lamps_of(scene: &Scene, materials: &[Option<MaterialId>]) -> (Vec<Lamps>, Vec<Option<usize>>) {
    let chosen = scene.lamp_groups.iter();
    let chosen: HashMap<&str, &str> =
        chosen.flat_map(|g| g.materials.iter().map(|m| (m.as_str(), g.name.as_str()))).collect();
    let (mut lamps, mut by_name) = (Vec::new(), HashMap::new());
    let mut lamps_of = |(index, light): (usize, &Light)| {
        let material = match light {
            Light::Quad { .. } | Light::Triangles { .. } => {
                materials.get(index).copied().flatten().map_or("", |m| &scene.materials[m.0 as usize].name)
            }
            Light::Point { .. } => POINT_LIGHTS,
            Light::Sun { .. } | Light::Sky | Light::SkySuns => return None,
        };
        let name = match chosen.get(material).copied().unwrap_or(material) {
            "" => "lamp".to_owned(),
            name if [SKY, SUN].contains(&name) => format!("{name} (lamp)"),
            name => name.to_owned(),
        };
        let at = *by_name.entry(name.clone()).or_insert_with(|| {
            lamps.push(Lamps { name, flux: 0.0, is_chosen: chosen.contains_key(material) });
            lamps.len() - 1
        });
        lamps[at].flux += flux(light);
        Some(at)
    };
    let lamps_of_light = scene.lights.iter().enumerate().map(&mut lamps_of).collect();
    (lamps, lamps_of_light)
}

/// Lamps in the order of their groups: those that were put together by the user, then the
/// strongest.
fn by_flux(lamps: &[Lamps]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..lamps.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (&lamps[a], &lamps[b]);
        b.is_chosen.cmp(&a.is_chosen).then(b.flux.total_cmp(&a.flux))
    });
    order
}

/// Number of sides of a lamp that emit.
fn sides(has_one_side: bool) -> f32 {
    if has_one_side { 1.0 } else { 2.0 }
}

/// The light that a lamp emits.
fn flux(light: &Light) -> f32 {
    match light {
        Light::Quad { edge_u, edge_v, radiance, has_one_side, .. } => {
            sides(*has_one_side) * PI * luminance(*radiance) * edge_u.cross(*edge_v).length()
        }
        Light::Triangles { area, radiance, has_one_side, .. } => {
            sides(*has_one_side) * PI * luminance(*radiance) * area
        }
        Light::Point { intensity, profile: Some(profile), .. } => {
            profile.profile().flux() * luminance(*intensity)
        }
        Light::Point { intensity, .. } => 4.0 * PI * luminance(*intensity),
        Light::Sun { .. } | Light::Sky | Light::SkySuns => 0.0,
    }
}
