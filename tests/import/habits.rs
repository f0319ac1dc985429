//! What exporters write by habit: it is read as it was meant, and said.

use super::{Folder, assert_clean, doubts, load_obj, material, warning};
use afterimage::scene::{Material, MaterialKind, Scene};
use glam::{DVec3, Vec2, Vec3};
use image::{DynamicImage, ImageFormat, RgbImage};
use std::io::Cursor;

fn png(color: [u8; 3]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let image = DynamicImage::ImageRgb8(RgbImage::from_pixel(2, 2, image::Rgb(color)));
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Loads a model with a triangle of each material and the picture `a.png`.
fn load_mtl(names: &[&str], mtl: &str) -> Scene {
    Folder::with_mtl(names, mtl).add("a.png", png([200, 40, 20])).load()
}

fn is_matte(m: &Material) -> bool {
    m.kind == MaterialKind::Diffuse
}

#[test]
fn glass_on_everything_by_maya_is_matte() {
    let maya = |name: &str, kd: &str, rest: &str| {
        format!("newmtl {name}\nillum 4\nKd {kd}\nKa 0.00 0.00 0.00\nTf 1.00 1.00 1.00\nNi 1.00\n{rest}\n")
    };
    let mtl = maya("tiles", "0.00 0.00 0.00", "map_Kd a.png")
        + &maya("plaster", "0.70 0.68 0.60", "")
        + &maya("asphalt", "0.05 0.05 0.05", "")
        + &maya("black", "0.00 0.00 0.00", "");
    let scene = load_mtl(&["tiles", "plaster", "asphalt", "black"], &mtl);
    assert!(scene.materials.iter().all(is_matte), "{:?}", scene.materials);
    let tiles = material(&scene, "tiles");
    assert_eq!((tiles.diffuse, tiles.diffuse_texture.is_some()), (Vec3::ONE, true));
    assert_eq!(material(&scene, "plaster").diffuse, Vec3::new(0.7, 0.68, 0.6));
    assert!(warning(&scene, "illum that other values contradict").2.starts_with("4 opaque materials"));
    assert!(warning(&scene, "Kd 0 in front of a picture").2.contains("tiles"));
}

#[test]
fn maya_writes_opacity_as_a_filter() {
    let scene = load_mtl(&["a"], "newmtl a\nillum 4\nKd 0.5 0.5 0.5\nTf 0.25 0.25 0.25\nNi 1.00\n");
    let kind = material(&scene, "a").kind;
    assert_eq!(kind, MaterialKind::Glass { eta: 1.0, transmittance: Vec3::splat(0.75) });
    assert!(warning(&scene, "Maya").2.contains("'a'") || warning(&scene, "Maya").2.contains("(a)"));
}

/// The values that a wall has as well say nothing about a dark frame. A pane with `d`, and one with
/// values of its own, are glass in the same file.
#[test]
fn an_illum_that_walls_have_as_well_is_not_believed_of_dark_materials() {
    let one = |name: &str, kd: f32, more: &str| {
        format!("newmtl {name}\nillum 7\nKd {kd} {kd} {kd}\nKs 1 1 1\nNi 1.5\nNs 50\n{more}\n")
    };
    let mtl = one("wall", 0.8, "")
        + &one("frame", 0.02, "")
        + &one("slate", 0.0, "")
        + &one("pane", 0.1, "d 0.2")
        + &one("lens", 0.0, "Ni 1.7");
    let scene = load_mtl(&["wall", "frame", "slate", "pane", "lens"], &mtl);
    let is_glass = |name: &str| material(&scene, name).is_glass();
    assert_eq!(["wall", "frame", "slate", "pane", "lens"].map(is_glass), [false, false, false, true, true]);
}

#[test]
fn a_mirror_must_leave_room_for_its_colour() {
    let kind = |mtl: &str| is_matte(material(&load_mtl(&["a"], &format!("newmtl a\nillum 3\n{mtl}\n")), "a"));
    assert!(!kind("Kd 0.45 0.45 0.45\nKs 0.5 0.5 0.5"), "steel");
    assert!(!kind("Kd 0.2 0.2 0.2\nKs 1 1 1"), "a mirror with some haze");
    assert!(kind("Kd 0.7 0.7 0.7\nKs 0.5 0.5 0.5"), "paint");
    assert!(kind("Kd 0 0 0\nKs 0.5 0.5 0.5\nmap_Kd a.png"), "a picture");
}

#[test]
fn a_picture_of_ambient_light_alone_is_the_colour() {
    let scene = load_mtl(&["a"], "newmtl a\nKd 1 1 1\nmap_Ka a.png\n");
    assert!(material(&scene, "a").diffuse_texture.is_some());
    assert!(warning(&scene, "map_Ka").2.contains("colour"));
    assert_clean(&load_mtl(&["a"], "newmtl a\nKd 1 1 1\nmap_Ka a.png\nmap_Kd a.png\n"));
}

#[test]
fn pictures_and_values_without_effect_are_named() {
    let lines = [
        ("map_bump a.png", "read as heights"),
        ("bump -bm 0.2 a.png", "read as heights"),
        ("disp a.png", "shape"),
        ("map_Ks a.png", "evenly"),
        ("refl a.png", "decal"),
        ("Ps 0.5", "sheen"),
        ("map_Kd -mm 0.2 1 a.png", "option of a picture"),
    ];
    for (line, effect) in lines {
        let scene = load_mtl(&["a"], &format!("newmtl a\nKd 0.5 0.5 0.5\n{line}\n"));
        assert_eq!(warning(&scene, effect).1, 3, "{line}");
    }
    for line in ["Pc 0", "map_Kd -bm 1.0 -clamp off -imfchan l a.png", "map_opacity a.png", "norm a.png"] {
        assert_clean(&load_mtl(&["a"], &format!("newmtl a\nKd 0.5 0.5 0.5\n{line}\n")));
    }
}

#[test]
fn decimal_commas_are_read_and_named() {
    let obj = "mtllib scene.mtl\nv 0,5 0,0 -1,25\nv 1,5 0 0\nv 0 2,5e0 0\nvt 0,25 0,5\nvn 0,0 0,6 0,8\nusemtl a\nf 1/1/1 2/1/1 3/1/1\n";
    let points = obj.replace(',', ".");
    let mtl = "newmtl a\nKd 0,5 0,25 0,125\nd 1,0\n";
    let scene = Folder::with_obj(obj).add("scene.mtl", mtl).load();
    let same = Folder::with_obj(points).add("scene.mtl", mtl.replace(',', ".")).load();
    assert_eq!(scene.hash, same.hash);
    let (file, line, message) = warning(&scene, "decimal commas");
    assert_eq!((file, line), ("scene.obj", 2));
    assert!(message.starts_with("5 lines"), "{message}");
    let (.., of_library) = warning(&scene, "2 lines with decimal commas");
    assert!(of_library.contains("kd 0,5 0,25 0,125"));
    // Lists and thousands are no decimal commas.
    for bad in ["v 1,2,3 0 0", "v 1,000.5 0 0"] {
        let scene = load_obj(format!("{}{bad}\n", super::TRIANGLE));
        assert!(doubts(&scene).iter().any(|d| d.contains("not a finite number")), "{bad}");
    }
}

/// A prism of `sides`, with a cap, and smoothing as given before the sides.
fn prism(sides: usize, smoothing: &str) -> Scene {
    let mut obj = String::new();
    for i in 0..sides {
        let angle = i as f64 / sides as f64 * std::f64::consts::TAU;
        for y in [0, 2] {
            obj += &format!("v {} {y} {}\n", angle.cos(), -angle.sin());
        }
    }
    obj += smoothing;
    for i in 0..sides {
        let [a, b] = [2 * i + 1, 2 * ((i + 1) % sides) + 1];
        obj += &format!("f {a} {b} {} {}\n", b + 1, a + 1);
    }
    let cap: Vec<String> = (0..sides).map(|i| (2 * i + 2).to_string()).collect();
    load_obj(format!("{obj}s off\nf {}\n", cap.join(" ")))
}

#[test]
fn smoothing_groups_round_a_column_and_leave_its_cap_flat() {
    for sides in [6, 12, 40] {
        let scene = prism(sides, "s 1\n");
        assert_clean(&scene);
        for (triangle, corners) in scene.triangles.iter().enumerate() {
            for &v in corners {
                let (position, normal) = (scene.positions[v as usize], scene.normals[v as usize]);
                let radial = Vec3::new(position.x, 0.0, position.z).normalize_or_zero();
                let is_cap = triangle >= 2 * sides;
                assert!(if is_cap { normal == Vec3::ZERO } else { normal.dot(radial) > 0.9999 }, "{sides}");
            }
        }
    }
    for flat in ["", "s off\n", "s 0\n"] {
        assert!(prism(12, flat).normals.is_empty(), "{flat}");
    }
    assert!(prism(4, "s 1\n").normals.iter().all(|n| n.length() < 1e-6 || n.abs().max_element() > 0.7));
}

/// In the slow twin, every corner asks all faces of its group.
#[test]
fn smooth_normals_are_the_means_of_the_faces_of_their_group() {
    let scene = prism(12, "s 3\n");
    let corners = |t: usize| scene.triangles[t].map(|v| scene.positions[v as usize].as_dvec3());
    for t in 0..24 {
        for &v in &scene.triangles[t] {
            let at = scene.positions[v as usize].as_dvec3();
            // Each side is a quad of two triangles, which count as one face of a right angle.
            let sides =
                (0..12).filter(|side| (2 * side..2 * side + 2).any(|t: usize| corners(t).contains(&at)));
            let normal = |side: usize| {
                let [a, b, c] = corners(2 * side);
                (b - a).cross(c - a).normalize_or_zero()
            };
            let mean = sides.map(normal).sum::<DVec3>().normalize_or_zero();
            assert!((mean.as_vec3() - scene.normals[v as usize]).length() < 1e-5);
        }
    }
}

#[test]
fn texture_coordinates_far_from_zero_keep_their_digits() {
    let mut obj = "mtllib scene.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    for far in [0.0, 4_000_000.0, -25_000_000.0] {
        obj += &format!(
            "vt {} {}\nvt {} {}\nvt {} {}\n",
            far + 0.125,
            -far,
            far + 1.375,
            -far + 0.5,
            far,
            -far + 1.0625
        );
    }
    obj += "f 1/1 2/2 3/3\nf 1/4 2/5 3/6\nf 1/7 2/8 3/9\n";
    let scene =
        Folder::with_obj(obj).add("scene.mtl", "newmtl a\nmap_Kd a.png\n").add("a.png", png([9; 3])).load();
    let near = [Vec2::new(0.125, 0.0), Vec2::new(1.375, 0.5), Vec2::new(0.0, 1.0625)];
    for triangle in scene.triangles.iter() {
        assert_eq!(triangle.map(|v| scene.uvs[v as usize]), near);
    }
}

/// Colour of the middle of a triangle, by its texture.
fn middle(scene: &Scene, triangle: usize) -> Vec3 {
    let [a, b, c] = scene.triangles[triangle].map(|v| scene.uvs[v as usize]);
    let m = scene.material_of(triangle as u32);
    let texture = &scene.textures[m.diffuse_texture.unwrap().texture.0 as usize];
    m.diffuse * texture.color((a + b + c) / 3.0)
}

#[test]
fn vertex_colours_are_shown() {
    let linear = afterimage::raster::color::linear_from_srgb;
    for [low, high] in [[0.4, 0.6], [102.0, 153.0]] {
        let colors = [[high, low, low], [low, high, low], [low, low, high], [low, low, low]];
        let corner = |(i, [r, g, b]): (usize, [f64; 3])| format!("v {} {} 0 {r} {g} {b}\n", i % 2, i / 2);
        let scene =
            load_obj(colors.into_iter().enumerate().map(corner).collect::<String>() + "f 1 2 3\nf 2 4 3\n");
        let mean = (2.0 * linear(0.4) + linear(0.6)) / 3.0;
        assert!((middle(&scene, 0) - Vec3::splat(mean)).abs().max_element() < 0.01, "{}", middle(&scene, 0));
        assert_eq!(scene.materials[0].diffuse, Vec3::ONE);
    }
    // A material of the model is multiplied.
    let scene = Folder::with_mtl(&["a"], "newmtl a\nKd 0.5 0.5 0.5\n");
    let coloured = "mtllib scene.mtl\nusemtl a\nv 0 0 0 0.5 0.5 0.5\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 0.5 0.5 0.5\nf 1 2 3\n";
    let scene = scene.add("scene.obj", coloured).load();
    assert!((middle(&scene, 0) - 0.5 * Vec3::splat(linear(128.0 / 255.0))).length() < 1e-5);
    // White changes nothing, and a weight is no colour.
    assert!(load_obj("v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n").textures.is_empty());
    assert!(load_obj("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n").textures.is_empty());
}

#[test]
fn vertex_colours_under_a_picture_are_reported() {
    let obj = "mtllib scene.mtl\nusemtl a\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n";
    let folder = Folder::with_obj(obj).add("scene.mtl", "newmtl a\nmap_Kd a.png\n").add("a.png", png([9; 3]));
    assert!(warning(&folder.load(), "vertex colours").2.contains("'a'"));
}

#[test]
fn file_names_are_compared_however_their_accents_are_written() {
    let [joined, apart] = ["b\u{fc}hne.png", "bu\u{308}hne.png"];
    for (named, stored) in [(joined, apart), (apart, joined), (joined, joined)] {
        let mtl = format!("newmtl a\nmap_Kd {named}\n");
        let scene = Folder::with_mtl(&["a"], mtl).add(stored, png([1, 2, 3])).load();
        assert_clean(&scene);
    }
}

#[test]
fn display_attributes_are_named() {
    let scene = load_obj(format!("bevel on\nlod 3\n{}", super::TRIANGLE));
    assert!(warning(&scene, "display attributes").2.starts_with("2 statements"));
}
