//! Buffers, accessors, primitives and nodes.

use super::super::{Folder, area_m2, assert_clean, warning};
use super::{F32, Model, SQUARE, U8, U16, U32};
use afterimage::Scene;
use glam::{DVec3, Vec3};
use serde_json::json;

/// Asserts that both triangles of the square face +Z, and that it has its area.
fn assert_square(scene: &Scene) {
    assert!((area_m2(scene) - 1.0).abs() < 1e-6, "{}", area_m2(scene));
    assert!((0..scene.triangles.len() as u32).all(|t| front(scene, t).z > 0.99));
}

fn front(scene: &Scene, triangle: u32) -> Vec3 {
    let [a, b, c] = scene.corners(triangle);
    (b - a).cross(c - a).normalize_or_zero()
}

#[test]
fn text_binary_and_split_files_are_the_same_scene() {
    let model = Model::square();
    let folder = Folder::with_obj("")
        .add("in.gltf", model.embedded())
        .add("one.GLB", model.glb())
        .add("two.gltf", model.text(Some("my%20data.bin")))
        .add("my data.bin", &model.bin)
        .add("bom.gltf", format!("\u{feff}{}", model.embedded()));
    let load = |name: &str| folder.try_load_file(name).unwrap();
    let first = load("in.gltf");
    assert_square(&first);
    assert_clean(&first);
    for name in ["one.GLB", "two.gltf", "bom.gltf"] {
        assert_eq!(load(name).hash, first.hash, "{name}");
    }
}

#[test]
fn every_kind_of_index_gives_the_same_triangles() {
    let with = |add: &dyn Fn(&mut Model) -> Option<usize>| {
        let mut model = Model::square();
        match add(&mut model) {
            Some(indices) => model.json["meshes"][0]["primitives"][0]["indices"] = indices.into(),
            None => drop(model.json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices")),
        }
        model.load()
    };
    let quad = [0u8, 1, 2, 0, 2, 3];
    assert_square(&with(&|m| Some(m.accessor(&quad, U8, "SCALAR"))));
    assert_square(&with(&|m| Some(m.accessor(&quad.map(u16::from), U16, "SCALAR"))));
    assert_square(&with(&|m| Some(m.accessor(&quad.map(u32::from), U32, "SCALAR"))));
    // Without indices, each three vertices are a triangle; the fourth vertex is left out.
    assert!((area_m2(&with(&|_| None)) - 0.5).abs() < 1e-6);
}

#[test]
fn strips_and_fans_keep_their_fronts() {
    for (mode, order) in [(4, vec![0u16, 1, 2, 0, 2, 3]), (5, vec![0, 1, 3, 2]), (6, vec![0, 1, 2, 3])] {
        let mut model = Model::square();
        let indices = model.accessor(&order, U16, "SCALAR");
        model.json["meshes"][0]["primitives"][0]["indices"] = indices.into();
        model.json["meshes"][0]["primitives"][0]["mode"] = mode.into();
        assert_square(&model.load());
    }
}

#[test]
fn points_and_lines_are_left_out() {
    let mut model = Model::square();
    for mode in 0..4 {
        let mut primitive = model.json["meshes"][0]["primitives"][0].clone();
        primitive["mode"] = mode.into();
        model.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
    }
    let scene = model.load();
    assert_square(&scene);
    assert!(warning(&scene, "without a surface").2.starts_with("4 "));
}

#[test]
fn interleaved_normalised_and_sparse_numbers_are_read() {
    let mut model = Model::square();
    // Interleaved with other data, 16 bytes apart.
    let spread: Vec<[f32; 4]> = SQUARE.iter().map(|p| [p[0], p[1], p[2], 7.0]).collect();
    let view = model.view(bytemuck::cast_slice(&spread));
    model.json["bufferViews"][view]["byteStride"] = 16.into();
    model.json["accessors"][0]["bufferView"] = view.into();
    assert_square(&model.load());

    // 0 and 65535 are 0 and 1 after normalisation.
    let mut model = Model::square();
    let whole: Vec<[u16; 3]> = SQUARE.iter().map(|p| p.map(|x| if x > 0.0 { u16::MAX } else { 0 })).collect();
    let normalised = model.accessor(&whole, U16, "VEC3");
    model.json["accessors"][normalised]["normalized"] = true.into();
    model.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = normalised.into();
    assert_square(&model.load());

    // All elements are zero except the sparse ones.
    let mut model = Model::square();
    let indices = model.view(bytemuck::cast_slice(&[1u16, 2, 3]));
    let values = model.view(bytemuck::cast_slice(&SQUARE[1..]));
    model.json["accessors"][0] = json!({
        "count": 4, "componentType": F32, "type": "VEC3",
        "sparse": {"count": 3, "indices": {"bufferView": indices, "componentType": U16}, "values": {"bufferView": values}},
    });
    assert_square(&model.load());
}

#[test]
fn nodes_place_their_meshes() {
    let mut model = Model::square();
    model.json["nodes"][0] = json!({"translation": [10.0, 0.0, 0.0], "children": [1]});
    model.push("nodes", json!({"mesh": 0, "scale": [2.0, 3.0, 1.0], "rotation": [0, 0, std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2]}));
    let scene = model.load();
    assert!((area_m2(&scene) - 6.0).abs() < 1e-5);
    // A quarter turn about Z: 2 along +Y, 3 along -X.
    let [low, high] = scene.bounds_m;
    assert!(
        (low - DVec3::new(7.0, 0.0, 0.0)).length() < 1e-6
            && (high - DVec3::new(10.0, 2.0, 0.0)).length() < 1e-6
    );

    model.json["nodes"][0] =
        json!({"children": [1], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1]});
    assert_eq!(model.load().hash, scene.hash, "a matrix says the same as a translation");
}

#[test]
fn a_mirrored_node_keeps_fronts_and_normals_together() {
    let mut model = Model::square();
    let normals = model.accessor(&[[0.0f32, 0.0, 1.0]; 4], F32, "VEC3");
    model.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
    model.json["nodes"][0] = json!({"mesh": 0, "scale": [-1.0, 4.0, 1.0]});
    let scene = model.load();
    assert!(scene.normals.iter().all(|n| n.z > 0.99), "{:?}", scene.normals);
    assert!((0..2).all(|t| front(&scene, t).z > 0.99));
}

#[test]
fn every_instance_of_a_mesh_is_added() {
    let mut model = Model::square();
    (1..100).for_each(|i| {
        model.node(json!({"mesh": 0, "translation": [2 * i, 0, 0]}));
    });
    let scene = model.load();
    assert_eq!((scene.triangles.len(), scene.positions.len()), (200, 400));
    assert!((area_m2(&scene) - 100.0).abs() < 1e-3);
}

#[test]
fn unused_vertices_are_left_out() {
    let mut model = Model::empty();
    let many: Vec<[f32; 3]> = (0..3000).map(|i| [i as f32, (i % 7) as f32, 0.0]).collect();
    let position = model.accessor(&many, F32, "VEC3");
    let indices = model.accessor(&[5u16, 2900, 17], U16, "SCALAR");
    model.mesh(json!({"attributes": {"POSITION": position}, "indices": indices}));
    model.node(json!({"mesh": 0}));
    let scene = model.load();
    assert_eq!((scene.triangles.len(), scene.positions.len()), (1, 3));
    let [a, b, _] = scene.corners(0).map(|p| scene.frame.world_from_scene(p));
    assert!((a.x - 5.0).abs() < 0.1 && (b.x - 2900.0).abs() < 0.1, "{a} {b}");
}

#[test]
fn a_file_without_a_scene_shows_its_roots() {
    let mut model = Model::square();
    model.json["nodes"] = json!([{"children": [1]}, {"mesh": 0}]);
    model.json.as_object_mut().unwrap().retain(|key, _| key != "scene" && key != "scenes");
    assert_square(&model.load());
}

#[test]
fn a_tree_of_any_depth_is_walked_without_recursion() {
    const DEPTH: usize = 100_000;
    let mut model = Model::square();
    let nodes = (0..DEPTH).map(|i| json!({"children": [i + 1]})).chain([json!({"mesh": 0})]).collect();
    model.json["nodes"] = nodes;
    assert_square(&model.load());
}

#[test]
fn unit_and_up_axis_can_be_set_for_gltf() {
    let folder = Folder::with_obj("")
        .add("scene.gltf", Model::square().embedded())
        .add("scene.afterimage.toml", "unit = \"cm\"\nup = \"+Z\"\n");
    let scene = folder.try_load_file("scene.gltf").unwrap();
    assert!((area_m2(&scene) - 1e-4).abs() < 1e-9);
    assert!(front(&scene, 0).y > 0.99, "+Z of the model is up");
}

#[test]
fn import_agrees_with_the_gltf_crate() {
    let mut model = Model::square();
    let indices = model.accessor(&[3u8, 1, 0, 2, 1, 3], U8, "SCALAR");
    let position = model.accessor(
        &[[0.5f32, 2.0, -1.0], [4.0, 0.25, 8.0], [1.0, 1.0, 3.0], [-2.0, 0.0, 0.125]],
        F32,
        "VEC3",
    );
    model.mesh(json!({"attributes": {"POSITION": position}, "indices": indices, "mode": 5}));
    model.node(json!({"mesh": 1, "translation": [1.0, 2.0, 3.0]}));
    let document = gltf::Gltf::from_slice_without_validation(&model.glb()).unwrap();
    let mut theirs: Vec<DVec3> = Vec::new();
    for node in document.nodes() {
        let offset = DVec3::from_array(node.transform().decomposed().0.map(f64::from));
        for primitive in node.mesh().unwrap().primitives() {
            let reader = primitive.reader(|_| Some(&model.bin));
            let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
            let indices = reader.read_indices().unwrap().into_u32();
            theirs.extend(indices.map(|i| DVec3::from_array(positions[i as usize].map(f64::from)) + offset));
        }
    }
    let scene = model.load();
    let ours = |corner: u32| scene.frame.world_from_scene(scene.positions[corner as usize]);
    let list: Vec<DVec3> = scene.triangles[..2].iter().flatten().map(|v| ours(*v)).collect();
    assert!(list.iter().zip(&theirs[..6]).all(|(a, b)| a.distance(*b) < 1e-5), "{list:?} {theirs:?}");
    let strip = [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]].map(|t: [usize; 3]| t.map(|i| theirs[6 + i]));
    // Two of the four triangles of the strip have no area, because it repeats two vertices.
    let kept = strip.iter().filter(|[a, b, c]| (*b - *a).cross(*c - *a).length() > 0.0);
    for (ours_, theirs) in scene.triangles[2..].iter().zip(kept) {
        assert!((0..3).all(|i| ours(ours_[i]).distance(theirs[i]) < 1e-5));
    }
}
