//! Materials, pictures, lights and cameras.

use super::super::textures::png;
use super::super::{Folder, assert_clean, material, warning};
use super::Model;
use afterimage::scene::{Light, Material, MaterialKind, TextureRef};
use glam::{DVec3, Vec2, Vec3};
use serde_json::{Value, json};

fn paint(json: Value) -> Material {
    let mut json = json;
    json["name"] = "a".into();
    let scene = Model::painted(json).load();
    material(&scene, "a").clone()
}

fn pbr(pbr: Value) -> Value {
    json!({"pbrMetallicRoughness": pbr})
}

#[test]
fn metal_and_roughness_decide_the_kind() {
    let base = [0.5, 0.25, 0.125, 1.0];
    let of = |metal: f64, rough: f64| {
        paint(pbr(json!({"baseColorFactor": base, "metallicFactor": metal, "roughnessFactor": rough})))
    };
    let color = Vec3::new(0.5, 0.25, 0.125);
    let mirror = of(1.0, 0.0);
    assert_eq!(mirror.kind, MaterialKind::Mirror { reflectance: color, fresnel: false });
    assert_eq!(mirror.diffuse, Vec3::ZERO);
    let glossy = |metal, rough| {
        let material = of(metal, rough);
        let MaterialKind::Glossy { reflectance, roughness } = material.kind else { panic!("{material:?}") };
        assert_eq!(roughness, rough as f32);
        (reflectance, material.diffuse)
    };
    assert_eq!(glossy(1.0, 0.5), (color, Vec3::ZERO));
    let is_near = |a: Vec3, b: Vec3| (a - b).abs().max_element() < 1e-6;
    let (coat, base) = glossy(0.0, 0.0);
    assert!(is_near(coat, Vec3::splat(0.04)) && base == color);
    let (mixed, base) = glossy(0.5, 0.05);
    assert!(is_near(mixed, Vec3::splat(0.02) + color * 0.5) && base == color * 0.5);
    // A coat that is no glossier than exporters write by default is left out.
    for (metal, rough) in [(0.0, 0.5), (0.0, 1.0), (1.0, 1.0)] {
        assert_eq!((of(metal, rough).kind, of(metal, rough).diffuse), (MaterialKind::Diffuse, color));
    }
    // The defaults are metal, and rough.
    assert_eq!(paint(json!({})).kind, MaterialKind::Diffuse);
}

#[test]
fn a_picture_of_metal_and_roughness_counts_with_its_mean() {
    let with = |texel: [u8; 4]| {
        let mut model = Model::painted(json!({"name": "a"}));
        let texture = model.texture(&png(2, 2, &[texel]));
        model.json["materials"][0]["pbrMetallicRoughness"] =
            json!({"metallicRoughnessTexture": {"index": texture}});
        let scene = model.load();
        assert!(scene.textures.is_empty(), "it is not kept");
        material(&scene, "a").kind
    };
    assert!(matches!(with([0, 5, 255, 255]), MaterialKind::Mirror { .. }));
    let MaterialKind::Glossy { roughness, .. } = with([0, 128, 255, 255]) else { panic!("not rough") };
    assert!((roughness - 128.0 / 255.0).abs() < 1e-6);
    assert_eq!(with([0, 250, 255, 255]), MaterialKind::Diffuse);
    assert_eq!(with([0, 200, 0, 255]), MaterialKind::Diffuse);
}

/// A model of one material with a picture of 2 by 1 texels.
fn with_picture(texels: &[[u8; 4]], json: impl FnOnce(usize) -> Value) -> Model {
    let mut model = Model::painted(json!({"name": "a"}));
    let texture = model.texture(&png(2, 1, texels));
    let mut painted = json(texture);
    painted["name"] = "a".into();
    model.json["materials"][0] = painted;
    model
}

#[test]
fn metal_and_roughness_that_vary_hold_for_each_place() {
    let rusty = [[0, 255, 0, 255], [0, 51, 255, 255]];
    let info = |i: usize| json!({"index": i});
    let of = |texels: &[[u8; 4]], factor: f64| {
        let base = [0.5, 0.25, 0.125, 1.0];
        let json = |i| {
            pbr(
                json!({"baseColorFactor": base, "roughnessFactor": factor, "metallicRoughnessTexture": info(i)}),
            )
        };
        let scene = with_picture(texels, json).load();
        let paint = material(&scene, "a").clone();
        [0.25, 0.75].map(|u| {
            let place = paint.at(&scene.textures, || Vec2::new(u, 0.5)).into_owned();
            (place.kind, place.diffuse)
        })
    };
    let [rust, metal] = of(&rusty, 0.5);
    let color = Vec3::new(0.5, 0.25, 0.125);
    assert!(
        matches!(rust.0, MaterialKind::Glossy { roughness: 0.5, reflectance } if (reflectance - 0.04).abs().max_element() < 1e-6)
    );
    assert_eq!(rust.1, color);
    assert_eq!(metal, (MaterialKind::Glossy { reflectance: color, roughness: 0.5 * 0.2 }, Vec3::ZERO));
    // Where no place is smoother than satin, the surface is matte.
    let [matte, _] = of(&[[0, 200, 0, 255], [0, 255, 0, 255]], 1.0);
    assert_eq!(matte, (MaterialKind::Diffuse, color));
}

#[test]
fn metal_has_the_picture_of_its_colour() {
    let texels = [[255, 0, 0, 255], [0, 0, 255, 255]];
    let json = |i: usize| pbr(json!({"baseColorTexture": {"index": i}, "roughnessFactor": 0.3}));
    let scene = with_picture(&texels, json).load();
    let metal = material(&scene, "a");
    assert_eq!((metal.kind_name(), metal.types().0), ("rough metal", "Type 2"));
    let at = |u: f32| metal.at(&scene.textures, || Vec2::new(u, 0.5)).specular();
    assert_eq!([at(0.25), at(0.75)], [Vec3::X, Vec3::Z]);
}

#[test]
fn normal_maps_keep_their_strength_and_place() {
    let json = |i: usize| {
        let mut json = pbr(json!({"metallicFactor": 0.0}));
        let transform = json!({"KHR_texture_transform": {"scale": [2.0, 3.0]}});
        json["normalTexture"] = json!({"index": i, "scale": 0.5, "extensions": transform});
        json
    };
    let scene = with_picture(&[[255, 128, 128, 255], [128, 128, 255, 255]], json).load();
    let map = material(&scene, "a").detail.normal.expect("a normal map");
    assert_eq!((map.strength, map.texture.scale), (0.5, Vec2::new(2.0, 3.0)));
    assert!(scene.features.normal_maps && !scene.uvs.is_empty());
    let direction = |u: f32| map.direction(&scene.textures, Vec2::new(u / 2.0, 0.0));
    assert_eq!([direction(0.25), direction(0.75)], [Vec3::X * 0.5, Vec3::Z]);
}

#[test]
fn a_picture_of_transmission_makes_panes_in_a_frame() {
    let json = |i: usize| {
        let color = [0.5, 0.25, 0.25, 1.0];
        let mut json = pbr(json!({"baseColorFactor": color, "metallicFactor": 0.0, "roughnessFactor": 0.0}));
        let through = json!({"transmissionFactor": 1.0, "transmissionTexture": {"index": i}});
        json["extensions"] = json!({"KHR_materials_transmission": through});
        json
    };
    let scene = with_picture(&[[255, 0, 0, 255], [0, 0, 0, 255]], json).load();
    let window = material(&scene, "a");
    let color = Vec3::new(0.5, 0.25, 0.25);
    let at = |u: f32| {
        let place = window.at(&scene.textures, || Vec2::new(u, 0.5)).into_owned();
        (place.diffuse, place.specular())
    };
    assert_eq!([at(0.25), at(0.75)], [(Vec3::ZERO, color), (color, Vec3::ZERO)]);
}

#[test]
fn coats_follow_their_extensions() {
    let with = |extensions: Value| {
        let mut json = pbr(json!({"metallicFactor": 0.0, "roughnessFactor": 0.9}));
        json["extensions"] = extensions;
        paint(json).kind
    };
    assert_eq!(with(json!({})), MaterialKind::Diffuse);
    let coat = json!({"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.1});
    let reflectance = Vec3::splat(0.02);
    let varnished = with(json!({"KHR_materials_clearcoat": coat}));
    assert_eq!(varnished, MaterialKind::Glossy { reflectance, roughness: 0.1 });
    let mut json = pbr(json!({"metallicFactor": 0.0, "roughnessFactor": 0.25}));
    json["extensions"] = json!({
        "KHR_materials_ior": {"ior": 2.0},
        "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1.0, 0.5, 0.0]},
    });
    let MaterialKind::Glossy { reflectance, roughness: 0.25 } = paint(json).kind else { panic!("no coat") };
    assert!((reflectance - Vec3::new(1.0, 0.5, 0.0) / 18.0).abs().max_element() < 1e-6, "{reflectance}");
}

#[test]
fn transmission_is_glass_and_the_rest_stays_diffuse() {
    let glass = |factor: f64, ior: Value| {
        let color = [1.0, 0.5, 0.5, 1.0];
        let smooth = json!({"baseColorFactor": color, "metallicFactor": 0.0, "roughnessFactor": 0.0});
        let mut json = pbr(smooth);
        json["extensions"] =
            json!({"KHR_materials_transmission": {"transmissionFactor": factor}, "KHR_materials_ior": ior});
        paint(json)
    };
    let clear = glass(1.0, json!({"ior": 1.25}));
    assert_eq!(clear.kind, MaterialKind::Glass { eta: 1.25, transmittance: Vec3::new(1.0, 0.5, 0.5) });
    assert_eq!(clear.diffuse, Vec3::ZERO);
    let milky = glass(0.25, json!({}));
    assert_eq!(milky.kind, MaterialKind::Glass { eta: 1.5, transmittance: Vec3::new(0.25, 0.125, 0.125) });
    assert_eq!(milky.diffuse, Vec3::new(0.75, 0.375, 0.375));
}

#[test]
fn rough_transmission_is_frosted() {
    let mut json = pbr(json!({"metallicFactor": 0.0, "roughnessFactor": 0.5}));
    json["extensions"] = json!({"KHR_materials_transmission": {"transmissionFactor": 1.0}});
    let frosted = MaterialKind::Frosted { eta: 1.5, transmittance: Vec3::ONE, roughness: 0.5 };
    assert_eq!(paint(json).kind, frosted);
}

#[test]
fn emission_is_a_light_of_that_radiance() {
    let mut model = Model::painted(json!({
        "name": "lamp", "emissiveFactor": [1.0, 0.5, 0.0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8.0}},
    }));
    let scene = model.load();
    let [Light::Quad { radiance, .. }] = scene.lights[..] else { panic!("{:?}", scene.lights) };
    assert_eq!(radiance, Vec3::new(8.0, 4.0, 0.0));
    // Half of the picture glows.
    let texture = model.texture(&png(2, 1, &[[255; 4], [0, 0, 0, 255]]));
    model.json["materials"][0]["emissiveTexture"] = json!({"index": texture});
    let scene = model.load();
    let lamp = material(&scene, "lamp");
    let at = |u: f32| lamp.emission_at(&scene.textures, || Vec2::new(u, 0.5));
    assert_eq!([at(0.25), at(0.75)], [Vec3::new(8.0, 4.0, 0.0), Vec3::ZERO]);
    assert!(matches!(&scene.lights[..], [Light::Triangles { picture: Some(_), .. }]), "{:?}", scene.lights);
}

const CHESS: [[u8; 4]; 4] = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];

fn colored(transform: Value) -> Model {
    let mut model = Model::painted(json!({"name": "a"}));
    let texture = model.texture(&png(2, 2, &CHESS));
    let info = json!({"index": texture, "extensions": {"KHR_texture_transform": transform}});
    model.json["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorTexture": info});
    model
}

#[test]
fn pictures_are_upright_wherever_they_are_stored() {
    let check = |scene: &afterimage::Scene| {
        assert_clean(scene);
        let used = material(scene, "a").diffuse_texture.unwrap();
        let texture = &scene.textures[used.texture.0 as usize];
        // The corner at the origin shows the lower left texel of the picture, blue.
        let corner =
            scene.positions.iter().position(|p| scene.frame.world_from_scene(*p).length() < 1e-6).unwrap();
        let uv = scene.uvs[corner] * used.scale + used.offset;
        assert!((texture.color(uv + Vec2::new(0.25, 0.25)) - Vec3::Z).length() < 1e-3, "{uv}");
    };
    let mut model = colored(json!({}));
    check(&model.load());
    model.json["images"][0] =
        json!({"uri": format!("data:image/png;base64,{}", super::base64(&png(2, 2, &CHESS)))});
    check(&model.load());
    model.json["images"][0] = json!({"uri": "textures%2Fmy%20wood.png"});
    let folder = Folder::with_obj("")
        .add("scene.gltf", model.embedded())
        .add("textures/my wood.png", png(2, 2, &CHESS));
    check(&folder.try_load_file("scene.gltf").unwrap());
}

#[test]
fn a_texture_transform_moves_downwards_as_gltf_counts() {
    // Half the size, moved down by half: the square shows only the lower left texel.
    let scene = colored(json!({"scale": [0.5, 0.5], "offset": [0.0, 0.5]})).load();
    let used = material(&scene, "a").diffuse_texture.unwrap();
    let of = |uv: Vec2| scene.textures[0].color(uv * used.scale + used.offset);
    assert!((of(Vec2::splat(0.5)) - Vec3::Z).length() < 1e-3, "{used:?}");
    // A quarter turn: what lay to the right lies below.
    let scene = colored(json!({"rotation": std::f64::consts::FRAC_PI_2})).load();
    let turned = material(&scene, "a").diffuse_texture.unwrap();
    let plain = TextureRef::plain(turned.texture);
    // In glTF, u' = v and v' = -u, with v downwards.
    for [u, v] in [[0.3f32, 0.2], [0.8, 0.1], [0.4, 0.9]] {
        let down = [v, -u];
        let expected = plain.color(&scene.textures, Vec2::new(down[0], 1.0 - down[1]));
        let found = turned.color(&scene.textures, Vec2::new(u, 1.0 - v));
        assert!((found - expected).length() < 1e-3, "{u}, {v}: {found}, {expected}");
    }
}

fn with_alpha(alpha: Value, texels: &[[u8; 4]]) -> (afterimage::Scene, Material) {
    let mut json = alpha;
    json["name"] = "a".into();
    let mut model = Model::painted(json);
    let texture = model.texture(&png(2, 1, texels));
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": texture});
    let scene = model.load();
    let material = material(&scene, "a").clone();
    (scene, material)
}

#[test]
fn a_mask_cuts_at_its_cutoff() {
    let texels = [[255, 255, 255, 90], [255, 255, 255, 110]];
    for (cutoff, kept) in [(0.5, [false, false]), (0.4, [false, true]), (0.3, [true, true])] {
        let (scene, material) = with_alpha(json!({"alphaMode": "MASK", "alphaCutoff": cutoff}), &texels);
        let mask = &scene.textures[material.alpha_texture.unwrap().texture.0 as usize];
        let is_kept = |u: f32| mask.alpha(Vec2::new(u, 0.5)) >= 0.5;
        assert_eq!([is_kept(0.25), is_kept(0.75)], kept, "{cutoff}");
    }
    let (_, opaque) = with_alpha(json!({"alphaMode": "OPAQUE"}), &texels);
    assert_eq!(opaque.alpha_texture, None);
}

#[test]
fn a_blend_attenuates_evenly_or_by_its_picture() {
    let thin = paint(
        json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1.0, 1.0, 1.0, 0.25]}}),
    );
    assert_eq!(thin.kind, MaterialKind::Glass { eta: 1.0, transmittance: Vec3::splat(0.75) });
    assert_eq!(thin.diffuse, Vec3::splat(0.25));
    // Holes need no blending.
    let (_, cut) = with_alpha(json!({"alphaMode": "BLEND"}), &[[255, 255, 255, 0], [255, 255, 255, 255]]);
    assert!(cut.alpha_texture.is_some() && cut.coverage_texture.is_none());
    let (scene, sheer) =
        with_alpha(json!({"alphaMode": "BLEND"}), &[[255, 255, 255, 80], [255, 255, 255, 200]]);
    let at = |u: f32| sheer.coverage_at(&scene.textures, || Vec2::new(u, 0.5));
    assert_eq!([at(0.25), at(0.75)].map(|a| (a * 255.0).round()), [80.0, 200.0]);
    assert!(sheer.is_glass() && sheer.alpha_texture.is_none());
}

#[test]
fn values_out_of_range_are_clamped_and_reported() {
    let mut model =
        Model::painted(pbr(json!({"baseColorFactor": [2.0, -1.0, 0.5, 1.0], "metallicFactor": 0.0})));
    model.json["materials"][0]["name"] = "a".into();
    let scene = model.load();
    assert_eq!(material(&scene, "a").diffuse, Vec3::new(1.0, 0.0, 0.5));
    assert!(warning(&scene, "out of range").2.starts_with("2 "));
}

#[test]
fn lights_and_cameras_have_the_transforms_of_their_nodes() {
    let mut model = Model::square();
    model.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "color": [1.0, 0.5, 0.25], "intensity": 40.0},
        {"type": "directional", "intensity": 3.0},
        {"type": "spot", "intensity": 2.0, "spot": {}},
        {"type": "directional"}, {"type": "laser"},
    ]}});
    let light = |i: usize| json!({"KHR_lights_punctual": {"light": i}});
    model.node(json!({"translation": [0.0, 3.0, 0.0], "extensions": light(0)}));
    // A quarter turn about X: -Z becomes +Y, so the light comes from below.
    let turn = [std::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2];
    model.node(json!({"rotation": turn, "extensions": light(1)}));
    for i in 2..5 {
        model.node(json!({"extensions": light(i)}));
    }
    model.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}));
    model.push("cameras", json!({"type": "orthographic"}));
    model.node(json!({"name": "hall", "camera": 0, "translation": [5.0, 6.0, 7.0], "rotation": turn}));
    model.node(json!({"camera": 1}));
    let scene = model.load();
    let square = scene.frame.units_per_metre.powi(2) as f32;
    let Light::Point { position, intensity, .. } = scene.lights[0] else { panic!("{:?}", scene.lights) };
    assert!(scene.frame.world_from_scene(position).distance(DVec3::new(0.0, 3.0, 0.0)) < 1e-3);
    assert!((intensity / square - Vec3::new(40.0, 20.0, 10.0)).length() < 1e-3);
    let sun = scene.lights.iter().find_map(|l| match l {
        Light::Sun { direction, irradiance, .. } => Some((*direction, *irradiance)),
        _ => None,
    });
    let (direction, irradiance) = sun.unwrap();
    assert!((direction - Vec3::NEG_Y).length() < 1e-5 && irradiance == Vec3::splat(3.0), "{direction}");
    let camera = &scene.views[0];
    assert_eq!((camera.name.as_str(), camera.camera.eye), ("hall", DVec3::new(5.0, 6.0, 7.0)));
    assert!((camera.camera.forward() - DVec3::Y).length() < 1e-6 && (camera.camera.fov_y - 1.0).abs() < 1e-9);
    for doubt in ["after the first", "without a known type", "without perspective"] {
        warning(&scene, doubt);
    }
}

#[test]
fn the_settings_file_overrides_the_model() {
    let mut model = Model::painted(json!({"name": "a"}));
    model.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 1.0}}));
    model.node(json!({"name": "theirs", "camera": 0}));
    let toml = "[[material]]\nname = \"a\"\nkind = \"mirror\"\n[start]\neye = [1, 2, 3]\nat = [0, 0, 0]\n";
    let folder = Folder::with_obj("").add("scene.gltf", model.embedded()).add("scene.afterimage.toml", toml);
    let scene = folder.try_load_file("scene.gltf").unwrap();
    assert!(matches!(material(&scene, "a").kind, MaterialKind::Mirror { .. }));
    assert_eq!(scene.start().eye, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(scene.views[1].name, "theirs");
}
