//! A hall of statues for measurements: five stand in view in front of a wall, any number behind the
//! viewer.
//!
//! The view and the size of the hall do not depend on the number of statues: only the BVH grows.

use super::parts::{Figure, bust, knot, rings, ripples, vase};
use super::shapes::{Local, ceiling, floor};
use crate::camera::Camera;
use crate::scene::{Material, MaterialId, NamedView, Scene, SceneBuilder, SceneError};
use glam::{DVec3, Vec2, Vec3};

const FIGURES: [Figure; 5] = [bust, vase, knot::<2, 3>, ripples, rings];

/// Half the side length of the hall in metres.
const HALF_M: f64 = 60.0;
/// Height of the hall in metres.
const HEIGHT_M: f64 = 4.0;

/// Distance between statues in metres.
const STEP_M: f64 = 1.6;

/// Number of statues in a row behind the viewer.
const ROW: usize = 60;

/// Side length of a lamp in metres.
const LAMP_M: f64 = 0.5;
/// Power of all lamps together, in radiance times square metres.
const POWER: f32 = 8.0;

/// Builds a hall of at least `triangles` triangles and with `lamps` lamps, whose total power is
/// always the same.
///
/// # Errors
/// [`SceneError::TooLarge`] if the engine cannot address that many triangles.
pub fn statue_hall(triangles: usize, lamps: u32) -> Result<Scene, SceneError> {
    let mut b = SceneBuilder::new("statue hall");
    let stone = b.add_material(Material::diffuse("stone", Vec3::new(0.72, 0.7, 0.66)));
    hall(&mut b, stone);
    add_lamps(&mut b, lamps);
    for i in 0..FIGURES.len() {
        statue(&mut b, i, DVec3::new((i as f64 - 2.0) * STEP_M, 0.7, -4.0), stone);
    }
    let mut number = 0;
    while b.triangles.len() < triangles {
        let (column, row) = ((number % ROW) as f64, (number / ROW) as f64);
        let place = DVec3::new((column - ROW as f64 / 2.0) * STEP_M, 0.7, 3.0 + row * STEP_M);
        statue(&mut b, number, place, stone);
        number += 1;
    }
    let camera = Camera::look_at(DVec3::new(0.0, 1.6, 0.5), DVec3::new(0.0, 1.1, -4.0), 60.0);
    b.views.push(NamedView { name: "start".to_owned(), camera });
    b.finish()
}

fn statue(b: &mut SceneBuilder, number: usize, place: DVec3, material: MaterialId) {
    FIGURES[number % FIGURES.len()](b, &Local::turned(place, 15.0 * (number % 24) as f64), material);
}

fn hall(b: &mut SceneBuilder, material: MaterialId) {
    let area = [-HALF_M, HALF_M, -HALF_M, HALF_M];
    floor(b, area, 0.0, material);
    ceiling(b, area, HEIGHT_M, material);
    // Wall behind the statues in view.
    let wall = [[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]];
    b.add_quad(wall.map(|[x, y]| DVec3::new(x * HALF_M, y * HEIGHT_M, -6.0)), Vec2::ONE, material);
}

/// Adds a row of lamps that face down over the statues in view.
fn add_lamps(b: &mut SceneBuilder, lamps: u32) {
    let radiance = POWER / (lamps.max(1) as f32 * (LAMP_M * LAMP_M) as f32);
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(radiance)));
    let half = LAMP_M / 2.0;
    for i in 0..lamps {
        let x = (f64::from(i) + 0.5) / f64::from(lamps) * 8.0 - 4.0;
        ceiling(b, [x - half, x + half, -2.0 - half, -2.0 + half], HEIGHT_M - 0.1, lamp);
    }
}
