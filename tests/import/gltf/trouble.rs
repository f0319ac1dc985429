//! Broken and hostile files.

use super::super::{Folder, warning};
use super::{F32, Model, load_text};
use afterimage::scene::SceneError;
use serde_json::json;

#[test]
fn only_a_broken_item_is_lost_and_its_line_is_named() {
    let mut model = Model::square();
    model.node(json!({"mesh": 0, "translation": "far"}));
    model.node(json!({"mesh": 9}));
    let text = model.embedded();
    let scene = load_text(&text).unwrap();
    assert_eq!(scene.triangles.len(), 2);
    let line = text.lines().position(|l| l.contains("far")).unwrap() as u64;
    let (file, at, message) = warning(&scene, "cannot be read");
    // The item begins up to two lines above the value.
    assert!(
        file == "scene.gltf" && (line - 2..=line + 1).contains(&at) && message.contains("nodes[1]"),
        "{at} {message}"
    );
    assert!(warning(&scene, "does not exist").2.contains("meshes[9] of 1"));
}

#[test]
fn invalid_json_names_its_line() {
    let error = load_text("{\n\"asset\": {\"version\": \"2.0\"},\n\"nodes\": [}\n").unwrap_err();
    assert!(matches!(error, SceneError::Line { line: 3, .. }), "{error}");
    let folder = Folder::with_obj("").add("scene.gltf", b"{\n\"a\": \"\xff\"}");
    let error = folder.try_load_file("scene.gltf").unwrap_err();
    assert!(
        matches!(error, SceneError::Line { line: 2, .. }) && error.to_string().contains("UTF-8"),
        "{error}"
    );
}

#[test]
fn files_that_cannot_be_shown_name_the_cause() {
    let error = |json: serde_json::Value| load_text(&json.to_string()).unwrap_err().to_string();
    assert!(error(json!({"asset": {"version": "1.0"}})).contains("glTF 1.0"));
    assert!(error(json!({})).contains("no faces"));
    let mut model = Model::square();
    model.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    model.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    model.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert!(model.try_load().unwrap_err().to_string().contains("without compression"));
    let mut model = Model::square();
    model.json["extensionsRequired"] = json!(["KHR_xyz"]);
    model.json["animations"] = json!([{}]);
    let scene = model.load();
    assert!(warning(&scene, "not supported").2.contains("KHR_xyz"));
    warning(&scene, "animations are not played");
}

#[test]
fn a_binary_file_cut_anywhere_is_an_error_or_a_part() {
    let bytes = Model::square().glb();
    for end in 0..bytes.len() {
        let folder = Folder::with_obj("").add("scene.glb", &bytes[..end]);
        let outcome = folder.try_load_file("scene.glb");
        if let Err(error) = outcome {
            assert!(!error.to_string().contains("importer failed"), "{end}: {error}");
        }
    }
}

#[test]
fn numbers_outside_their_buffer_are_never_read() {
    let huge = u64::MAX;
    let spoil: [(&str, &str, serde_json::Value); 9] = [
        ("accessors", "count", 5.into()),
        ("accessors", "count", huge.into()),
        ("accessors", "count", 0.into()),
        ("accessors", "byteOffset", 1.into()),
        ("accessors", "byteOffset", huge.into()),
        ("bufferViews", "byteLength", huge.into()),
        ("bufferViews", "byteOffset", huge.into()),
        ("bufferViews", "byteStride", 2.into()),
        ("bufferViews", "byteStride", huge.into()),
    ];
    for (list, key, value) in spoil {
        let mut model = Model::square();
        // A second mesh stays valid.
        let position = model.accessor(&super::SQUARE, F32, "VEC3");
        model.mesh(json!({"attributes": {"POSITION": position}}));
        model.node(json!({"mesh": 1}));
        model.json[list][0][key] = value.clone();
        let scene = model.load();
        assert_eq!(scene.triangles.len(), 1, "{list} {key} {value}");
        assert!(scene.warnings.iter().any(|w| w.line > 0), "{list} {key} {value}: {:?}", scene.warnings);
    }
}

#[test]
fn a_triangle_of_a_missing_vertex_is_left_out() {
    let mut model = Model::square();
    let indices = model.accessor(&[0u32, 1, 2, 0, 2, u32::MAX, 4, 4, 4], super::U32, "SCALAR");
    model.json["meshes"][0]["primitives"][0]["indices"] = indices.into();
    let scene = model.load();
    assert_eq!(scene.triangles.len(), 1);
    assert!(warning(&scene, "does not exist").2.contains("2 of primitive 0"));
}

#[test]
fn nodes_in_circles_and_with_two_parents_are_shown_once() {
    let mut model = Model::square();
    model.json["nodes"] = json!([{"children": [1, 2]}, {"children": [0, 2, 1]}, {"mesh": 0}]);
    let scene = model.load();
    assert_eq!(scene.triangles.len(), 2);
    assert!(warning(&scene, "two parents").2.starts_with("3 "));
}

#[test]
fn a_small_file_cannot_ask_for_endless_copies() {
    let mut model = Model::square();
    for _ in 0..10 {
        model.node(json!({"mesh": 0}));
    }
    let mut folder = Folder::with_obj("").add("scene.gltf", model.embedded());
    folder.options.limits.gltf_vertices = 44;
    assert!(folder.try_load_file("scene.gltf").is_ok());
    folder.options.limits.gltf_vertices = 43;
    let error = folder.try_load_file("scene.gltf").unwrap_err();
    assert!(matches!(error, SceneError::TooLarge { count: 44, limit: 43, .. }), "{error}");
    // A count without data.
    let mut model = Model::empty();
    model.push("accessors", json!({"count": 4_000_000_000u64, "componentType": F32, "type": "VEC3"}));
    model.mesh(json!({"attributes": {"POSITION": 0}}));
    model.node(json!({"mesh": 0}));
    assert!(matches!(model.try_load(), Err(SceneError::TooLarge { .. })));
}

#[test]
fn nothing_outside_the_folder_is_opened() {
    let model = Model::square();
    for uri in [
        "../secret.bin",
        "..%2Fsecret.bin",
        "file:///etc/passwd",
        "/etc/passwd",
        "//host/share/a.bin",
        "\\\\host\\a.bin",
    ] {
        let folder =
            Folder::with_obj("").add("inner/scene.gltf", model.text(Some(uri))).add("secret.bin", &model.bin);
        let load = |options| super::super::load(&folder.path("inner/scene.gltf"), options, &|_, _| true);
        let error = load(&folder.options).unwrap_err().to_string();
        assert!(error.contains("buffer"), "{uri}: {error}");
        let mut trusting = folder.options.clone();
        trusting.allow_outside = true;
        assert_eq!(load(&trusting).is_ok(), uri.contains("secret"), "{uri}");
    }
}

#[test]
fn all_buffers_together_have_a_budget() {
    let model = Model::square();
    let mut folder =
        Folder::with_obj("").add("scene.gltf", model.text(Some("a.bin"))).add("a.bin", &model.bin);
    folder.options.limits.buffers_bytes = model.bin.len() as u64;
    assert!(folder.try_load_file("scene.gltf").is_ok());
    folder.options.limits.buffers_bytes -= 1;
    let error = folder.try_load_file("scene.gltf").unwrap_err().to_string();
    assert!(error.contains("at most"), "{error}");
    folder.options.limits.gltf_bytes = 100;
    let error = folder.try_load_file("scene.gltf").unwrap_err().to_string();
    assert!(error.contains("at most 100 are read"), "{error}");
}

#[test]
fn every_phase_of_a_gltf_can_be_cancelled() {
    use afterimage::import::Phase;
    let mut model = Model::painted(json!({}));
    let texture = model.texture(&super::super::textures::png(1, 1, &[[9, 9, 9, 255]]));
    model.json["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": texture}});
    let folder = Folder::with_obj("").add("scene.gltf", model.embedded());
    for phase in [Phase::Reading, Phase::Parsing, Phase::Textures, Phase::Building] {
        let outcome = super::super::load(&folder.path("scene.gltf"), &folder.options, &|p, _| p != phase);
        assert!(matches!(outcome, Err(SceneError::Cancelled)), "{phase:?}");
    }
}

#[test]
fn a_bad_key_at_the_root_costs_only_itself() {
    let mut model = Model::square();
    model.json["extensionsUsed"] = json!(["KHR_lights_punctual", "EXT_lights_ies"]);
    model.json["extensions"] = json!({
        "KHR_lights_punctual": {"lights": [{"type": "point"}]}, "EXT_lights_ies": {"lights": []},
    });
    model.node(json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}));
    let whole = model.load();
    assert_eq!((whole.triangles.len(), whole.lights.len()), (2, 1));
    let needed = ["nodes", "meshes", "accessors", "bufferViews", "buffers"];
    let keys: Vec<String> = model.json.as_object().unwrap().keys().cloned().collect();
    for key in keys.iter().filter(|key| !needed.contains(&key.as_str())) {
        for bad in [json!(5), json!("text"), json!(true), json!({"a": []}), json!([5])] {
            let mut spoilt = Model { json: model.json.clone(), bin: model.bin.clone() };
            spoilt.json[key] = bad.clone();
            // A scene that exists is another scene, and a list of unused items is never read.
            let scene = spoilt.try_load().unwrap_or_else(|error| panic!("{key} {bad}: {error}"));
            assert_eq!(scene.triangles.len(), 2, "{key} {bad}");
            if key != "extensions" {
                assert_eq!(scene.lights.len(), 1, "{key} {bad}");
            }
        }
    }
    for (bad, lights) in [("EXT_lights_ies", 1), ("KHR_lights_punctual", 0)] {
        let mut spoilt = Model { json: model.json.clone(), bin: model.bin.clone() };
        spoilt.json["extensions"][bad] = json!(5);
        let scene = spoilt.load();
        // Without a lamp, the scene gets a sun and a sky.
        assert_eq!(scene.lights.len(), if lights == 0 { 2 } else { 1 }, "{bad}");
        assert!(warning(&scene, "of the root that cannot be read").2.contains(bad), "{bad}");
    }
}
