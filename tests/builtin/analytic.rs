//! The embedded scenes with known pictures.

use super::scene;
use afterimage::scene::{Light, SolidSide};
use glam::Vec3;

#[test]
fn mirrors_are_parallel_and_four_metres_apart() {
    let scene = scene("mirrors");
    let planes: Vec<f32> = (0..scene.triangles.len() as u32)
        .filter(|&t| scene.material_of(t).is_mirror())
        .map(|t| {
            let [a, b, c] = scene.corners(t);
            assert!(a.x == b.x && b.x == c.x, "a mirror is not vertical and parallel to z");
            let normal = (b - a).cross(c - a);
            let to_middle = scene.frame.scene_from_world_f64(glam::DVec3::Y).as_vec3() - a;
            assert!(normal.dot(to_middle) > 0.0, "a mirror faces away from the middle");
            a.x
        })
        .collect();
    assert_eq!(planes.len(), 4);
    let low = planes.iter().copied().fold(f32::INFINITY, f32::min);
    let high = planes.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    assert!(planes.iter().all(|&x| x == low || x == high));
    assert_eq!(f64::from(high - low) / scene.frame.units_per_metre, 4.0);
}

#[test]
fn furnace_is_closed_and_uniform() {
    let scene = scene("furnace");
    assert_eq!(scene.triangles.len(), 12);
    assert_eq!(scene.materials.len(), 1);
    let wall = &scene.materials[0];
    assert_eq!((wall.diffuse, wall.emission), (Vec3::splat(0.5), Vec3::ONE));
    assert!(matches!(&scene.lights[..], [Light::Triangles { corners, .. }] if corners.len() == 12));
    // The front of every wall faces the middle, which is the origin of the scene.
    for t in 0..12 {
        let [a, b, c] = scene.corners(t);
        assert!((b - a).cross(c - a).dot(a) < 0.0, "triangle {t}");
    }
}

#[test]
fn cornell_box_has_one_lamp_and_two_boxes() {
    let scene = scene("cornell");
    assert!(matches!(&scene.lights[..], [Light::Quad { .. }]));
    // Five walls, the lamp, and five sides of each of two boxes.
    assert_eq!(scene.triangles.len(), 2 * (5 + 1 + 2 * 5));
    assert!(!scene.features.mirror && !scene.features.glass && !scene.features.textures);
}

#[test]
fn cornell_spheres_are_a_mirror_and_solid_glass() {
    let scene = scene("cornell-glass");
    assert!(scene.features.mirror && scene.features.glass);
    let glass: Vec<SolidSide> = (0..scene.triangles.len() as u32)
        .filter(|&t| scene.material_of(t).is_glass())
        .map(|t| scene.solids[t as usize])
        .collect();
    assert_eq!(glass.len(), 5120);
    assert!(glass.iter().all(|&side| side == SolidSide::InsideBehind));
}
