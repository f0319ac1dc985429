//! Faces in one place: each side of a wall shows its own material.

use afterimage::camera::{Camera, View};
use afterimage::math::Ray;
use afterimage::render::WalkthroughSettings;
use afterimage::scene::{Material, MaterialId, MaterialKind, SceneBuilder};
use afterimage::trace::parallel::NEVER;
use afterimage::{Mode, Tracer, Walkthrough};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// How the second side of the wall is cut.
#[derive(Clone, Copy, Debug)]
enum Cut {
    Alike,
    Otherwise,
}

/// A slanted wall with a face for each side, and a floor that goes on behind it.
fn wall(cut: Cut, is_later_first: bool) -> (Tracer, [DVec3; 4]) {
    let mut b = SceneBuilder::new("wall");
    let brick = b.add_material(Material::diffuse("brick", Vec3::new(0.6, 0.2, 0.1)));
    let plaster = b.add_material(Material::diffuse("plaster", Vec3::splat(0.8)));
    let (corner, u, v) =
        (DVec3::new(-1.1, -0.9, 0.07), DVec3::new(2.03, 0.31, 0.17), DVec3::new(-0.23, 1.87, 0.41));
    let p = [corner, corner + u, corner + u + v, corner + v];
    let v: Vec<u32> = p.iter().map(|p| b.add_vertex(*p, Vec3::ZERO, Vec2::ZERO)).collect();
    let mut add = |t: [usize; 3], m: MaterialId| b.add_triangle(t.map(|i| v[i]), m);
    let inside = match cut {
        Cut::Alike => [[2, 1, 0], [3, 2, 0]],
        Cut::Otherwise => [[3, 2, 1], [3, 1, 0]],
    };
    if is_later_first {
        inside.into_iter().for_each(|t| add(t, plaster));
    }
    [[0, 1, 2], [0, 2, 3]].into_iter().for_each(|t| add(t, brick));
    if !is_later_first {
        inside.into_iter().for_each(|t| add(t, plaster));
    }
    (Tracer::new(Arc::new(b.finish().unwrap())), p)
}

fn name(tracer: &Tracer, triangle: u32) -> &str {
    &tracer.scene().material_of(triangle).name
}

#[test]
fn each_side_of_a_wall_shows_its_own_material() {
    for (cut, is_later_first) in
        [(Cut::Alike, false), (Cut::Alike, true), (Cut::Otherwise, false), (Cut::Otherwise, true)]
    {
        let (tracer, [a, b, _, d]) = wall(cut, is_later_first);
        assert!(tracer.scene().features.coincident && tracer.scene().hidden.is_empty());
        let normal = (b - a).cross(d - a).normalize_or_zero();
        let frame = tracer.scene().frame;
        // Also corners, edges and diagonals are met.
        for i in 0..=32 {
            for j in 0..=32 {
                let at = a + (b - a) * (f64::from(i) / 32.0) + (d - a) * (f64::from(j) / 32.0);
                for (side, expected) in [(1.0, "brick"), (-1.0, "plaster")] {
                    let eye = at + (normal * 2.0 + (b - a) * 0.7) * side;
                    let [eye, at] = [eye, at].map(|p| frame.scene_from_world_f64(p).as_vec3());
                    if let Some(hit) = tracer.closest(&Ray::new(eye, at - eye)) {
                        assert_eq!(name(&tracer, hit.triangle), expected, "{cut:?}, {i}, {j}");
                    } else {
                        assert!(i % 32 == 0 || j % 32 == 0, "a hole at {i}, {j}");
                    }
                }
            }
        }
    }
}

#[test]
fn every_mode_shows_the_same_side() {
    for cut in [Cut::Alike, Cut::Otherwise] {
        let (tracer, [a, b, c, d]) = wall(cut, true);
        let (middle, normal) = ((a + c) / 2.0, (b - a).cross(d - a).normalize_or_zero());
        let tracer = Arc::new(tracer);
        for (side, expected) in [(2.5, "brick"), (-2.5, "plaster")] {
            let camera = Camera::look_at(middle + normal * side, middle, 50.0);
            for mode in [Mode::Full, Mode::Exact, Mode::Fast, Mode::Paper] {
                let mut settings = WalkthroughSettings::default();
                settings.render.mode = mode;
                let mut walk = Walkthrough::new(tracer.clone(), settings);
                for _ in 0..2 {
                    let frame = walk.render(&camera, [70, 50], NEVER);
                    let mut seen = frame.triangle.iter().filter(|t| (**t as usize) < 4);
                    assert!(seen.clone().count() > 500);
                    assert!(seen.all(|t| name(&tracer, *t) == expected), "{mode:?}");
                }
            }
            let view = View::new(&camera, &tracer.scene().frame, [70, 50]);
            let rays = (0..70 * 50).map(|pixel| Tracer::primary_ray(&view, pixel));
            assert!(rays.filter_map(|ray| tracer.closest(&ray)).count() > 500);
        }
    }
}

#[test]
fn surfaces_apart_or_of_one_material_are_not_compared() {
    let built = |lift: f64, is_same: bool| {
        let mut b = SceneBuilder::new("two");
        let first = b.add_material(Material::diffuse("first", Vec3::splat(0.5)));
        let other = b.add_material(Material::diffuse("other", Vec3::splat(0.4)));
        let quad =
            |y: f64| [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]].map(|[x, z]| DVec3::new(x, y, z));
        b.add_quad(quad(0.0), Vec2::ONE, first);
        let mut reversed = quad(lift);
        reversed.reverse();
        b.add_quad(reversed, Vec2::ONE, if is_same { first } else { other });
        b.finish().unwrap()
    };
    assert!(built(0.0, false).features.coincident);
    assert!(!built(1e-4, false).features.coincident, "0.1 mm apart");
    assert!(!built(0.0, true).features.coincident, "one material");
}

/// Only opaque faces are marked, so an edit that makes one opaque marks it.
#[test]
fn faces_in_one_place_are_found_again_after_an_edit_of_materials() {
    let (tracer, _) = wall(Cut::Alike, false);
    let opaque = tracer.scene();
    let mut edit = opaque.to_edit();
    let plaster = edit.materials[1].clone();
    edit.materials[1].kind = MaterialKind::Glass { eta: 1.5, transmittance: Vec3::splat(0.1) };
    let glass = opaque.with_edit(&edit);
    assert!(opaque.features.coincident && !glass.features.coincident);
    edit.materials[1] = plaster;
    assert_eq!(glass.with_edit(&edit).coincident, opaque.coincident);
}
