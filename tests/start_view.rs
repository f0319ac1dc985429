//! The start view of models that bring none.

use crate::rooms::{cuboid, dvec, quad};
use afterimage::scene::{Material, MaterialId, Scene, SceneBuilder, shapes};
use afterimage::{Camera, Tracer};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// A box from a lower to an upper corner, and whether its faces look in.
type Shell = ([f64; 3], [f64; 3], bool);

/// The scene that `fill` makes, with its start view.
fn traced(fill: impl Fn(&mut SceneBuilder, MaterialId)) -> Tracer {
    let mut b = SceneBuilder::new("rooms");
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.5)));
    fill(&mut b, wall);
    Tracer::new(Arc::new(b.finish().unwrap())).with_start_view()
}

/// The scene of some boxes, perhaps lit by a lamp, with its start view.
fn started(shells: &[Shell], lamp: Option<DVec3>) -> Arc<Scene> {
    let tracer = traced(|b, wall| {
        b.point_lights.extend(lamp.map(|at| (at, Vec3::ONE)));
        for &(low, high, looks_in) in shells {
            cuboid(b, low.into(), high.into(), wall, looks_in);
        }
    });
    tracer.scene().clone()
}

#[test]
fn a_model_of_rooms_starts_in_the_larger_room_and_looks_along_it() {
    let rooms = [([0.0, 0.0, 0.0], [4.0, 3.0, 4.0], true), ([4.5, 0.0, 0.0], [20.0, 3.0, 6.0], true)];
    let rooms = started(&rooms, None);
    let start = rooms.start();
    assert!((4.5..20.0).contains(&start.eye.x), "{start:?}");
    assert!((start.eye.y - Camera::EYE_HEIGHT_M).abs() < 1e-6, "{start:?}");
    assert!(start.forward().x.abs() > 0.9, "{start:?}");
    assert_eq!(rooms.views.iter().map(|v| v.name.as_str()).collect::<Vec<_>>(), ["start", "outside"]);
    assert!(rooms.walk.keyframes.iter().all(|key| key.eye == start.eye));
}

#[test]
fn a_house_is_first_seen_from_outside_where_light_falls_there() {
    let house = [([0.0, 0.0, 0.0], [9.0, 4.0, 9.0], false), ([0.3, 0.1, 0.3], [8.7, 3.7, 8.7], true)];
    let by_day = started(&house, None);
    assert!(by_day.views.len() == 1 && by_day.start().eye.y > 4.0);
    let by_lamp = started(&house, Some(dvec(4.0, 3.0, 4.0)));
    assert!((by_lamp.start().eye.y - 1.7).abs() < 1e-6);
    assert_eq!(by_lamp.views.len(), 1, "outside it is black");
}

#[test]
fn a_solid_turned_inside_out_has_no_room_to_start_in() {
    let low = started(&[([0.0; 3], [5.0, 1.5, 5.0], true)], None);
    assert_eq!(low.views.len(), 1, "the ceiling is too low to stand under");
}

/// A classroom of 9 x 3 x 7 m, its faces inwards, with two windows in a wall, a board and twelve
/// desks with chairs.
fn classroom(b: &mut SceneBuilder, m: MaterialId) {
    let [low, high] = [DVec3::ZERO, dvec(9.0, 3.0, 7.0)];
    let size = high - low;
    quad(b, low, DVec3::Z * size.z, DVec3::X * size.x, m);
    quad(b, high, DVec3::X * -size.x, DVec3::Z * -size.z, m);
    quad(b, low, DVec3::X * size.x, DVec3::Y * size.y, m);
    quad(b, low, DVec3::Y * size.y, DVec3::Z * size.z, m);
    quad(b, dvec(9.0, 0.0, 0.0), DVec3::Z * size.z, DVec3::Y * size.y, m);
    // The wall at z = 7 m in strips around two windows.
    for [x0, y0, x1, y1] in [
        [0.0, 0.0, 9.0, 0.9],
        [0.0, 2.4, 9.0, 3.0],
        [0.0, 0.9, 1.0, 2.4],
        [3.5, 0.9, 5.5, 2.4],
        [8.0, 0.9, 9.0, 2.4],
    ] {
        b.add_quad(
            [dvec(x0, y0, 7.0), dvec(x0, y1, 7.0), dvec(x1, y1, 7.0), dvec(x1, y0, 7.0)],
            Vec2::ONE,
            m,
        );
    }
    quad(b, dvec(0.02, 1.0, 2.0), DVec3::Y, DVec3::Z * 3.0, m);
    for i in 0..12 {
        let at = dvec(2.5 + 1.5 * f64::from(i % 4), 0.0, 1.2 + 2.0 * f64::from(i / 4));
        cuboid(b, at + DVec3::Y * 0.7, at + dvec(0.6, 0.75, 1.2), m, false);
        cuboid(b, at + dvec(0.8, 0.0, 0.4), at + dvec(1.2, 0.45, 0.8), m, false);
    }
}

/// The classroom as a building: with outer walls and a roof, so that from outside it shows fronts.
fn schoolhouse(b: &mut SceneBuilder, m: MaterialId) {
    classroom(b, m);
    cuboid(b, dvec(-0.3, -0.2, -0.3), dvec(9.3, 3.3, 7.3), m, false);
}

fn ground(b: &mut SceneBuilder, m: MaterialId, side: f64, y: f64) {
    quad(b, dvec(4.5 - side / 2.0, y, 3.5 - side / 2.0), DVec3::Z * side, DVec3::X * side, m);
}

/// Largest difference of two start views: of the eyes in metres, and of the directions.
fn difference(a: &Tracer, b: &Tracer) -> f64 {
    let [a, b] = [a, b].map(|t| *t.scene().start());
    a.eye.distance(b.eye).max(a.forward().distance(b.forward()))
}

/// Models with the same building: alone, on ground of several sizes, and with far objects.
fn surrounded(building: fn(&mut SceneBuilder, MaterialId)) -> Vec<(String, Tracer)> {
    let mut models = vec![("alone".to_owned(), traced(building))];
    for side in [12.0, 45.0, 221.0, 5000.0] {
        for y in [0.0, -0.05] {
            let model = traced(|b, m| (building(b, m), ground(b, m, side, y)).0);
            models.push((format!("on {side} m of ground at {y}"), model));
        }
    }
    for distance in [60.0, 800.0] {
        let model = traced(|b, m| {
            building(b, m);
            for at in [[1.0, 0.0, 0.2], [-0.8, 0.3, 0.5], [0.1, 0.0, -1.0]] {
                shapes::sphere(b, DVec3::from(at) * distance, 1.0, 12, true, m);
            }
        });
        models.push((format!("with objects at {distance} m"), model));
    }
    models
}

#[test]
fn ground_and_far_objects_do_not_move_the_start_view() {
    for building in [classroom, schoolhouse] {
        let models = surrounded(building);
        let (_, alone) = &models[0];
        for (name, model) in &models {
            let [scene, expected] = [model, alone].map(|t| t.scene());
            assert_eq!(scene.building_m, expected.building_m, "{name}");
            assert_eq!(scene.views.len(), expected.views.len(), "{name}");
            // Scene space is coarser where the model is larger.
            let [low, high] = scene.bounds_m;
            let tolerance = 1e-6 * low.distance(high);
            assert!(difference(model, alone) <= tolerance, "{name}: {}", difference(model, alone));
            assert!(model.building_share(scene.start()) >= 0.3, "{name}");
        }
    }
}

#[test]
fn a_classroom_on_a_wide_plane_opens_inside() {
    let model = traced(|b, m| (classroom(b, m), ground(b, m, 221.0, -0.01)).0);
    let eye = model.scene().start().eye;
    assert!(eye.cmpgt(DVec3::ZERO).all() && eye.cmplt(dvec(9.0, 3.0, 7.0)).all(), "{eye}");
    assert!(model.building_share(model.scene().start()) > 0.8);
}

#[test]
fn a_room_without_a_floor_is_entered_with_and_without_ground() {
    let walls = |b: &mut SceneBuilder, m| {
        quad(b, dvec(6.0, 3.0, 5.0), DVec3::X * -6.0, DVec3::Z * -5.0, m);
        quad(b, DVec3::ZERO, DVec3::X * 6.0, DVec3::Y * 3.0, m);
        quad(b, dvec(0.0, 0.0, 5.0), DVec3::Y * 3.0, DVec3::X * 6.0, m);
        quad(b, DVec3::ZERO, DVec3::Y * 3.0, DVec3::Z * 5.0, m);
        quad(b, dvec(6.0, 0.0, 0.0), DVec3::Z * 5.0, DVec3::Y * 3.0, m);
    };
    let [without, with] = [
        traced(walls),
        traced(|b, m| {
            (walls(b, m), quad(b, dvec(-50.0, 0.0, -50.0), DVec3::Z * 100.0, DVec3::X * 100.0, m)).0
        }),
    ];
    assert_eq!(without.scene().views.len(), 2);
    assert!(difference(&without, &with) < 1e-4);
}

#[test]
fn models_without_rooms_have_a_view_that_shows_them() {
    let triangle = traced(|b, m| {
        let v = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| b.add_vertex(p, Vec3::ZERO, Vec2::ZERO));
        b.add_triangle(v, m);
    });
    let plane = traced(|b, m| ground(b, m, 50.0, 0.0));
    let block = traced(|b, m| cuboid(b, DVec3::ZERO, dvec(12.0, 20.0, 9.0), m, false));
    let terrain = traced(|b, m| {
        let height = |i: i32, j: i32| 6.0 * (f64::from(i) / 4.0).sin() * (f64::from(j) / 5.0).cos();
        let point = |i: i32, j: i32| dvec(f64::from(i) * 5.0, height(i, j), f64::from(j) * 5.0);
        for (i, j) in (0..40 * 40).map(|k| (k % 40, k / 40)) {
            b.add_quad([point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)], Vec2::ONE, m);
        }
    });
    for (name, model) in [("triangle", triangle), ("plane", plane), ("block", block), ("terrain", terrain)] {
        let share = model.building_share(model.scene().start());
        assert!(share >= 0.3 || name == "triangle" && share > 0.1, "{name}: {share}");
    }
}

#[test]
fn a_view_and_a_path_that_the_model_brings_stay() {
    let own = Camera::look_at(dvec(1.0, 2.0, 30.0), DVec3::ZERO, 40.0);
    let model = traced(|b, m| {
        schoolhouse(b, m);
        b.views.push(afterimage::scene::NamedView { name: "own".to_owned(), camera: own });
    });
    assert_eq!((model.scene().views.len(), *model.scene().start()), (1, own));
    let walk = afterimage::camera::CameraPath::still(&own);
    let model = traced(|b, m| (classroom(b, m), b.walk = Some(walk.clone())).0);
    assert_eq!(model.scene().walk, walk);
}
