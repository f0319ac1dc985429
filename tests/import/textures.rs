//! Textures: found under the names that exporters write, decoded, and never trusted.

use super::{Folder, assert_clean, material, warning};
use afterimage::scene::{Encoding, Scene};
use glam::{Vec2, Vec3};
use image::{DynamicImage, ImageFormat, Rgb32FImage, RgbaImage};
use std::io::Cursor;

pub(super) fn png(width: u32, height: u32, texels: &[[u8; 4]]) -> Vec<u8> {
    let raw = texels.iter().flatten().copied().cycle().take((width * height * 4) as usize).collect();
    encoded(&DynamicImage::ImageRgba8(RgbaImage::from_raw(width, height, raw).unwrap()), ImageFormat::Png)
}

fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

const RED: [u8; 4] = [255, 0, 0, 255];

fn red() -> Vec<u8> {
    png(2, 2, &[RED])
}

fn mtl(map: &str) -> String {
    format!("newmtl a\nKd 1 1 1\n{map}\n")
}

/// A scene whose only material has `map`, with a red picture at `at`.
fn with_red(map: &str, at: &str) -> Scene {
    Folder::with_mtl(&["a"], mtl(map)).add(at, red()).load()
}

fn assert_red(scene: &Scene) {
    assert_clean(scene);
    let texture = material(scene, "a").diffuse_texture.expect("a texture").texture;
    assert_eq!(scene.textures[texture.0 as usize].texels[0], RED);
    assert_eq!(scene.textures[texture.0 as usize].encoding, Encoding::Srgb);
}

#[test]
fn textures_are_found_the_way_exporters_name_them() {
    let cases = [
        ("wood.png", "wood.png"),
        ("dir/wood.png", "dir/wood.png"),
        ("dir\\my wood.png", "dir/my wood.png"),
        ("\"my wood.png\"", "my wood.png"),
        ("C:\\Users\\me\\Desktop\\wood.png", "wood.png"),
        ("/home/me/wood.png", "textures/wood.png"),
        ("\\\\server\\share\\wood.png", "maps/wood.png"),
        ("file:///tmp/wood.png", "images/wood.png"),
        ("../other/wood.png", "tex/wood.png"),
        ("Wood.PNG", "wood.png"),
        ("DIR/wood.png", "dir/WOOD.png"),
        ("wood.png", "Textures/Wood.png"),
        ("wood.tif", "wood.png"),
        ("wood.jpg", "textures/wood.PNG"),
        ("wood.png # oak", "wood.png"),
        ("wood #2.png", "wood #2.png"),
        ("./sub/../wood.png", "wood.png"),
    ];
    for (name, at) in cases {
        let scene = with_red(&format!("map_Kd {name}"), at);
        assert!(
            scene.textures.len() == 1 && scene.textures[0].texels[0] == RED,
            "{name} at {at}: {:?}",
            scene.warnings
        );
        assert_red(&scene);
    }
}

#[test]
fn textures_are_looked_for_from_the_library_first_then_from_the_model() {
    let obj = "mtllib lib/scene.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let folder = || Folder::with_obj(obj).add("lib/scene.mtl", mtl("map_Kd wood.png"));
    assert_red(&folder().add("lib/wood.png", red()).add("wood.png", png(1, 1, &[[0, 0, 0, 255]])).load());
    assert_red(&folder().add("wood.png", red()).load());
    assert_red(&folder().add("textures/wood.png", red()).load());
}

#[test]
fn map_options_are_read() {
    let cases = [
        ("-s 2 3 1 dir\\my wood.png", [2.0, 3.0], [0.0, 0.0]),
        ("-s 2 wood.png", [2.0, 1.0], [0.0, 0.0]),
        ("-o 0.5 0.25 -s 4 4 4 wood.png", [4.0, 4.0], [0.5, 0.25]),
        (
            "-clamp off -blendu on -bm 1.0 -mm 0 1 -imfchan l -texres 64 -t 0 0 0 wood.png",
            [1.0, 1.0],
            [0.0, 0.0],
        ),
        ("-s 2 2 1 5", [2.0, 2.0], [0.0, 0.0]),
    ];
    for (map, scale, offset) in cases {
        let folder = Folder::with_mtl(&["a"], mtl(&format!("map_Kd {map}")));
        let scene = folder.add("wood.png", red()).add("dir/my wood.png", red()).add("5", red()).load();
        assert_red(&scene);
        let texture = material(&scene, "a").diffuse_texture.unwrap();
        assert_eq!((texture.scale, texture.offset), (Vec2::from(scale), Vec2::from(offset)), "{map}");
    }
}

#[test]
fn a_map_without_a_file_is_ignored() {
    let scene = Folder::with_mtl(&["a"], "newmtl a\nmap_Kd\nmap_d -s 1 1 1\nKd 0.5 0.5 0.5\n").load();
    assert_eq!(material(&scene, "a").diffuse, Vec3::splat(0.5));
    assert!(material(&scene, "a").diffuse_texture.is_none());
}

#[test]
fn cloth_lets_light_pass_by_its_alpha() {
    let cloth: Vec<[u8; 4]> = (0..16).map(|i| [255, 255, 255, 40 + i * 8]).collect();
    let folder = Folder::with_mtl(
        &["a", "b"],
        "newmtl a\nmap_Kd cloth.png\nmap_d cloth.png\nnewmtl b\nmap_Kd cloth.png\n",
    );
    let scene = folder.add("cloth.png", png(4, 4, &cloth)).load();
    // The alpha of a colour picture counts without a map_d as well.
    for name in ["a", "b"] {
        let m = material(&scene, name);
        assert!(
            m.is_glass() && m.coverage_texture == m.diffuse_texture && m.alpha_texture.is_none(),
            "{name}"
        );
    }
}

#[test]
fn a_missing_texture_becomes_a_checker_and_names_every_path() {
    let scene = Folder::with_mtl(&["a"], mtl("map_Kd dir/wood.png")).load();
    let (file, line, message) = warning(&scene, "was not found");
    assert_eq!((file, line), ("scene.mtl", 3));
    let paths = [
        "dir/wood.png",
        " wood.png",
        "textures/wood.png",
        "maps/wood.png",
        "images/wood.png",
        "tex/wood.png",
    ];
    paths.iter().for_each(|p| assert!(message.contains(p), "{p} in {message}"));
    let texture = &scene.textures[0];
    assert_eq!((texture.width, texture.height), (8, 8));
    assert_eq!(texture.texels[..2], [[255, 0, 255, 255], [96, 96, 96, 255]]);
}

#[test]
fn a_file_used_twice_is_one_texture() {
    let mtl = "newmtl a\nmap_Kd wood.png\nnewmtl b\nmap_Kd -s 2 2 ./WOOD.png\n";
    let scene = Folder::with_mtl(&["a", "b"], mtl).add("wood.png", red()).load();
    assert_eq!(scene.textures.len(), 1);
}

#[test]
fn coverage_comes_from_alpha_that_varies_else_from_brightness() {
    let leaf = png(2, 1, &[[0, 255, 0, 255], [0, 255, 0, 0]]);
    let folder = Folder::with_mtl(&["a"], "newmtl a\nmap_Kd leaf.png\nmap_d leaf.png\n");
    let scene = folder.add("leaf.png", leaf).load();
    assert_eq!(scene.textures.len(), 1);
    let a = material(&scene, "a");
    assert_eq!(a.alpha_texture, a.diffuse_texture);
    assert!(scene.features.alpha);

    let mask = png(2, 1, &[[255, 255, 255, 255], [0, 0, 0, 255]]);
    let folder = Folder::with_mtl(&["a"], "newmtl a\nmap_d mask.png\n");
    let scene = folder.add("mask.png", mask).load();
    let alpha = &scene.textures[material(&scene, "a").alpha_texture.unwrap().texture.0 as usize];
    assert_eq!([alpha.texels[0][3], alpha.texels[1][3]], [255, 0]);
    assert_eq!(alpha.encoding, Encoding::Linear);
    assert!(material(&scene, "a").diffuse_texture.is_none());
}

#[test]
fn a_surface_with_a_missing_mask_has_no_holes() {
    let scene = Folder::with_mtl(&["a"], "newmtl a\nmap_d mask.png\n").load();
    assert!(material(&scene, "a").alpha_texture.is_none());
    assert!(warning(&scene, "mask.png").2.contains("without holes"));
}

#[test]
fn a_glowing_texture_multiplies_ke() {
    let glow = png(2, 1, &[[255, 0, 0, 255], [0, 0, 0, 255]]);
    let scene =
        |ke| Folder::with_mtl(&["a"], format!("newmtl a\n{ke}\nmap_Ke g.png\n")).add("g.png", &glow).load();
    for (ke, emission) in [("Ke 4 4 4", Vec3::splat(4.0)), ("", Vec3::ONE)] {
        let scene = scene(ke);
        let a = material(&scene, "a");
        let at = |u: f32| a.emission_at(&scene.textures, || Vec2::new(u, 0.5));
        assert_eq!([at(0.25), at(0.75)], [emission * Vec3::X, Vec3::ZERO]);
        assert_eq!(scene.lights.len(), 1);
    }
    assert!(!material(&scene("Ke 0 0 0"), "a").is_emissive());
}

#[test]
fn sixteen_bit_and_float_pictures_are_converted() {
    let deep = image::ImageBuffer::<image::Rgb<u16>, _>::from_pixel(1, 1, image::Rgb([65535, 32896, 0]));
    let bytes = encoded(&DynamicImage::ImageRgb16(deep), ImageFormat::Png);
    let scene = Folder::with_mtl(&["a"], mtl("map_Kd d.png")).add("d.png", bytes).load();
    assert_eq!(scene.textures[0].texels[0], [255, 128, 0, 255]);

    let float = Rgb32FImage::from_pixel(4, 4, image::Rgb([1.0, 0.214_04, 0.0]));
    let bytes = encoded(&DynamicImage::ImageRgb32F(float), ImageFormat::Hdr);
    let scene = Folder::with_mtl(&["a"], mtl("map_Kd f.hdr")).add("f.hdr", bytes).load();
    let [r, g, b, _] = scene.textures[0].texels[0];
    assert!(r == 255 && g.abs_diff(128) < 3 && b == 0, "{:?}", scene.textures[0].texels[0]);
}

#[test]
fn pictures_of_the_wrong_name_are_recognised() {
    assert_red(&with_red("map_Kd wood.jpg", "wood.jpg"));
    let tga =
        encoded(&DynamicImage::ImageRgba8(RgbaImage::from_pixel(2, 2, image::Rgba(RED))), ImageFormat::Tga);
    assert_red(&Folder::with_mtl(&["a"], mtl("map_Kd wood.tga")).add("wood.tga", tga).load());
}

#[test]
fn a_broken_picture_is_reported_once() {
    let mut broken = red();
    broken.truncate(40);
    let mtl = "newmtl a\nmap_Kd wood.png\nnewmtl b\nmap_Kd wood.png\n";
    for bytes in [broken, b"hello".to_vec(), Vec::new()] {
        let scene = Folder::with_mtl(&["a", "b"], mtl).add("wood.png", bytes).load();
        assert!(warning(&scene, "cannot be used").2.contains("'wood.png'"));
        assert_eq!(scene.warnings.iter().filter(|w| w.message.contains("wood.png")).count(), 1);
        assert_eq!((scene.textures.len(), scene.textures[0].width), (1, 8));
    }
}

/// Signature and header of a PNG of this size, with a valid checksum but without data.
pub(super) fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut chunk = b"IHDR".to_vec();
    chunk.extend_from_slice(&width.to_be_bytes());
    chunk.extend_from_slice(&height.to_be_bytes());
    chunk.extend_from_slice(&[8, 6, 0, 0, 0]);
    let mut crc = u32::MAX;
    for byte in &chunk {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
        }
    }
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    bytes.extend_from_slice(&chunk);
    bytes.extend_from_slice(&(!crc).to_be_bytes());
    bytes.extend_from_slice(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
    bytes
}

#[test]
fn a_picture_that_claims_too_much_is_refused_before_decoding() {
    for (width, height) in [(60_000, 60_000), (16_385, 1), (16_384, 16_384)] {
        let folder = Folder::with_mtl(&["a"], mtl("map_Kd bomb.png"));
        let scene = folder.add("bomb.png", png_header(width, height)).load();
        let (_, _, message) = warning(&scene, "cannot be used");
        assert!(message.to_lowercase().contains("large") || message.contains("imit"), "{message}");
    }
}

#[test]
fn all_pictures_together_have_a_budget() {
    let mtl = "newmtl a\nmap_Kd a.png\nnewmtl b\nmap_Kd b.png\nnewmtl c\nmap_Kd c.png\n";
    let picture = png(16, 16, &[RED]);
    let mut folder = Folder::with_mtl(&["a", "b", "c"], mtl);
    for name in ["a.png", "b.png", "c.png"] {
        folder = folder.add(name, &picture);
    }
    folder.options.limits.textures_bytes = 2 * 16 * 16 * 4;
    let scene = folder.load();
    assert!(warning(&scene, "all textures together").2.contains("'c.png'"));
    assert_eq!(scene.textures.len(), 3, "two pictures and the checker");
}

#[test]
fn pictures_of_many_formats_are_shown() {
    let rgb = DynamicImage::ImageRgb8(image::RgbImage::from_pixel(3, 2, image::Rgb([255, 0, 0])));
    let float = DynamicImage::ImageRgb32F(Rgb32FImage::from_pixel(3, 2, image::Rgb([1.0, 0.0, 0.0])));
    let rgba = DynamicImage::ImageRgba8(rgb.to_rgba8());
    let pictures = [
        ("a.webp", encoded(&rgba, ImageFormat::WebP)),
        ("a.tif", encoded(&rgb, ImageFormat::Tiff)),
        ("a.gif", encoded(&rgba, ImageFormat::Gif)),
        ("a.ppm", encoded(&rgb, ImageFormat::Pnm)),
        ("a.exr", encoded(&float, ImageFormat::OpenExr)),
        ("a.dds", plain_dds(24)),
        ("a.DDS", plain_dds(32)),
    ];
    for (name, bytes) in pictures {
        let scene = Folder::with_mtl(&["a"], mtl(&format!("map_Kd {name}"))).add(name, &bytes).load();
        assert_red(&scene);
        assert_eq!([scene.textures[0].width, scene.textures[0].height], [3, 2], "{name}");
        // Under another name, by its signature; and cut short, with a message.
        assert_red(&Folder::with_mtl(&["a"], mtl("map_Kd b.png")).add("b.png", &bytes).load());
        let cut = &bytes[..bytes.len() / 2];
        Folder::with_mtl(&["a"], mtl(&format!("map_Kd {name}"))).add(name, cut).load();
    }
}

/// A red DDS picture of 3 by 2 pixels without compression.
fn plain_dds(bits: u32) -> Vec<u8> {
    let mut words = [0u32; 32];
    (words[0], words[1], words[3], words[4]) = (u32::from_le_bytes(*b"DDS "), 124, 2, 3);
    (words[19], words[20], words[22]) = (32, 0x40, bits);
    [words[23], words[24], words[25]] = [0xff_0000, 0xff00, 0xff];
    let pixel = [0, 0, 255, 255];
    let pixels = std::iter::repeat_n(&pixel[..bits as usize / 8], 6).flatten().copied();
    words.iter().flat_map(|word| word.to_le_bytes()).chain(pixels).collect()
}
