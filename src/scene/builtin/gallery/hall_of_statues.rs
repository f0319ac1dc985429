//! A hall of statues for measuring: five stand before a wall in view, as many more as wanted behind the viewer.
//!
//! The view is the same whatever their number, and so is the hall's size: only the hierarchy grows.

use super::figures::Figure;
use crate::camera::Camera;
use crate::scene::builtin::shapes::Local;
use crate::scene::{Material, MaterialId, NamedView, Scene, SceneBuilder, SceneError};
use glam::{DVec3, Vec2, Vec3};

const FIGURES: [Figure; 5] = [Figure::Bust, Figure::Vase, Figure::Knot(2, 3), Figure::Ripples, Figure::Rings];

/// Half the length of the hall's sides and its height, metres.
const HALF_M: f64 = 60.0;
const HEIGHT_M: f64 = 4.0;

/// Between statues, metres.
const STEP_M: f64 = 1.6;

/// Statues of a row behind the viewer.
const ROW: usize = 60;

/// Side of a lamp, metres, and the power of all of them together, in radiance times square metres.
const LAMP_M: f64 = 0.5;
const POWER: f32 = 8.0;

/// At least so many triangles, those in view included, and so many lamps of the same power together.
///
/// # Errors
/// [`SceneError::TooLarge`] beyond what the engine's indices can name.
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
    FIGURES[number % FIGURES.len()].add_to(b, &Local::turned(place, 15.0 * (number % 24) as f64), material);
}

fn hall(b: &mut SceneBuilder, material: MaterialId) {
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x * HALF_M, y * HEIGHT_M, z * HALF_M);
    let quads = [
        [corner(-1.0, 0.0, 1.0), corner(1.0, 0.0, 1.0), corner(1.0, 0.0, -1.0), corner(-1.0, 0.0, -1.0)],
        [corner(-1.0, 1.0, -1.0), corner(1.0, 1.0, -1.0), corner(1.0, 1.0, 1.0), corner(-1.0, 1.0, 1.0)],
    ];
    quads.into_iter().for_each(|q| b.add_quad(q, Vec2::ONE, material));
    // The wall behind the statues in view.
    let wall = [[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]];
    b.add_quad(wall.map(|[x, y]| DVec3::new(x * HALF_M, y * HEIGHT_M, -6.0)), Vec2::ONE, material);
}

/// In a row over the statues in view, facing down.
fn add_lamps(b: &mut SceneBuilder, lamps: u32) {
    let radiance = POWER / (lamps.max(1) as f32 * (LAMP_M * LAMP_M) as f32);
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(radiance)));
    let half = LAMP_M / 2.0;
    for i in 0..lamps {
        let x = (f64::from(i) + 0.5) / f64::from(lamps) * 8.0 - 4.0;
        let at = |dx: f64, dz: f64| DVec3::new(x + dx * half, HEIGHT_M - 0.1, -2.0 + dz * half);
        b.add_quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)], Vec2::ONE, lamp);
    }
}
