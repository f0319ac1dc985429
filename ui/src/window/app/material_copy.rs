//! Copying the look of a surface that was picked.

use super::{Parts, change};
use crate::window::state::{Change, Dropper, copied};
use afterimage::Scene;
use afterimage::scene::{Material, MaterialId};
use glam::{Vec2, Vec3};

/// Number of places along each side of a picture at which its colour is looked up.
const PLACES: u16 = 32;

/// Copies the material of the surface that was picked, if one was.
pub(super) fn paste_picked(app: &mut Parts) {
    let Some(Dropper { into, from: Some(from) }) = app.state.selection.dropper else { return };
    app.state.selection.dropper = None;
    let (Some(document), Some(tracer)) = (&app.state.document, app.current.tracer()) else { return };
    let material = |id: MaterialId| document.scene().materials.get(id.0 as usize);
    let (Some(target), Some(source)) = (material(into), material(from)) else {
        return app.state.info("this surface has no material of the model");
    };
    let copy = copied(target, source, mean_color(tracer.scene(), source));
    let text = format!("{} looks like {}", target.name, source.name);
    let keeps = if target.diffuse_texture.is_some() { "; its picture stays" } else { "" };
    if copy != *target {
        change(app, Change::Material(into, Box::new(copy)));
    }
    app.state.info(format!("{text}{keeps}"));
}

/// Returns the diffuse reflectance of a material, the mean where a picture changes it.
fn mean_color(scene: &Scene, material: &Material) -> Vec3 {
    let Some(map) = material.diffuse_texture else { return material.diffuse };
    let at = |i: u16| (f32::from(i) + 0.5) / f32::from(PLACES);
    let places = (0..PLACES).flat_map(|y| (0..PLACES).map(move |x| Vec2::new(at(x), at(y))));
    let sum: Vec3 = places.map(|uv| map.color(&scene.textures, uv)).sum();
    material.diffuse * sum / f32::from(PLACES * PLACES)
}
