//! Meshes and buffer views in compressed form, as written by the programs of the formats' authors:
//! Draco 1.5 (through DracoPy) and meshoptimizer.

use super::super::textures::png;
use super::{F32, Model, U32, load_text};
use crate::import::doubts;
use afterimage::scene::Scene;
use serde_json::{Value, json};

/// The surface z = x y over the unit square, 32 triangles: a name and the bytes of the mesh a line.
/// The mesh `moved` lies at [`MOVED`] from there.
const DRACO: &str = include_str!("../../data/draco.txt");

const MOVED: glam::Vec3 = glam::Vec3::new(-3.0, -3.0, 0.0);

/// Kind, name, count, stride, filter, encoded bytes and decoded bytes a line.
const MESHOPT: &str = include_str!("../../data/meshopt.txt");

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len() / 2).map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap()).collect()
}

fn draco_meshes() -> impl Iterator<Item = (&'static str, Vec<u8>)> {
    DRACO.lines().filter_map(|line| line.split_once(' ')).map(|(name, hex)| (name, bytes(hex)))
}

fn draco_model(mesh: &[u8]) -> Model {
    let mut model = Model::empty();
    let view = model.view(mesh);
    let mut accessor = |count: u32, shape: &str, component: u32| {
        model.push("accessors", json!({"count": count, "componentType": component, "type": shape}))
    };
    let [position, normal, uv] =
        [accessor(25, "VEC3", F32), accessor(25, "VEC3", F32), accessor(25, "VEC2", F32)];
    let indices = accessor(96, "SCALAR", U32);
    model.mesh(json!({
        "attributes": {"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv},
        "indices": indices,
        "material": 0,
        "extensions": {"KHR_draco_mesh_compression":
            {"bufferView": view, "attributes": {"POSITION": 2, "NORMAL": 1, "TEXCOORD_0": 0}}},
    }));
    model.node(json!({"mesh": 0}));
    // Texture coordinates of models without a picture are left out.
    let texture = model.texture(&png(1, 1, &[[255; 4]]));
    model.push("materials", json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}}));
    model.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    model
}

#[test]
fn draco_meshes_have_their_positions_normals_and_texture_coordinates() {
    for (name, mesh) in draco_meshes() {
        let scene = draco_model(&mesh).load();
        assert_eq!(scene.triangles.len(), 32, "{name}");
        assert_eq!(doubts(&scene), Vec::<&str>::new(), "{name}");
        for (v, position) in scene.positions.iter().enumerate() {
            let offset = if name == "moved" { MOVED } else { glam::Vec3::ZERO };
            let p = scene.frame.world_from_scene(*position).as_vec3() - offset;
            assert!((p.z - p.x * p.y).abs() < 1e-3, "{name}: {p}");
            // The v of the file grows downwards from y = 1.
            assert!((scene.uvs[v] - p.truncate()).abs().max_element() < 2e-3, "{name}: {p}");
            let expected = glam::Vec3::new(-p.y, -p.x, 1.0).normalize_or(glam::Vec3::Z);
            assert!(scene.normals[v].dot(expected) > 0.999, "{name}: {p}, {}", scene.normals[v]);
        }
    }
}

#[test]
fn damaged_draco_meshes_are_an_error_or_a_scene() {
    for (name, mesh) in draco_meshes() {
        let truncated = (0..mesh.len()).step_by(7).map(|length| mesh[..length].to_vec());
        let flipped = (0..mesh.len()).map(|at| {
            let mut damaged = mesh.clone();
            damaged[at] ^= 1 << (at % 8);
            damaged
        });
        for damaged in truncated.chain(flipped) {
            if let Err(error) = draco_model(&damaged).try_load() {
                let message = error.to_string();
                assert!(!message.contains("importer failed"), "{name}: {message}");
            }
        }
    }
    let error = draco_model(&[0; 64]).try_load().map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("cannot be decoded") && error.contains("without compression"), "{error}");
}

/// The words of a line of [`MESHOPT`].
fn view_of(name: &str) -> Vec<&'static str> {
    MESHOPT.lines().map(|line| line.split(' ').collect::<Vec<_>>()).find(|words| words[1] == name).unwrap()
}

/// Adds a view, compressed or decoded, and an accessor of it.
fn add(model: &mut Model, name: &str, extension: Option<&str>, kind: [&str; 2], component: u32) -> usize {
    let words = view_of(name);
    let [count, stride]: [usize; 2] = [words[2], words[3]].map(|number| number.parse().unwrap());
    let decoded = bytes(words[6]);
    let stored = if extension.is_some() { bytes(words[5]) } else { decoded.clone() };
    let view = model.view(&stored);
    if let Some(extension) = extension {
        let offset = model.json["bufferViews"][view]["byteOffset"].clone();
        let mut compressed = json!({"buffer": 0, "byteOffset": offset, "byteLength": stored.len(),
            "byteStride": stride, "count": count, "mode": kind[0]});
        if words[4] != "NONE" {
            compressed["filter"] = words[4].into();
        }
        let mut json = json!({"buffer": 1, "byteLength": decoded.len()});
        json["extensions"][extension] = compressed;
        model.json["bufferViews"][view] = json;
    }
    model.push(
        "accessors",
        json!({"bufferView": view, "count": count, "componentType": component, "type": kind[1]}),
    )
}

fn meshopt_model(extension: Option<&str>, positions: &str, indices: &str) -> Model {
    let mut model = Model::empty();
    let mode = if indices == "tri" { "TRIANGLES" } else { "INDICES" };
    let position = add(&mut model, positions, extension, ["ATTRIBUTES", "VEC3"], F32);
    let indices = add(&mut model, indices, extension, [mode, "SCALAR"], U32);
    model.mesh(json!({"attributes": {"POSITION": position}, "indices": indices}));
    model.node(json!({"mesh": 0}));
    model
}

fn load_with_placeholder(model: &Model) -> Result<Scene, afterimage::scene::SceneError> {
    let mut json: Value = serde_json::from_str(&model.embedded()).unwrap();
    json["buffers"].as_array_mut().unwrap().push(json!({"byteLength": 1_000_000}));
    load_text(&json.to_string())
}

#[test]
fn compressed_views_make_the_scene_of_their_data() {
    for (extension, positions) in [
        ("EXT_meshopt_compression", "pos0"),
        ("KHR_meshopt_compression", "pos1"),
        ("EXT_meshopt_compression", "exp"),
    ] {
        for indices in ["tri", "seq"] {
            let plain: Value =
                serde_json::from_str(&meshopt_model(None, positions, indices).embedded()).unwrap();
            let plain = load_text(&plain.to_string()).unwrap();
            let scene = load_with_placeholder(&meshopt_model(Some(extension), positions, indices)).unwrap();
            assert_eq!(scene.positions, plain.positions, "{extension} {positions} {indices}");
            assert_eq!(scene.triangles, plain.triangles, "{extension} {positions} {indices}");
            // Both name the triangles of the data that have no vertices, and nothing else.
            assert_eq!(doubts(&scene), doubts(&plain), "{extension} {positions} {indices}");
        }
    }
}

#[test]
fn a_damaged_view_is_named_and_costs_what_uses_it() {
    let mut model = meshopt_model(Some("EXT_meshopt_compression"), "pos0", "seq");
    model.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] =
        1_000_000_000_000u64.into();
    let error = load_with_placeholder(&model).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("that cannot be decoded") && error.contains("bufferViews[0]"), "{error}");
    let mut model = meshopt_model(Some("EXT_meshopt_compression"), "pos0", "seq");
    model.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["mode"] = "OTHER".into();
    let error = load_with_placeholder(&model).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("mode"), "{error}");
    // A view that is stored in plain form as well is shown from that.
    let mut model = meshopt_model(None, "pos0", "seq");
    model.json["bufferViews"][0]["extensions"] = json!({"EXT_meshopt_compression": {"buffer": 0,
        "byteLength": 9, "byteStride": 12, "count": 40, "mode": "ATTRIBUTES"}});
    let scene = load_with_placeholder(&model).unwrap();
    assert!(doubts(&scene).iter().any(|doubt| doubt.contains("cannot be decoded")), "{:?}", doubts(&scene));
}
