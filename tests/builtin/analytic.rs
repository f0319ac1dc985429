//! Scenes whose pictures are known.

use super::scene;
use afterimage::scene::{Light, MaterialKind, SolidSide};
use glam::Vec3;

#[test]
fn mirrors_are_parallel_and_four_metres_apart() {
    let scene = scene("mirrors");
    let planes: Vec<f32> = (0..scene.triangles.len() as u32)
        .filter(|&t| matches!(scene.material_of(t).kind, MaterialKind::Mirror { .. }))
        .map(|t| {
            let [a, b, c] = scene.corners(t);
            assert!(a.x == b.x && b.x == c.x, "a mirror is not upright along z");
            let normal = (b - a).cross(c - a);
            let to_middle = scene.frame.scene_from_world_f64(glam::DVec3::Y).as_vec3() - a;
            assert!(normal.dot(to_middle) > 0.0, "a mirror turns its back");
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
fn furnace_is_closed_and_alike_everywhere() {
    let scene = scene("furnace");
    assert_eq!(scene.triangles.len(), 12);
    assert_eq!(scene.materials.len(), 1);
    let wall = &scene.materials[0];
    assert_eq!((wall.diffuse, wall.emission), (Vec3::splat(0.5), Vec3::ONE));
    assert!(matches!(&scene.lights[..], [Light::Triangles { corners, .. }] if corners.len() == 12));
    // Every wall shows its front to the middle, which is the scene's origin.
    for t in 0..12 {
        let [a, b, c] = scene.corners(t);
        assert!((b - a).cross(c - a).dot(a) < 0.0, "triangle {t}");
    }
}

#[test]
fn cornell_box_has_one_lamp_and_two_boxes() {
    let scene = scene("cornell");
    assert!(matches!(&scene.lights[..], [Light::Quad { .. }]));
    // Five walls, the lamp, and five sides each of two boxes.
    assert_eq!(scene.triangles.len(), 2 * (5 + 1 + 2 * 5));
    assert!(!scene.features.mirror && !scene.features.glass && !scene.features.textures);
}

#[test]
fn cornell_spheres_are_a_mirror_and_a_solid_of_glass() {
    let scene = scene("cornell-glass");
    assert!(scene.features.mirror && scene.features.glass);
    let glass: Vec<SolidSide> = (0..scene.triangles.len() as u32)
        .filter(|&t| matches!(scene.material_of(t).kind, MaterialKind::Glass { .. }))
        .map(|t| scene.solids[t as usize])
        .collect();
    assert_eq!(glass.len(), 5120);
    assert!(glass.iter().all(|&side| side == SolidSide::InsideBehind));
}
