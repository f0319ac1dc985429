//! What `inspect` answers.

use super::{Bench, assert_keys, keys};
use serde_json::json;

#[test]
fn inspect_answers_with_the_contract() {
    let bench = Bench::new();
    let answer = bench.json("inspect room.obj --json");
    let wanted = [
        "triangles",
        "vertices",
        "materials",
        "lights",
        "bounds_m",
        "building_m",
        "start_view",
        "origin_m",
        "needs",
        "left_out",
        "warnings",
    ];
    assert_keys(&answer, &wanted);
    assert_eq!((&answer["triangles"], &answer["lights"]), (&json!(16), &json!(1)));
    assert_eq!(answer["bounds_m"], json!([[-2.0, 0.0, -4.0], [2.0, 3.0, 4.0]]));
    assert_eq!(
        keys(&answer["needs"]),
        [
            "mirror",
            "glass",
            "glossy",
            "frosted",
            "normal_maps",
            "varied",
            "textures",
            "alpha",
            "area_lights",
            "many_lights",
            "light_profiles",
            "sky",
            "needles",
            "coincident"
        ]
    );
    let kinds: Vec<_> = answer["materials"].as_array().unwrap().iter().map(|m| m["kind"].clone()).collect();
    assert_eq!(kinds, ["diffuse", "mirror", "emissive"]);
}

#[test]
fn unit_and_up_axis_are_applied() {
    let bench = Bench::new();
    let answer = bench.json("inspect room.obj --json --unit cm --up +Z");
    let upper = answer["bounds_m"][1].as_array().unwrap().iter().map(|v| v.as_f64().unwrap());
    // The model's Y becomes Z and its Z becomes -Y: the height of 3 lies along Z, the length of 8
    // along Y.
    let expected = [0.02, 0.04];
    for (found, wanted) in upper.zip(expected) {
        assert!((found - wanted).abs() < 1e-9, "{answer}");
    }
}
