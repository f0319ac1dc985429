//! Lamps of glTF in photometric units, with measured profiles, and of one side.

use super::super::{Folder, doubts, warning};
use super::{Model, base64};
use afterimage::math::key::Key;
use afterimage::scene::{Light, Scene};
use afterimage::trace::{RayCounts, SurfacePoint};
use afterimage::{Camera, Tracer, View};
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::f32::consts::PI;
use std::sync::Arc;

/// A profile of type C: one line of intensities from the aim outwards.
pub(crate) fn profile(heights: &str, intensities: &str) -> String {
    let count = heights.split_whitespace().count();
    format!("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {count} 1 1 2 0 0 0\n1 1 0\n{heights}\n0\n{intensities}\n")
}

/// The middle of what a camera sees from `eye` along `towards`.
fn seen(tracer: &Tracer, eye: DVec3, towards: DVec3) -> SurfacePoint {
    let camera = Camera::look_at(eye, eye + towards, 30.0);
    let view = View::new(&camera, &tracer.scene().frame, [1, 1]);
    let ray = Tracer::primary_ray(&view, 0);
    tracer.surface(&ray, &tracer.closest(&ray).unwrap())
}

/// Illuminance in lux at the middle of the square, from its front or its back.
fn lux(scene: Scene, side: f64) -> Vec3 {
    let tracer = Tracer::new(Arc::new(scene));
    let point = seen(&tracer, DVec3::new(0.5, 0.5, side), DVec3::new(0.0, 1e-6, -side));
    tracer.irradiance(&point, 256, Key::of_pixel(1, 1), &mut RayCounts::default())
}

/// The square below a lamp 2 m in front of its middle, which shines towards it.
fn below(light: Value) -> Scene {
    let mut model = Model::square();
    model.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
    model.node(json!({"translation": [0.5, 0.5, 2], "extensions": {"KHR_lights_punctual": {"light": 0}}}));
    model.load()
}

#[test]
fn candela_and_lux_are_those_of_the_inverse_square_law() {
    let point = lux(below(json!({"type": "point", "intensity": 1000.0, "color": [1.0, 0.5, 0.25]})), 1.0);
    assert!((point / 250.0 - Vec3::new(1.0, 0.5, 0.25)).length() < 1e-4, "{point}");
    let spot = json!({"innerConeAngle": 0.3, "outerConeAngle": 0.6});
    let spot = lux(below(json!({"type": "spot", "intensity": 1000.0, "spot": spot})), 1.0);
    assert!((spot.x / 250.0 - 1.0).abs() < 1e-4, "{spot}");
    let sun = lux(below(json!({"type": "directional", "intensity": 50_000.0})), 1.0);
    assert!((sun.x / 50_000.0 - 1.0).abs() < 1e-4, "{sun}");
}

/// A square screen of 2 m, 1 m in front of the square that it faces or not.
fn screen(faces: bool, double_sided: bool) -> Scene {
    let mut model = Model::square();
    let corners = [[-0.5f32, -0.5, 1.0], [1.5, -0.5, 1.0], [1.5, 1.5, 1.0], [-0.5, 1.5, 1.0]];
    let position = model.accessor(&corners, super::F32, "VEC3");
    let order = if faces { [0u16, 2, 1, 0, 3, 2] } else { [0, 1, 2, 0, 2, 3] };
    let indices = model.accessor(&order, super::U16, "SCALAR");
    let material = model.push(
        "materials",
        json!({"name": "screen", "emissiveFactor": [1, 1, 1], "doubleSided": double_sided,
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 500.0}}}),
    );
    let mesh =
        model.mesh(json!({"attributes": {"POSITION": position}, "indices": indices, "material": material}));
    model.node(json!({"mesh": mesh}));
    model.load()
}

#[test]
fn nits_light_by_the_solid_angle_and_only_from_the_front() {
    // Four quarters of 1 m by 1 m at 1 m: the configuration factor of a point to a rectangle.
    let half = 0.5f32.sqrt();
    let quarter = (half * (half).atan() + half * (half).atan()) / (2.0 * PI);
    let expected = 500.0 * PI * 4.0 * quarter;
    for (faces, double_sided) in [(true, false), (true, true), (false, true), (false, false)] {
        let scene = screen(faces, double_sided);
        let is_one_sided = matches!(scene.lights[0], Light::Quad { has_one_side: true, .. });
        assert_eq!(is_one_sided, !double_sided);
        let found = lux(scene, 0.5).x;
        let expected = if faces || double_sided { expected } else { 0.0 };
        assert!((found - expected).abs() <= 0.003 * expected, "{faces} {double_sided}: {found}, {expected}");
    }
}

#[test]
fn the_back_of_a_lamp_of_one_side_is_dark() {
    for double_sided in [false, true] {
        let tracer = Tracer::new(Arc::new(screen(true, double_sided)));
        let from = |z: f64| seen(&tracer, DVec3::new(0.5, 0.5, z), DVec3::new(0.0, 1e-6, 1.0 - z));
        let emitted = |z: f64| from(z).emission(tracer.scene()).x;
        assert_eq!([emitted(0.5), emitted(2.0)], [500.0, if double_sided { 500.0 } else { 0.0 }]);
        let kind = if double_sided { "emissive" } else { "emissive, from its front" };
        assert!(tracer.scene().materials.iter().any(|m| m.kind_name() == kind));
    }
}

#[test]
fn a_screen_with_both_windings_of_one_material_emits_from_both_sides() {
    let mut model = Model::square();
    let material = model.push("materials", json!({"name": "screen", "emissiveFactor": [1, 1, 1]}));
    let corners = [[0.0f32, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    let position = model.accessor(&corners, super::F32, "VEC3");
    let indices = model.accessor(&[0u16, 1, 2, 0, 2, 1], super::U16, "SCALAR");
    let mesh =
        model.mesh(json!({"attributes": {"POSITION": position}, "indices": indices, "material": material}));
    model.node(json!({"mesh": mesh}));
    let tracer = Tracer::new(Arc::new(model.load()));
    for z in [0.5, 2.0] {
        let point = seen(&tracer, DVec3::new(0.3, 0.3, z), DVec3::new(0.0, 1e-6, 1.0 - z));
        assert_eq!(point.emission(tracer.scene()), Vec3::ONE, "from {z}");
    }
}

/// The square below a lamp with a profile, 2 m in front of its middle.
fn profiled(lamp: Value, node: Value) -> Model {
    let mut model = Model::square();
    model.json["extensionsUsed"] = json!(["EXT_lights_ies"]);
    model.json["extensions"] = json!({"EXT_lights_ies": {"lights": [lamp]}});
    model.node(json!({"translation": [0.5, 0.5, 2], "extensions": {"EXT_lights_ies": node}}));
    model
}

#[test]
fn an_even_profile_is_a_point_light() {
    let even = profile("0 90 180", "1000 1000 1000");
    let address = format!("data:application/x-ies-lm-63;base64,{}", base64(even.as_bytes()));
    let embedded = profiled(json!({"uri": address}), json!({"light": 0})).load();
    assert_eq!(doubts(&embedded), Vec::<&str>::new());
    let point = below(json!({"type": "point", "intensity": 1000.0}));
    assert_eq!(lux(embedded, 1.0), lux(point, 1.0));
    // In a file next to the model, with a factor and a colour.
    let node = json!({"light": 0, "multiplier": 2.0, "color": [1.0, 0.5, 0.0]});
    let text = profiled(json!({"uri": "even%20lamp.ies"}), node).embedded();
    let folder = Folder::with_obj("").add("scene.gltf", text).add("even lamp.ies", &even);
    let scene = folder.try_load_file("scene.gltf").unwrap();
    let found = lux(scene, 1.0);
    assert!((found / 500.0 - Vec3::new(1.0, 0.5, 0.0)).length() < 1e-5, "{found}");
}

#[test]
fn a_profile_shines_where_its_node_aims() {
    let narrow = profile("0 10 20", "1000 1000 0");
    let load = |rotation: Value| {
        let mut model =
            profiled(json!({"bufferView": 0, "mimeType": "application/x-ies-lm-63"}), json!({"light": 0}));
        let view = model.view(narrow.as_bytes());
        model.json["extensions"]["EXT_lights_ies"]["lights"][0]["bufferView"] = view.into();
        model.json["nodes"][1]["rotation"] = rotation;
        lux(model.load(), 1.0).x
    };
    assert!((load(json!([0, 0, 0, 1])) / 250.0 - 1.0).abs() < 1e-5);
    // Turned by 15 degrees, half of it arrives; by 60, nothing.
    let turned = |degrees: f64| {
        let (sin, cos) = (degrees.to_radians() / 2.0).sin_cos();
        load(json!([sin, 0, 0, cos]))
    };
    assert!((turned(15.0) / 125.0 - 1.0).abs() < 1e-3, "{}", turned(15.0));
    assert_eq!(turned(60.0), 0.0);
}

#[test]
fn profiles_that_cannot_be_read_are_reported_once() {
    let mut model = profiled(json!({"uri": "none.ies"}), json!({"light": 0}));
    model.node(json!({"extensions": {"EXT_lights_ies": {"light": 0}}}));
    let scene = model.load();
    let message = warning(&scene, "light profile").2;
    assert!(message.contains("none.ies") && message.contains("left out"), "{message}");
    let text = base64(b"TILT=NONE\n1 1 1 oops");
    let uri = format!("data:application/octet-stream;base64,{text}");
    let scene = profiled(json!({"uri": uri}), json!({"light": 0})).load();
    let message = warning(&scene, "light profile").2;
    assert!(message.contains("line 2") && message.contains("'oops'"), "{message}");
    for (lamp, node) in [
        (json!({}), json!({"light": 0})),
        (json!({"bufferView": 77}), json!({"light": 0})),
        (json!({"uri": "../outside.ies"}), json!({"light": 0})),
        (json!({"uri": uri}), json!({"light": 9})),
    ] {
        assert!(!doubts(&profiled(lamp, node).load()).is_empty());
    }
}
