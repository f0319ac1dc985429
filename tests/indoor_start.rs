//! The start view of models that bring none.

use crate::rooms::{cuboid, dvec};
use afterimage::scene::{Material, Scene, SceneBuilder};
use afterimage::{Camera, Tracer};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// A box from a lower to an upper corner, and whether its faces look in.
type Shell = ([f64; 3], [f64; 3], bool);

/// The scene of some boxes, perhaps lit by a lamp, with its start view.
fn started(shells: &[Shell], lamp: Option<DVec3>) -> Arc<Scene> {
    let mut b = SceneBuilder::new("rooms");
    b.point_lights.extend(lamp.map(|at| (at, Vec3::ONE)));
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.5)));
    for &(low, high, looks_in) in shells {
        cuboid(&mut b, low.into(), high.into(), wall, looks_in);
    }
    Tracer::new(Arc::new(b.finish().unwrap())).beginning_indoors().scene().clone()
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
    assert!(by_lamp.views.len() == 2 && (by_lamp.start().eye.y - 1.7).abs() < 1e-6);
}

#[test]
fn a_solid_turned_inside_out_has_no_room_to_start_in() {
    let low = started(&[([0.0; 3], [5.0, 1.5, 5.0], true)], None);
    assert_eq!(low.views.len(), 1, "the ceiling is too low to stand under");
}
