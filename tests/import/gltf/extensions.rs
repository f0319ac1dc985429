//! Extensions, and what exporters leave out or write in their own way.

use super::super::textures::png;
use super::super::{doubts, material, warning};
use super::{F32, Model, load_text};
use afterimage::scene::{Beam, Light, MaterialKind, Sampling, Scene, SolidSide, Wrap};
use glam::{DVec3, Vec2, Vec3};
use serde_json::{Value, json};

/// The square at several places, by EXT_mesh_gpu_instancing.
fn instances(attributes: &[(&str, usize)], model: &mut Model) {
    let attributes: serde_json::Map<String, Value> =
        attributes.iter().map(|(name, accessor)| ((*name).to_owned(), json!(accessor))).collect();
    model.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
    model.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
}

#[test]
fn every_instance_of_a_mesh_is_placed() {
    let mut model = Model::square();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let translation = model.accessor(&[[0.0f32, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 7.0, 0.0]], F32, "VEC3");
    let rotation =
        model.accessor(&[[0.0f32, 0.0, 0.0, 1.0], [0.0, half, 0.0, half], [0.0, 0.0, 0.0, 0.0]], F32, "VEC4");
    let scale = model.accessor(&[[1.0f32, 1.0, 1.0], [2.0, 2.0, 2.0], [1.0, 3.0, 1.0]], F32, "VEC3");
    instances(&[("TRANSLATION", translation), ("ROTATION", rotation), ("SCALE", scale)], &mut model);
    let scene = model.load();
    assert_eq!(doubts(&scene), Vec::<&str>::new());
    assert_eq!(scene.triangles.len(), 6);
    let [low, high] = scene.bounds_m;
    // The second is turned towards -Z, and twice as large; the third is three times as high.
    assert!((low - DVec3::new(0.0, 0.0, -2.0)).length() < 1e-5, "{low}");
    assert!((high - DVec3::new(5.0, 10.0, 0.0)).length() < 1e-5, "{high}");
}

#[test]
fn a_million_claimed_instances_are_refused() {
    let mut model = Model::square();
    let claim =
        model.push("accessors", json!({"count": 4_000_000_000u32, "componentType": F32, "type": "VEC3"}));
    instances(&[("TRANSLATION", claim)], &mut model);
    assert!(model.try_load().unwrap_err().to_string().contains("instances"));
}

#[test]
fn specular_and_glossiness_keep_their_colours() {
    let material_of = |extension: Value, alpha: &str| {
        let extensions = json!({"KHR_materials_pbrSpecularGlossiness": extension});
        let scene = Model::painted(json!({"name": "a", "alphaMode": alpha, "extensions": extensions})).load();
        material(&scene, "a").clone()
    };
    let oak = json!({"diffuseFactor": [0.4, 0.3, 0.2, 1.0], "specularFactor": [0.04, 0.04, 0.04]});
    assert_eq!(material_of(oak, "OPAQUE").diffuse, Vec3::new(0.4, 0.3, 0.2));
    let pane = json!({"diffuseFactor": [0.6, 0.8, 1.0, 0.25], "specularFactor": [0.04, 0.04, 0.04]});
    let pane = material_of(pane, "BLEND");
    assert_eq!(pane.kind, MaterialKind::Glass { eta: 1.0, transmittance: Vec3::splat(0.75) });
}

fn with_light(light: Value) -> Scene {
    let mut model = Model::square();
    model.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
    model.node(json!({"translation": [0, 2, 0], "rotation": [-std::f64::consts::FRAC_1_SQRT_2, 0, 0, std::f64::consts::FRAC_1_SQRT_2],
        "extensions": {"KHR_lights_punctual": {"light": 0}}}));
    model.load()
}

#[test]
fn a_spot_light_shines_in_its_cone() {
    let spot = json!({"innerConeAngle": 0.3, "outerConeAngle": 0.6});
    let scene = with_light(json!({"type": "spot", "intensity": 500.0, "spot": spot}));
    let Light::Point { beam: Some(beam), .. } = scene.lights[0] else { panic!("{:?}", scene.lights) };
    assert!((beam.direction - Vec3::NEG_Y).length() < 1e-6, "{beam:?}");
    let at = |angle: f32| beam.share(Vec3::new(angle.sin(), -angle.cos(), 0.0));
    assert_eq!([at(0.0), at(0.29), at(0.61), at(3.0)], [1.0, 1.0, 0.0, 0.0]);
    assert!(at(0.4) > at(0.5) && at(0.5) > 0.0);
    assert!(!doubts(&scene).iter().any(|d| d.contains("spot")));
    // Without values, the cone is that of the specification.
    let scene = with_light(json!({"type": "spot"}));
    let expected = Beam::new(Vec3::NEG_Y, 0.0, std::f32::consts::FRAC_PI_4);
    let Light::Point { beam: Some(beam), .. } = scene.lights[0] else { panic!("{:?}", scene.lights) };
    assert!((beam.cos_outer - expected.cos_outer).abs() < 1e-6 && beam.cos_inner == 1.0);
}

#[test]
fn compression_that_is_only_listed_stops_nothing() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"] {
        for list in ["extensionsUsed", "extensionsRequired"] {
            let mut model = Model::square();
            model.json[list] = json!([name]);
            assert_eq!(doubts(&model.load()), Vec::<&str>::new(), "{name}");
        }
    }
    let mut model = Model::square();
    let compressed = json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    model.json["meshes"][0]["primitives"][0]["extensions"] = compressed;
    model.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    assert_eq!(model.load().triangles.len(), 2, "the data for others is there");
}

#[test]
fn samplers_clamp_mirror_and_show_texels() {
    for (sampler, wrap, is_nearest) in [
        (json!({}), [Wrap::Repeat; 2], false),
        (json!({"wrapS": 33071, "wrapT": 33648}), [Wrap::Clamp, Wrap::Mirror], false),
        (json!({"magFilter": 9728}), [Wrap::Repeat; 2], true),
    ] {
        let mut model = Model::painted(json!({"name": "a"}));
        let texture = model.texture(&png(2, 1, &[[255, 0, 0, 255], [0, 0, 255, 255]]));
        model.json["samplers"] = json!([sampler]);
        model.json["textures"][texture]["sampler"] = json!(0);
        model.json["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": texture}});
        let scene = model.load();
        let used = material(&scene, "a").diffuse_texture.unwrap();
        assert_eq!(used.sampling, Sampling { wrap, is_nearest, turn: 0.0 });
        let at = |u: f32| used.color(&scene.textures, Vec2::new(u, 0.5)).x;
        let expected = if wrap[0] == Wrap::Clamp { [1.0, 1.0, 0.0] } else { [0.0, 1.0, 1.0] };
        assert_eq!([at(-0.25), at(0.25), at(1.25)].map(f32::round), expected, "{sampler}");
        assert_eq!(at(0.49) == 1.0, is_nearest, "{sampler}");
    }
}

#[test]
fn a_mirrored_picture_runs_back() {
    let mut model = Model::painted(json!({"name": "a"}));
    let texture = model.texture(&png(4, 1, &[[0; 4], [85; 4], [170; 4], [255; 4]]));
    model.json["samplers"] = json!([{"wrapS": 33648}]);
    model.json["textures"][texture]["sampler"] = json!(0);
    model.json["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": texture}});
    let scene = model.load();
    let used = material(&scene, "a").diffuse_texture.unwrap();
    let at = |u: f32| used.color(&scene.textures, Vec2::new(u, 0.5)).x;
    for u in [0.1, 0.3, 0.7, 0.95] {
        for other in [-u, 2.0 - u, 2.0 + u, u - 4.0] {
            assert!((at(u) - at(other)).abs() < 1e-4, "{u}, {other}");
        }
    }
}

/// A unit cube of glass, with the materials' extensions.
fn glass_cube(extensions: Value) -> Scene {
    let mut model = Model::empty();
    let corners: Vec<[f32; 3]> = (0..8u16).map(|i| [0, 1, 2].map(|axis| f32::from(i >> axis & 1))).collect();
    let faces: [u16; 36] = [
        0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1,
        7, 5,
    ];
    let position = model.accessor(&corners, F32, "VEC3");
    let indices = model.accessor(&faces, super::U16, "SCALAR");
    model.mesh(json!({"attributes": {"POSITION": position}, "indices": indices, "material": 0}));
    let clear = json!({"roughnessFactor": 0.0});
    model
        .push("materials", json!({"name": "glass", "pbrMetallicRoughness": clear, "extensions": extensions}));
    model.node(json!({"mesh": 0}));
    model.load()
}

#[test]
fn a_body_refracts_and_tints_only_with_a_volume() {
    let transmission = json!({"transmissionFactor": 1.0});
    let thin = glass_cube(json!({"KHR_materials_transmission": transmission}));
    assert!(thin.solids.iter().all(|side| *side == SolidSide::Thin));
    let volume =
        json!({"thicknessFactor": 0.5, "attenuationDistance": 0.25, "attenuationColor": [0.25, 1.0, 0.5]});
    let thick =
        glass_cube(json!({"KHR_materials_transmission": transmission, "KHR_materials_volume": volume}));
    assert!(thick.solids.iter().all(|side| *side == SolidSide::InsideBehind));
    // Two faces together: the colour to the power of two.
    let MaterialKind::Glass { transmittance, .. } = material(&thick, "glass").kind else { panic!() };
    assert!((transmittance - Vec3::new(0.25, 1.0, 0.5)).length() < 1e-6, "{transmittance}");
}

#[test]
fn a_tilted_camera_keeps_its_roll() {
    let mut model = Model::square();
    model.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 1.0}}));
    let half: f64 = 0.2;
    model.node(json!({"camera": 0, "translation": [0, 1, 5], "rotation": [0, 0, half.sin(), half.cos()]}));
    let scene = model.load();
    // Seen from behind, the camera is turned to the left.
    assert!((scene.views[0].camera.roll + 0.4).abs() < 1e-9, "{:?}", scene.views[0]);
    assert!(!doubts(&scene).iter().any(|d| d.contains("camera")), "{:?}", doubts(&scene));
    model.json["nodes"][1]["rotation"] = json!([0, 0, 0, 1]);
    assert_eq!(model.load().views[0].camera.roll, 0.0);
}

#[test]
fn hidden_nodes_are_left_out_and_said() {
    let mut model = Model::square();
    model.node(json!({"mesh": 0, "name": "ghost", "translation": [9, 0, 0],
        "extensions": {"KHR_node_visibility": {"visible": false}}}));
    let scene = model.load();
    assert_eq!(scene.triangles.len(), 2);
    assert!(warning(&scene, "KHR_node_visibility").2.contains("ghost"));
}

#[test]
fn a_bad_key_at_the_root_costs_only_itself() {
    for (key, value) in [
        ("animations", json!(7)),
        ("cameras", json!({"a": 1})),
        ("extensions", json!("a")),
        ("scene", json!("first")),
        ("asset", json!(7)),
    ] {
        let mut model = Model::square();
        model.json[key] = value;
        let scene = model.load();
        assert_eq!(scene.triangles.len(), 2, "{key}");
        assert!(warning(&scene, "key of the root").2.contains(key), "{key}");
    }
}

#[test]
fn a_stride_of_zero_is_none() {
    let mut model = Model::square();
    model.json["bufferViews"][0]["byteStride"] = json!(0);
    assert_eq!(doubts(&model.load()), Vec::<&str>::new());
}

#[test]
fn extensions_without_effect_are_named_with_it() {
    let mut model = Model::square();
    model.json["extensionsUsed"] = json!(["KHR_materials_unlit", "KHR_materials_sheen", "ACME_magic"]);
    let scene = model.load();
    assert!(warning(&scene, "KHR_materials_unlit").2.contains("lit like paint"));
    assert!(warning(&scene, "KHR_materials_sheen").2.contains("without its sheen"));
    assert!(warning(&scene, "ACME_magic").2.contains("not supported"));
}

/// A box with a door, in units of which a metre has `per_metre`.
fn house(per_metre: f64) -> Model {
    let mut model = Model::square();
    model.json["nodes"] = json!([]);
    model.json["scenes"][0]["nodes"] = json!([]);
    for (at, scale) in [
        ([0.0, 0.0, 0.0], [8.0, 6.0, 1.0]),
        ([1.0, 0.0, 1.0], [1.0, 2.0, 1.0]),
        ([0.0, 0.0, 5.0], [8.0, 3.0, 1.0]),
    ] {
        let scaled = |v: [f64; 3]| v.map(|c| c * per_metre);
        model.node(json!({"mesh": 0, "translation": scaled(at), "scale": scaled(scale)}));
    }
    model
}

#[test]
fn a_model_in_millimetres_becomes_a_house_and_says_so() {
    for (per_metre, name) in [(1000.0, "mm"), (1.0, "")] {
        let scene = house(per_metre).load();
        let [low, high] = scene.bounds_m;
        assert!(((high - low).x - 8.0).abs() < 0.01, "{per_metre}: {}", (high - low).x);
        let said = scene.warnings.iter().find(|w| w.message.contains("taken as"));
        assert_eq!(said.is_some(), !name.is_empty());
        assert!(said.is_none_or(|w| w.message.contains(name) && w.message.contains("--unit")));
    }
    // A landscape stays as large as it is.
    let mut flat = Model::square();
    flat.json["nodes"][0]["scale"] = json!([5000, 1, 1]);
    flat.json["nodes"][0]["rotation"] =
        json!([-std::f64::consts::FRAC_1_SQRT_2, 0, 0, std::f64::consts::FRAC_1_SQRT_2]);
    let scene = flat.load();
    assert!(!scene.warnings.iter().any(|w| w.message.contains("taken as")));
}

#[test]
fn weak_lamps_get_daylight_and_it_is_said() {
    let lamp = |radiance: f64| {
        let mut model = house(1.0);
        model.push("materials", json!({"name": "led", "emissiveFactor": [radiance, radiance, radiance]}));
        let position = model.accessor(&super::SQUARE, F32, "VEC3");
        let indices = model.accessor(&[0u16, 1, 2, 0, 2, 3], super::U16, "SCALAR");
        let mesh =
            model.mesh(json!({"attributes": {"POSITION": position}, "indices": indices, "material": 0}));
        model.node(json!({"mesh": mesh, "scale": [0.02, 0.02, 1.0], "translation": [3.0, 1.0, 4.9]}));
        model.load()
    };
    let dark = lamp(0.5);
    assert!(dark.sky.is_some() && warning(&dark, "too weak").2.contains("--sky none"));
    let bright = lamp(1.0);
    assert!(bright.sky.is_some());
    let mut lit = Model::square();
    lit.push("materials", json!({"name": "lamp", "emissiveFactor": [1, 1, 1]}));
    lit.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    assert!(lit.load().sky.is_none());
    assert!(load_text("{}").is_err());
}
