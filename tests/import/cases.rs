//! The situations of `../shared/cases`, where they are present: what its page `CASES.md` expects is
//! checked in the report and in the scene of the importer. How they look is checked by eye.

use super::{doubts, material};
use afterimage::Camera;
use afterimage::import::{ImportOptions, load};
use afterimage::scene::{Light, Material, MaterialKind, Scene, SceneError, Wrap};
use std::io::Write as _;
use std::path::Path;

/// Loads a file of a case; `None`, with a message, where the cases are absent.
fn try_case(name: &str) -> Option<Result<Scene, SceneError>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases");
    if !folder.is_dir() {
        // Written directly: the test runner hides the output of passing tests.
        let _ = writeln!(std::io::stderr(), "skipped: {} is absent", folder.display());
        return None;
    }
    Some(load(&folder.join(name), &ImportOptions::default(), &|_, _| true))
}

fn case(name: &str) -> Option<Scene> {
    try_case(name).map(|outcome| outcome.unwrap_or_else(|error| panic!("{name}: {error}")))
}

fn is_said(scene: &Scene, part: &str) -> bool {
    scene.warnings.iter().any(|warning| warning.message.contains(part))
}

fn size_m(scene: &Scene) -> f64 {
    (scene.bounds_m[1] - scene.bounds_m[0]).length()
}

fn is_matte(material: &Material) -> bool {
    material.kind == MaterialKind::Diffuse
}

fn is_textured(material: &Material) -> bool {
    material.diffuse_texture.is_some()
}

/// True where light passes the surface, in whole or in part.
fn is_see_through(material: &Material) -> bool {
    matches!(material.kind, MaterialKind::Glass { .. } | MaterialKind::Frosted { .. })
}

#[test]
fn case_01_materials_of_maya_are_opaque_pictures() {
    for name in ["01-maya-illum4/house.obj", "01-maya-illum4/plain.obj"] {
        let Some(scene) = case(name) else { return };
        assert!(!scene.materials.iter().any(is_see_through), "{name}: {:?}", scene.materials);
        assert!(is_said(&scene, "taken as matte") || is_said(&scene, "Maya"), "{name}: {:?}", doubts(&scene));
    }
    let Some(scene) = case("01-maya-illum4/house.obj") else { return };
    assert!(scene.materials.iter().filter(|m| is_textured(m)).all(|m| m.diffuse.min_element() > 0.5));
}

#[test]
fn case_03_smoothing_groups_round_a_column() {
    let Some(scene) = case("03-smoothing-groups/column.obj") else { return };
    let corner_normals = |t: u32| scene.triangles[t as usize].map(|v| scene.normals[v as usize]);
    let is_round = |t: &u32| {
        let [a, b, c] = corner_normals(*t);
        a != b || b != c
    };
    let all = 0..scene.triangles.len() as u32;
    let round = all.clone().filter(is_round).count();
    assert!(round > 0 && round < all.count(), "the column is round, the plinth hard: {round}");
}

#[test]
fn case_04_decimal_commas_are_read_and_named() {
    let Some(scene) = case("04-decimal-comma/house.obj") else { return };
    assert!(is_said(&scene, "decimal commas"), "{:?}", doubts(&scene));
    assert!((1.0..100.0).contains(&size_m(&scene)), "{}", size_m(&scene));
}

#[test]
fn case_05_millimetres_in_gltf_are_guessed_and_said() {
    let Some(scene) = case("05-gltf-millimetres/house.gltf") else { return };
    assert!((3.0..60.0).contains(&size_m(&scene)), "{}", size_m(&scene));
    assert!(is_said(&scene, "taken as mm"), "{:?}", doubts(&scene));
}

#[test]
fn case_06_specular_and_glossiness_are_read() {
    let Some(scene) = case("06-spec-gloss/room.gltf") else { return };
    assert!(is_textured(material(&scene, "bricks")));
    let oak = material(&scene, "oak").diffuse;
    assert!(oak.x > 2.0 * oak.z, "brown: {oak}");
    assert!(is_see_through(material(&scene, "glazing")));
}

#[test]
fn case_07_lamps_of_any_unit_are_exposed_and_spots_are_spots() {
    for name in ["blender1000W", "blender1000W-spot", "lamp64cd", "sun80000lx"] {
        let Some(scene) = case(&format!("07-punctual-units/{name}.gltf")) else { return };
        let lights = scene.lights.iter().filter(|light| matches!(light, Light::Point { .. })).count();
        assert!(lights == 1 || scene.sun.is_some(), "{name}: {:?}", scene.lights);
        if name.ends_with("spot") {
            assert!(matches!(scene.lights[0], Light::Point { beam: Some(_), .. }), "{:?}", scene.lights);
        }
    }
}

#[test]
fn case_08_compressed_files_are_shown() {
    for name in ["fallback", "meshopt-fallback", "unused"] {
        let Some(scene) = case(&format!("08-draco-fallback/{name}.gltf")) else { return };
        assert!(scene.triangles.len() > 2, "{name}");
        // The compressed form of one of them is empty: its fallback is shown, and that is said.
        let is_empty = name == "meshopt-fallback";
        assert_eq!(doubts(&scene).len(), usize::from(is_empty), "{name}: {:?}", doubts(&scene));
    }
}

/// Its views claim to be compressed, and hold plain numbers: there is nothing to decode.
#[test]
fn case_08_a_file_without_its_compressed_data_is_refused_with_the_cause() {
    let Some(outcome) = try_case("08-draco-fallback/khr-meshopt.gltf") else { return };
    let error = outcome.map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("compressed ranges of data that cannot be decoded"), "{error}");
}

#[test]
fn case_09_instances_are_placed() {
    let Some(hall) = case("09-gpu-instancing/hall.gltf") else { return };
    let Some(required) = case("09-gpu-instancing/hall-required.gltf") else { return };
    let of_stone = |scene: &Scene| {
        let is_stone = |t: &u32| scene.material_of(*t).name == "stone";
        (0..scene.triangles.len() as u32).filter(is_stone).count()
    };
    assert!(of_stone(&hall) >= 9 && of_stone(&hall).is_multiple_of(9), "{}", of_stone(&hall));
    assert_eq!(of_stone(&hall), of_stone(&required));
}

#[test]
fn case_10_a_screen_shows_its_picture() {
    for name in ["10-emissive-screen/tv.gltf", "10-emissive-screen/tv.obj"] {
        let Some(scene) = case(name) else { return };
        let shows = |m: &&Material| m.emission_texture.is_some() && m.emission.max_element() > 0.0;
        assert_eq!(scene.materials.iter().filter(shows).count(), 1, "{name}");
    }
}

#[test]
fn case_12_samplers_clamp_mirror_and_show_texels() {
    let Some(scene) = case("12-sampler-clamp/panels.gltf") else { return };
    let sampling = |name: &str| material(&scene, name).diffuse_texture.unwrap().sampling;
    assert_eq!(sampling("clamp").wrap, [Wrap::Clamp; 2]);
    assert_eq!(sampling("mirror").wrap, [Wrap::Mirror; 2]);
    assert!(sampling("nearest").is_nearest && !sampling("clamp").is_nearest);
}

#[test]
fn case_17_blended_panes_are_seen_through() {
    let Some(scene) = case("17-blend-default-metal/panes.gltf") else { return };
    for name in ["pane, metallic left out", "pane, metallic 0"] {
        let MaterialKind::Glass { transmittance, .. } = material(&scene, name).kind else {
            panic!("{:?}", material(&scene, name))
        };
        assert!((transmittance.max_element() - 0.75).abs() < 0.01, "{name}: {transmittance}");
    }
}

#[test]
fn case_18_frosted_panes_are_frosted() {
    let Some(scene) = case("18-frosted/panes.gltf") else { return };
    let MaterialKind::Frosted { roughness, .. } = material(&scene, "frosted").kind else {
        panic!("{:?}", material(&scene, "frosted"))
    };
    assert!((roughness - 0.6).abs() < 1e-3, "{roughness}");
}

#[test]
fn case_26_a_picture_of_ambient_light_alone_is_shown_or_named() {
    let Some(scene) = case("26-map-ka-only/house.obj") else { return };
    assert!(is_said(&scene, "map_Ka"), "{:?}", doubts(&scene));
}

#[test]
fn case_30_pictures_of_all_formats_are_shown() {
    for name in ["pictures.obj", "webp-fallback.gltf", "webp-required.gltf"] {
        let Some(scene) = case(&format!("30-image-formats/{name}")) else { return };
        assert!(!is_said(&scene, "checker"), "{name}: {:?}", doubts(&scene));
        assert!(scene.materials.iter().any(is_textured), "{name}");
    }
}

/// There is no orthographic camera: the report says so, and the plan is left out.
#[test]
fn case_32_cameras_are_views_or_named() {
    let Some(scene) = case("32-cameras/room.gltf") else { return };
    assert!(is_said(&scene, "orthographic"), "{:?}", doubts(&scene));
    let view = |name: &str| scene.views.iter().find(|view| view.name == name).map(|view| view.camera);
    assert!(view("cam").is_some() && view("Plan").is_none());
    let rolled: Camera = view("Rolled").unwrap();
    assert!((rolled.fov_y - 1.2).abs() < 1e-9 && rolled.pitch.abs() < 1e-9);
    // The node turns its camera by 2 asin(0.19866...) about the direction behind it.
    let turned = 2.0 * 0.198_669_330_795_061_22f64.asin();
    assert!((rolled.roll.abs() - turned).abs() < 1e-9, "{}", rolled.roll);
    assert!(rolled.world_from_camera().y_axis.x < 0.0, "to the left");
}

#[test]
fn case_34_blocks_are_thin_or_green() {
    let Some(scene) = case("34-volume/blocks.gltf") else { return };
    assert!(material(&scene, "thin block").is_thin);
    let green = material(&scene, "green block");
    let MaterialKind::Glass { eta, transmittance } = green.kind else { panic!("{green:?}") };
    assert!(!green.is_thin && (eta - 1.5).abs() < 1e-3);
    assert!(transmittance.y > 1.5 * transmittance.x, "{transmittance}");
}

#[test]
fn case_36_a_house_with_one_led_gets_daylight() {
    let Some(scene) = case("36-one-led/house.gltf") else { return };
    assert!(scene.sun.is_some());
    assert!(is_said(&scene, "sun") && is_said(&scene, "sky"), "{:?}", doubts(&scene));
}

#[test]
fn case_38_a_sheer_curtain_is_there() {
    let Some(scene) = case("38-curtain/room.gltf") else { return };
    let curtain = material(&scene, "curtain");
    assert!(!curtain.is_opaque() && curtain.diffuse.max_element() > 0.0, "{curtain:?}");
}

#[test]
fn case_39_a_stray_vertex_decides_nothing() {
    for name in ["39-stray-vertex/house.obj", "39-stray-vertex/house-without.obj"] {
        let Some(scene) = case(name) else { return };
        assert!((3.0..30.0).contains(&size_m(&scene)), "{name}: {}", size_m(&scene));
    }
}

#[test]
fn case_43_glass_on_everything_is_believed_nowhere() {
    for name in ["43-illum-all-some-dark/house.obj", "43-illum-all-some-dark/all-bright.obj"] {
        let Some(scene) = case(name) else { return };
        let shiny: Vec<&Material> = scene.materials.iter().filter(|m| !is_matte(m)).collect();
        assert!(shiny.is_empty(), "{name}: {shiny:?}");
        assert!(is_said(&scene, "taken as matte"), "{name}: {:?}", doubts(&scene));
    }
}

#[test]
fn case_45_all_lamps_are_there() {
    for count in [1, 100, 400] {
        let Some(scene) = case(&format!("45-many-lights/lights{count}.gltf")) else { return };
        assert_eq!(scene.lights.len(), count);
    }
}

#[test]
fn case_46_walls_have_two_sides() {
    for name in ["46-two-sided-faces/room.obj", "46-two-sided-faces/room-same-start.obj"] {
        let Some(scene) = case(name) else { return };
        assert!(scene.coincident.iter().any(|is_marked| *is_marked), "{name}");
    }
}
