//! Material libraries: their meaning, and the usual mistakes of exporters.

use super::textures::png;
use super::{Folder, TRIANGLE, assert_clean, material, warning};
use afterimage::scene::{Material, MaterialKind, Scene};
use glam::{Vec2, Vec3};

/// Eight matte materials. Next to them, a few mirrors are plausible.
const MATTE: &str =
    "newmtl m1\nnewmtl m2\nnewmtl m3\nnewmtl m4\nnewmtl m5\nnewmtl m6\nnewmtl m7\nnewmtl m8\n";

fn load(mtl: &str) -> Scene {
    Folder::with_mtl(&["a"], format!("{MATTE}newmtl a\n{mtl}")).load()
}

fn material_a(mtl: &str) -> Material {
    material(&load(mtl), "a").clone()
}

fn glass(m: &Material) -> (f32, [f32; 3]) {
    match m.kind {
        MaterialKind::Glass { eta, transmittance } => (eta, transmittance.to_array()),
        other => panic!("not glass: {other:?}"),
    }
}

#[test]
fn illum_decides_the_kind() {
    for illum in ["", "illum 0", "illum 1", "illum 2", "illum 10"] {
        let m = material_a(&format!("Kd 0.5 0.5 0.5\nKs 0.4 0.4 0.4\n{illum}\n"));
        assert_eq!((m.kind, m.diffuse), (MaterialKind::Diffuse, Vec3::splat(0.5)), "{illum}");
    }
    for (illum, fresnel) in [(3, false), (5, true), (8, false)] {
        let m = material_a(&format!("Kd 0.05 0.05 0.05\nKs 0.9 0.8 0.7\nillum {illum}\n"));
        let reflectance = Vec3::new(0.9, 0.8, 0.7);
        assert_eq!(m.kind, MaterialKind::Mirror { reflectance, fresnel });
        assert_eq!(m.diffuse, Vec3::splat(0.05));
    }
    for illum in [4, 6, 7, 9] {
        let m = material_a(&format!("Kd 0 0 0\nNi 1.33\nTf 0.9 0.8 0.7\nillum {illum}\n"));
        assert_eq!(glass(&m), (1.33, [0.9, 0.8, 0.7]));
    }
    assert_eq!(material_a("Ks 0 0 0\nillum 3\n").kind, MaterialKind::Diffuse);
}

#[test]
fn one_value_is_grey() {
    let scene = load("Kd 0.25\n");
    assert_clean(&scene);
    assert_eq!(material(&scene, "a").diffuse, Vec3::splat(0.25));
}

#[test]
fn only_a_line_that_cannot_be_read_is_lost() {
    let bad = [
        "Kd spectral f.rfl",
        "d -halo 0.5",
        "illum 2.0",
        "Kd nan 0 0",
        "Kd 0.1 inf 0",
        "Kd 0.1 0.2",
        "Ni",
        "Kd xyz 1 2 3",
    ];
    for line in bad {
        let scene = load(&format!("Kd 0.25 0.5 0.75\n{line}\nKe 0 0 0\n"));
        assert_eq!(material(&scene, "a").diffuse.to_array(), [0.25, 0.5, 0.75], "{line}");
        let (file, number, message) = warning(&scene, "cannot be read");
        assert_eq!((file, number), ("scene.mtl", 11), "{line}");
        assert!(message.contains("; skipped"), "{message}");
    }
}

#[test]
fn bad_lines_are_counted_in_one_warning() {
    let scene = load("Kd a\nKs b\nKe c\n");
    let (_, line, message) = warning(&scene, "cannot be read");
    assert_eq!(line, 10);
    assert_eq!(message, "3 lines with values that cannot be read, first in line 10 (kd a); skipped");
}

#[test]
fn negative_values_are_black() {
    let scene = load("Kd -1 0.5 0.5\n");
    assert_eq!(material(&scene, "a").diffuse.to_array(), [0.0, 0.5, 0.5]);
    assert_eq!(warning(&scene, "negative").1, 10);
}

#[test]
fn d_overrides_tr_and_makes_other_materials_than_glass_translucent() {
    let m = material_a("Kd 0.8 0.8 0.8\nd 0.75\nTr 0.9\nillum 2\n");
    assert_eq!(glass(&m), (1.0, [0.25; 3]));
    assert!((m.diffuse - Vec3::splat(0.6)).length() < 1e-6);
    let m = material_a("Kd 0.8 0.8 0.8\nTr 0.25\n");
    assert_eq!(glass(&m), (1.0, [0.25; 3]));
}

#[test]
fn pigment_in_glass_needs_a_d_between_0_and_1() {
    for d in ["", "d 1", "d 0", "Tr 0"] {
        let m = material_a(&format!("Kd 0.1 0.1 0.1\nNi 1.5\n{d}\nillum 7\n"));
        assert_eq!((m.diffuse, glass(&m).1), (Vec3::ZERO, [1.0; 3]), "{d}");
    }
    let m = material_a("Kd 0.1 0.1 0.1\nd 0.5\nTf 0.9 0.9 0.9\nillum 4\n");
    assert!((m.diffuse - Vec3::splat(0.05)).length() < 1e-6);
    assert_eq!(glass(&m).1, [0.9; 3]);
}

#[test]
fn glass_without_a_filter_is_clear_and_its_index_is_kept_in_range() {
    assert_eq!(glass(&material_a("Kd 0 0 0\nillum 7\nTf 0 0 0\n")), (1.5, [1.0; 3]));
    for (ni, eta) in [("0", 1.0), ("0.5", 1.0), ("100", 10.0)] {
        let scene = load(&format!("Kd 0 0 0\nNi {ni}\nillum 7\n"));
        assert_eq!(glass(material(&scene, "a")).0, eta);
        assert!(warning(&scene, "index of refraction").2.contains(&format!("Ni {ni}")));
    }
    assert_clean(&load("Kd 0.5 0.5 0.5\nNi 0\nillum 2\n"));
}

#[test]
fn an_invisible_material_is_an_exporters_mistake() {
    for line in ["d 0", "Tr 1", "d 0.0\nillum 2"] {
        let scene = load(&format!("Kd 0.5 0.5 0.5\n{line}\n"));
        assert_eq!(material(&scene, "a").kind, MaterialKind::Diffuse);
        assert_eq!(material(&scene, "a").diffuse, Vec3::splat(0.5));
        assert_eq!(warning(&scene, "invisible").0, "scene.mtl");
    }
}

#[test]
fn no_material_reflects_more_than_arrives() {
    let scene = load("Kd 0.5 0.5 0.5\nKs 1 1 1\nillum 3\n");
    let m = material(&scene, "a");
    let MaterialKind::Mirror { reflectance, .. } = m.kind else { panic!("{m:?}") };
    assert!((m.diffuse + reflectance).max_element() <= 1.0 + 1e-6);
    assert!((m.diffuse.x / reflectance.x - 0.5).abs() < 1e-6);
    assert!(warning(&scene, "more light than arrives").2.contains("scaled down"));
    assert_eq!(material_a("Kd 2 1 0\n").diffuse.to_array(), [1.0, 0.5, 0.0]);
    assert_clean(&load("Kd 0.2 0.2 0.2\nKs 0.8 0.8 0.8\nillum 3\n"));
}

#[test]
fn mirrors_are_not_believed_where_everything_is_one() {
    let names = ["a", "b", "c", "d", "e", "f"];
    let bright = |n: &str| format!("newmtl {n}\nKd 0.6 0.6 0.6\nKs 0.5 0.5 0.5\nillum 7\n");
    let mut mtl: String = names[..5].iter().map(|n| bright(n)).collect();
    mtl += "newmtl f\nKd 0 0 0\nKs 0.9 0.9 0.9\nillum 3\n";
    let scene = Folder::with_mtl(&names, &mtl).load();
    assert_eq!(material(&scene, "a").kind, MaterialKind::Diffuse);
    assert_eq!(material(&scene, "a").diffuse, Vec3::splat(0.6));
    assert!(matches!(material(&scene, "f").kind, MaterialKind::Mirror { .. }), "the dark one is a mirror");
    let (_, line, message) = warning(&scene, "declared as mirror");
    assert_eq!(line, 1);
    assert!(message.starts_with("5 opaque materials"), "{message}");
    // Other materials of the file do not make them more plausible.
    let scene = Folder::with_mtl(&names, mtl + MATTE).load();
    assert_eq!(material(&scene, "a").kind, MaterialKind::Diffuse);
}

#[test]
fn a_distrusted_material_with_d_stays_transparent() {
    let scene = Folder::with_mtl(&["a"], "newmtl a\nKd 0.6 0.6 0.6\nd 0.5\nillum 7\n").load();
    assert!(matches!(material(&scene, "a").kind, MaterialKind::Glass { .. }));
}

#[test]
fn ke_makes_a_light() {
    let scene = load("Ke 10 9 8\n");
    assert_clean(&scene);
    assert_eq!(material(&scene, "a").emission.to_array(), [10.0, 9.0, 8.0]);
    assert_eq!(scene.lights.len(), 1);
    assert!(scene.features.area_lights);
}

#[test]
fn polished_metal_is_a_mirror() {
    let m = material_a("Kd 0.9 0.6 0.3\nPm 1\nPr 0.02\n");
    let MaterialKind::Mirror { reflectance, .. } = m.kind else { panic!("{m:?}") };
    assert_eq!((reflectance.to_array(), m.diffuse), ([0.9, 0.6, 0.3], Vec3::ZERO));
    let m = material_a("Kd 0.9 0.6 0.3\nPm 1\nPr 0.5\n");
    let reflectance = Vec3::new(0.9, 0.6, 0.3);
    assert_eq!((m.kind, m.diffuse), (MaterialKind::Glossy { reflectance, roughness: 0.5 }, Vec3::ZERO));
}

#[test]
fn metal_keeps_its_picture_and_pictures_of_gloss_hold_for_each_place() {
    let texels = [[255, 0, 0, 255], [0, 0, 255, 255]];
    let load = |lines: &str| {
        let gloss = png(2, 1, &[[26; 4], [255, 255, 255, 255]]);
        let folder = Folder::with_mtl(&["a"], format!("newmtl a\nKd 1 1 1\n{lines}\n"));
        folder.add("c.png", png(2, 1, &texels)).add("g.png", gloss).load()
    };
    let at = |scene: &Scene, u: f32| {
        let place = material(scene, "a").at(&scene.textures, || Vec2::new(u, 0.5)).into_owned();
        (place.kind, place.diffuse)
    };
    let metal = |reflectance, roughness| (MaterialKind::Glossy { reflectance, roughness }, Vec3::ZERO);
    let scene = load("map_Kd c.png\nPm 1\nPr 0.3");
    assert_eq!([at(&scene, 0.25), at(&scene, 0.75)], [metal(Vec3::X, 0.3), metal(Vec3::Z, 0.3)]);
    let scene = load("map_Kd c.png\nPm 1\nmap_Pr g.png");
    assert_eq!([at(&scene, 0.25), at(&scene, 0.75)], [metal(Vec3::X, 26.0 / 255.0), metal(Vec3::Z, 1.0)]);
    let scene = load("map_Kd c.png\nPr 0.3\nmap_Pm g.png");
    assert_eq!(at(&scene, 0.75), metal(Vec3::Z, 0.3));
    assert!(at(&scene, 0.25).1.x > 0.8);
    // A missing picture leaves the values of the material: a matte one.
    assert_eq!(material(&load("map_Pr none.png"), "a").kind, MaterialKind::Diffuse);
}

#[test]
fn bumps_are_heights_or_directions_by_their_picture() {
    let load = |line: &str, texels: &[[u8; 4]]| {
        let folder = Folder::with_mtl(&["a"], format!("newmtl a\nKd 1 1 1\n{line}\n"));
        folder.add("n.png", png(2, 1, texels)).load()
    };
    let direction = |scene: &Scene, u: f32| {
        let map = material(scene, "a").detail.normal.expect("a relief");
        map.direction(&scene.textures, Vec2::new(u, 0.5))
    };
    let bluish = [[255, 128, 128, 255], [128, 128, 255, 255]];
    let scene = load("bump -bm 2 n.png", &[[128, 128, 255, 255], [128, 128, 255, 255]]);
    assert!(warning(&scene, "bluish").2.contains("normal map"));
    assert_eq!(direction(&scene, 0.25), Vec3::Z);
    assert_eq!(direction(&load("norm n.png", &bluish), 0.25), Vec3::X);
    // Heights of one step right of the middle: the slope is that of the picture's width.
    let folder = Folder::with_mtl(&["a"], "newmtl a\nKd 1 1 1\nbump -bm 3 n.png\n");
    let heights: Vec<[u8; 4]> = (0..8).map(|x| [if x < 4 { 0 } else { 255 }; 4]).collect();
    let scene = folder.add("n.png", png(8, 1, &heights)).load();
    assert!(warning(&scene, "grey").2.contains("heights"));
    let edge = direction(&scene, 3.5 / 8.0);
    let expected = -3.0 * 0.02 * 8.0 / 2.0;
    assert!((edge.x / edge.z - expected).abs() < 0.03, "{edge}");
    assert_eq!(direction(&scene, 1.5 / 8.0), Vec3::Z);
}

#[test]
fn the_pbr_extension_makes_coats_and_gloss_alone_does_not() {
    let coated = |roughness| MaterialKind::Glossy { reflectance: Vec3::splat(0.04), roughness };
    let kd = "Kd 0.5 0.5 0.5\n";
    assert_eq!(material_a(&format!("{kd}Pr 0.2\n")).kind, coated(0.2));
    // The extension decides, whatever model an exporter writes next to it.
    assert_eq!(material_a(&format!("{kd}Ks 0.5 0.5 0.5\nillum 3\nPr 0.2\n")).kind, coated(0.2));
    assert_eq!(material_a(&format!("{kd}Pr 0.9\nPc 1\nPcr 0.1\n")).kind, coated(0.1));
    for matte in ["Pr 0.5\n", "Ks 0.5 0.5 0.5\nNs 250\nillum 2\n"] {
        assert_eq!(material_a(&format!("{kd}{matte}")).kind, MaterialKind::Diffuse, "{matte}");
    }
    let m = material_a("Kd 0.1 0.1 0.1\nillum 4\nNi 1.5\nPr 0.4\n");
    assert_eq!(m.kind, MaterialKind::Frosted { eta: 1.5, transmittance: Vec3::ONE, roughness: 0.4 });
}

#[test]
fn missing_materials_are_named_and_grey() {
    let scene = Folder::with_mtl(&["a", "walls", "doors"], "newmtl a\n").load();
    let (file, _, message) = warning(&scene, "no library defines");
    assert_eq!(file, "scene.obj");
    assert!(message.contains("'walls', 'doors'") && message.contains("grey"), "{message}");
    assert_eq!(material(&scene, "doors").diffuse, Vec3::splat(0.6));
}

#[test]
fn a_library_that_the_model_does_not_name_is_not_used() {
    let scene =
        Folder::with_obj(format!("usemtl a\n{TRIANGLE}")).add("scene.mtl", "newmtl a\nKd 0 0 0\n").load();
    assert_eq!(material(&scene, "a").diffuse, Vec3::splat(0.6));
    assert!(warning(&scene, "no library defines").2.contains("'a'"));
}

#[test]
fn a_missing_library_names_the_paths_tried() {
    let scene = Folder::with_obj(format!("mtllib lib\\other.mtl\n\n{TRIANGLE}")).load();
    let (_, line, message) = warning(&scene, "was not found");
    assert_eq!(line, 1);
    assert!(message.contains("lib/other.mtl") && message.contains("other.mtl"), "{message}");
}

#[test]
fn duplicates_and_unknown_lines_are_reported() {
    let mtl = "Kd 1 0 0\nnewmtl a\nKd 0.1 0.1 0.1\nfoo 1\nnewmtl a\nKd 0.9 0.9 0.9\n";
    let scene = Folder::with_mtl(&["a"], mtl).load();
    assert_eq!(material(&scene, "a").diffuse.x, 0.1);
    assert_eq!(warning(&scene, "before the first newmtl").1, 1);
    assert_eq!(warning(&scene, "unknown keyword").1, 4);
    assert_eq!(warning(&scene, "defined again").1, 5);
}

#[test]
fn unused_materials_are_left_out() {
    let scene = Folder::with_mtl(&["a"], "newmtl a\nnewmtl b\nmap_Kd nowhere.png\nillum 7\n").load();
    assert_eq!(scene.materials.len(), 1);
    assert_clean(&scene);
}
