//! Hashes of the parts of a scene follow what is seen, not how a file writes it.

use afterimage::math::key::Key;
use afterimage::scene::content::{ContentHash, LightContent, hashes_of_triangles};
use afterimage::scene::{Material, MaterialId, Scene, SceneBuilder, Sky, Sun, builtin};
use glam::{DVec3, Vec2, Vec3};

/// A model written again in another order: vertices are not shared, triangles are shuffled, each
/// begins at another corner or runs the other way round, and materials are numbered backwards.
pub(crate) fn written_again(scene: &Scene, more: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let mut builder = SceneBuilder::new("another name");
    builder.materials = scene.materials.iter().rev().cloned().collect();
    builder.materials.iter_mut().for_each(|material| material.name.push('!'));
    builder.textures.clone_from(&scene.textures);
    builder.sun = scene.sun;
    builder.sky = scene.sky.clone();
    let last = scene.materials.len() as u32 - 1;
    let mut order: Vec<u32> = (0..scene.triangles.len() as u32).collect();
    order.sort_by_key(|&t| Key::of_pixel(5, t).bits());
    for t in order {
        let mut corners = scene.triangles[t as usize];
        corners.rotate_left((t % 3) as usize);
        if t % 2 == 1 {
            corners.swap(0, 2);
        }
        let vertices = corners.map(|v| {
            let v = v as usize;
            let normal = scene.normals.get(v).copied().unwrap_or_default();
            let uv = scene.uvs.get(v).copied().unwrap_or_default();
            builder.add_vertex(scene.frame.world_from_scene(scene.positions[v]), normal, uv)
        });
        builder.add_triangle(vertices, MaterialId(last - scene.triangle_materials[t as usize].0));
    }
    more(&mut builder);
    builder.finish().unwrap()
}

fn sorted(scene: &Scene) -> Vec<ContentHash> {
    hashes_of_triangles(scene).iter().map(|entry| entry.0).collect()
}

/// The hash of each triangle.
fn by_triangle(scene: &Scene) -> Vec<ContentHash> {
    let mut entries = hashes_of_triangles(scene);
    entries.sort_by_key(|entry| entry.1);
    entries.into_iter().map(|entry| entry.0).collect()
}

#[test]
fn a_model_written_in_another_order_has_the_same_content() {
    for name in ["cornell", "gallery-bench", "mirrors"] {
        let scene = builtin::build(name).unwrap();
        let again = written_again(&scene, |_| {});
        assert_ne!(scene.hash, again.hash, "{name}");
        assert_eq!(sorted(&scene), sorted(&again), "{name}");
        let there = hashes_of_triangles(&again);
        for (triangle, hash) in (0..).zip(by_triangle(&scene)) {
            let at = there.binary_search_by_key(&hash, |entry| entry.0).expect("it is in the other scene");
            let [mut here, mut there] = [scene.corners(triangle), again.corners(there[at].1)];
            let order = |a: &Vec3, b: &Vec3| a.to_array().partial_cmp(&b.to_array()).unwrap();
            here.sort_by(order);
            there.sort_by(order);
            assert_eq!(here, there, "{name}");
        }
        let [mut a, b] = [&scene, &again].map(LightContent::of);
        a.materials.reverse();
        assert_eq!(a, b, "{name}");
    }
}

#[test]
fn each_change_of_a_triangle_changes_its_hash_and_no_other() {
    let scene = builtin::build("cornell").unwrap();
    let before = by_triangle(&scene);
    for vertex in 0..scene.positions.len() {
        let mut moved = scene.clone();
        // A thousandth of the diagonal's 1024 units would be one unit.
        let positions = std::sync::Arc::make_mut(&mut moved.positions);
        positions[vertex].y += 1.0 / 128.0;
        let after = by_triangle(&moved);
        for (triangle, corners) in scene.triangles.iter().enumerate() {
            let is_moved = corners.contains(&(vertex as u32));
            assert_eq!(before[triangle] != after[triangle], is_moved);
        }
    }
}

#[test]
fn a_larger_model_of_the_same_scale_keeps_the_hashes_of_what_stayed() {
    let mut builder = SceneBuilder::new("stones");
    let material = builder.add_material(Material::diffuse("stone", Vec3::ONE));
    let number = |i: u32, k: u32| f64::from(Key::of_pixel(i.into(), k).pair()[0]);
    let add = |builder: &mut SceneBuilder, i: u32, offset: DVec3| {
        let corner = |k| DVec3::new(number(i, k), number(i, k + 1), number(i, k + 2)) * 20.0 + offset;
        let vertices = [0, 3, 6].map(|k| builder.add_vertex(corner(k), Vec3::ZERO, Vec2::ZERO));
        builder.add_triangle(vertices, material);
    };
    (0..2000).for_each(|i| add(&mut builder, i, DVec3::ZERO));
    let scene = builder.finish().unwrap();
    let larger = written_again(&scene, |builder| {
        let outside = [[22.3, 5.0, 5.0], [21.0, 6.7, 5.0], [21.0, 5.0, 6.1]];
        let vertices = outside.map(|at| builder.add_vertex(DVec3::from(at), Vec3::ZERO, Vec2::ZERO));
        builder.add_triangle(vertices, material);
    });
    assert_eq!(scene.frame.units_per_metre, larger.frame.units_per_metre);
    assert_ne!(scene.frame.origin_in_world_m, larger.frame.origin_in_world_m);
    let now = sorted(&larger);
    let kept = sorted(&scene).iter().filter(|hash| now.binary_search(hash).is_ok()).count();
    assert!(kept >= 1900, "{kept} of 2000");
}

#[test]
fn the_parts_of_a_material_and_the_sources_of_light_change_apart() {
    let scene = builtin::build("gallery-bench").unwrap();
    let before = LightContent::of(&scene);
    let changed = |change: &dyn Fn(&mut Material)| {
        let mut edit = scene.to_edit();
        change(&mut edit.materials[0]);
        let after = LightContent::of(&scene.with_edit(&edit)).materials;
        assert_eq!(before.materials[1..], after[1..]);
        let (a, b) = (before.materials[0], after[0]);
        [a.reflection != b.reflection, a.transmission != b.transmission, a.emission != b.emission]
    };
    assert_eq!(changed(&|m| m.name = "renamed".to_owned()), [false; 3]);
    assert_eq!(changed(&|m| m.diffuse *= 0.5), [true, false, false]);
    assert_eq!(changed(&|m| m.emission += Vec3::X), [false, false, true]);
    let glass = Material::glass("glass", 1.5, Vec3::ONE).kind;
    assert!(changed(&|m| m.kind = glass)[1]);
    let mut edit = scene.to_edit();
    edit.daylight.sun = Some(Sun { angular_radius: 0.1, ..Sun::clear_day() });
    edit.daylight.sky = Some(Sky::even(Vec3::ONE));
    let after = LightContent::of(&scene.with_edit(&edit));
    assert_eq!(before.materials, after.materials);
    assert!(before.sun != after.sun && before.sky != after.sky);
}
