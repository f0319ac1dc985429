//! Objects that are moved, hidden and deleted, and what undoing that leaves.

use super::rooms::{cuboid, dvec};
use afterimage::math::key::Key;
use afterimage::scene::{
    Material, ObjectEdit, ObjectEdits, ObjectKey, Scene, SceneBuilder, SceneEdit, builtin,
};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Three boxes, two of which have one name and share a vertex, on a floor that is no object.
fn boxes() -> Scene {
    let mut b = SceneBuilder::new("boxes");
    let [white, lamp] = [Material::diffuse("white", Vec3::ONE), Material::emissive("lamp", Vec3::ONE)]
        .map(|material| b.add_material(material));
    cuboid(&mut b, dvec(-4.0, -0.1, -4.0), dvec(4.0, 0.0, 4.0), white, false);
    for (name, x) in [("box", 0.0), ("lamp", 1.0), ("box", 2.0)] {
        b.begin_object(name);
        let material = if name == "lamp" { lamp } else { white };
        cuboid(&mut b, dvec(x, 0.0, 0.0), dvec(x + 0.5, 0.5, 0.5), material, false);
    }
    let shared = b.triangles[b.triangles.len() - 1][0];
    b.end_object();
    let [p, q] =
        [dvec(3.0, 0.0, 0.0), dvec(3.0, 1.0, 0.0)].map(|p| b.add_vertex(p, Vec3::ZERO, glam::Vec2::ZERO));
    b.add_triangle([shared, p, q], white);
    b.finish().unwrap()
}

fn key(name: &str, number: u32) -> ObjectKey {
    ObjectKey { name: name.to_owned(), number }
}

fn with(scene: &Scene, objects: ObjectEdits) -> Scene {
    scene.with_edit(&SceneEdit { objects, ..scene.to_edit() })
}

fn random_edits(scene: &Scene, seed: u64) -> ObjectEdits {
    let number = |k: u32| Key::of_pixel(seed, k).pair()[0];
    let keys = scene.all_objects().keys().iter().enumerate();
    keys.filter_map(|(i, key)| {
        let first = 10 * i as u32;
        let way = |k: u32| f64::from(number(first + k)) * 2.0 - 1.0;
        let moved_m = dvec(way(0), way(1), way(2));
        let edit = match (number(first + 3) * 6.0) as u32 {
            0 => return None,
            1 => ObjectEdit { is_hidden: true, ..ObjectEdit::default() },
            2 => ObjectEdit { is_deleted: true, moved_m, ..ObjectEdit::default() },
            3 => ObjectEdit { turned_deg: 90.0 * way(4), moved_m, ..ObjectEdit::default() },
            _ => ObjectEdit { moved_m, ..ObjectEdit::default() },
        };
        Some((key.clone(), edit))
    })
    .collect()
}

#[test]
fn whatever_is_done_undoing_it_brings_back_the_very_bits() {
    for scene in [boxes(), builtin::build("cornell").unwrap(), builtin::build("cornell-glass").unwrap()] {
        let original = scene.to_edit();
        let (mut now, mut last) = (scene.clone(), ObjectEdits::new());
        for seed in 0..40 {
            last = random_edits(&scene, seed);
            now = with(&now, last.clone());
            assert_eq!(now.object_edits(), last, "seed {seed}");
            // The way there does not matter.
            let straight = with(&scene, last.clone());
            assert_eq!(now.hash, straight.hash, "seed {seed}");
            assert_eq!((&now.objects, &now.hidden), (&straight.objects, &straight.hidden));
            assert_eq!(now.with_edit(&now.to_edit()).hash, now.hash);
            assert_eq!(now.frame, scene.frame);
            let back = now.with_edit(&original);
            assert!(back.has_same_geometry(&scene) && back.edited_objects.is_none(), "seed {seed}");
            assert_eq!((&back.hash, &back.hidden, &back.solids), (&scene.hash, &scene.hidden, &scene.solids));
            assert!(Arc::ptr_eq(&back.objects, &scene.objects) && back.lights == scene.lights);
        }
        assert!(!last.is_empty());
    }
}

#[test]
fn an_object_moves_alone_and_takes_its_lamp_along() {
    let scene = boxes();
    let way = dvec(0.0, 0.25, -1.5);
    let edit = ObjectEdit { moved_m: way, ..ObjectEdit::default() };
    let moved = with(&scene, [(key("box", 2), edit), (key("lamp", 1), edit)].into());
    assert_eq!(moved.triangles.len(), scene.triangles.len());
    let shift = (way * scene.frame.units_per_metre).as_vec3();
    for t in 0..scene.triangles.len() as u32 {
        let object = scene.object_of(t);
        assert_eq!(object, moved.object_of(t));
        let is_moved = object.is_some_and(|object| *object != key("box", 1));
        let expected = scene.corners(t).map(|p| if is_moved { p + shift } else { p });
        assert_eq!(moved.corners(t), expected, "triangle {t}");
    }
    assert_ne!(moved.lights, scene.lights);
    assert_eq!(scene.middle_of_object(&key("box", 1)).unwrap(), dvec(0.25, 0.25, 0.25));
    // Four quarter turns lead back but for rounding, and one turns it about its middle.
    let turned = |turned_deg: f64| {
        with(&scene, [(key("box", 1), ObjectEdit { turned_deg, ..ObjectEdit::default() })].into())
    };
    for t in 0..scene.triangles.len() as u32 {
        let [a, b] = [scene.corners(t), turned(360.0).corners(t)];
        assert!((0..3).all(|k| a[k].distance(b[k]) < 1e-3));
    }
    let quarter = turned(90.0);
    let highest = |scene: &Scene| {
        let of = (0..scene.triangles.len() as u32).filter(|&t| scene.object_of(t) == Some(&key("box", 1)));
        of.flat_map(|t| scene.corners(t)).fold(Vec3::NEG_INFINITY, Vec3::max)
    };
    assert!(highest(&quarter).distance(highest(&scene)) < 1e-3);
}

#[test]
fn what_is_hidden_is_gone_and_something_is_always_left() {
    let scene = boxes();
    let hidden = ObjectEdit { is_hidden: true, ..ObjectEdit::default() };
    let without = with(&scene, [(key("lamp", 1), hidden)].into());
    assert_eq!(without.triangles.len() + 12, scene.triangles.len());
    assert!(without.lights.iter().all(|light| !scene.lights[..1].contains(light)));
    assert!((0..without.triangles.len() as u32).all(|t| without.object_of(t) != Some(&key("lamp", 1))));
    assert_eq!(without.all_objects().keys().len(), 3);
    let mut builder = SceneBuilder::new("one");
    builder.begin_object("all");
    let white = builder.add_material(Material::diffuse("white", Vec3::ONE));
    cuboid(&mut builder, DVec3::ZERO, DVec3::ONE, white, false);
    let one = builder.finish().unwrap();
    let still = with(&one, [(key("all", 1), hidden)].into());
    assert!(still.has_same_geometry(&one) && still.object_edits().is_empty());
}

#[test]
fn hostile_numbers_and_unknown_objects_change_nothing() {
    let scene = boxes();
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 1e9] {
        for moved_m in [dvec(number, 0.0, 0.0), dvec(0.0, 0.0, number)] {
            let edit = ObjectEdit { moved_m, ..ObjectEdit::default() };
            assert!(!edit.is_possible(scene.bounds_m));
            assert!(with(&scene, [(key("box", 1), edit)].into()).has_same_geometry(&scene));
        }
    }
    let turned = ObjectEdit { turned_deg: f64::NAN, ..ObjectEdit::default() };
    let hidden = ObjectEdit { is_hidden: true, ..ObjectEdit::default() };
    for edits in [(key("box", 1), turned), (key("box", 3), hidden), (key("Box", 1), hidden)] {
        assert!(with(&scene, [edits].into()).has_same_geometry(&scene));
    }
}
