//! What `tobj` reads behind the sanitizer is what the reader before it read, face by face.

use super::super::{parse, piece};
use super::piece as old;
use crate::import::options::Limits;
use crate::import::progress::Steps;
use crate::math::key::Key;
use glam::{DVec3, Vec2, Vec3};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A face with everything that follows from its corners.
#[derive(Debug, PartialEq)]
struct Face {
    line: u64,
    material: String,
    corners: Vec<(DVec3, Option<Vec2>, Vec3)>,
}

const STEPS: Steps = Steps { progress: &|_, _| true };

fn faces_of_tobj(text: &str) -> (parse::Model, Vec<Face>) {
    let model = parse::parse(text, Path::new("a.obj"), &Limits::default(), &STEPS).unwrap();
    let corner = |c: &piece::Corner| {
        let normal = model.normals.get(c.normal as usize).copied().unwrap_or(Vec3::ZERO);
        (model.positions[c.position as usize], model.uvs.get(c.uv as usize).copied(), normal)
    };
    let face = |f: parse::Polygon| Face {
        line: f.line,
        material: model.material_names[f.material as usize].clone(),
        corners: f.corners.iter().map(corner).collect(),
    };
    let faces = model.faces().map(face).collect();
    (model, faces)
}

fn faces_before(text: &str) -> (super::Model, Vec<Face>) {
    let model = super::parse(text, Path::new("a.obj"), &Limits::default(), &STEPS).unwrap();
    let corner = |c: &old::Corner| {
        let normal = model.normals.get(c.normal as usize).copied().unwrap_or(Vec3::ZERO);
        (model.positions[c.position as usize], model.uvs.get(c.uv as usize).copied(), normal)
    };
    // Faces of refused vertices went later.
    let is_kept =
        |f: &super::Polygon| f.corners.iter().all(|c| model.positions[c.position as usize].is_finite());
    let face = |f: super::Polygon| Face {
        line: f.line,
        material: model.material_names[f.material as usize].clone(),
        corners: f.corners.iter().map(corner).collect(),
    };
    let faces = model.faces().filter(is_kept).map(face).collect();
    (model, faces)
}

#[track_caller]
fn assert_same(name: &str, text: &str) {
    let ((new, faces), (before, expected)) = (faces_of_tobj(text), faces_before(text));
    assert_eq!(faces.len(), expected.len(), "{name}");
    for (face, expected) in faces.iter().zip(&expected) {
        assert_eq!(face, expected, "{name}");
    }
    assert_eq!(new.libraries, before.libraries, "{name}");
    let colors = |list: &[(u32, Vec3)]| {
        list.iter()
            .map(|(_, color)| color.to_array().map(f32::to_bits))
            .collect::<std::collections::HashSet<_>>()
    };
    assert!(colors(&new.colors).is_subset(&colors(&before.colors)), "{name}");
    let names = |list: &[(usize, String)]| list.iter().map(|(_, name)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&new.shapes), names(&before.shapes), "{name}");
}

#[test]
fn odd_lines_are_read_alike() {
    let texts = [
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        "f 1/1/1 2//2 3/2\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 1\nvt 0.5 2 3\nvn 0 0 2\nvn 1 1\n",
        "v 1 2 3 4\nv 1,5 0 0\nv nan 0 0\nv 1e-400 1e5 .5\nv 1.5#x 0 0\nf 1 2 4\nf -1 -2 -3 -3 -1\nf 3 4 5\n",
        "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 0.5 0.5 0.5 1\nf 1 2 3\nl 1 2\np 3\nf 1 2\nf\nf 1 2 9\nf 0 1 2\n",
        "o a\ng b\nusemtl x y\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\nusemtl\nf 1/9 2/9 3/9\ns 1\nf 1//7 2 3\n",
        "mtllib a.mtl b.mtl\n\u{3000}v 0 0 0\nv +1 -0 1.\nv 1 0 0\nv 0 1 0\nfo 1 2 3\nf 1 2 \\\n3\nf 1/1/1/1 2 3\n",
        "",
        "# nothing\n",
        "v 1e 0 0\nv . 0 0\nv --1 0 0\nvn 1e 0 0\nvt 1e\nvt - -\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 4/1/1 5/2/1 6\n",
        "vt 4000000.25 1e300\nvt 257 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/2 3/1\n",
    ];
    for text in texts {
        assert_same(text, text);
    }
}

/// Files of several pieces and objects, with corners of every kind and indices of both kinds.
#[test]
fn large_files_are_read_alike() {
    for seed in 0..3 {
        let (mut text, mut vertices) = (String::new(), 0);
        for block in 0..12_000u32 {
            let key = Key::of_pixel(seed, block);
            let random = |dimension: u32| key.with(dimension).pair()[0];
            for i in 0..4 {
                text += &format!(
                    "v {} {} {}\nvt {} {}\nvn {} 1 {}\n",
                    random(i),
                    block,
                    random(9 + i),
                    random(20 + i),
                    random(30 + i),
                    random(40 + i),
                    random(50 + i)
                );
            }
            vertices += 4;
            let [a, b, c, d] = [3, 2, 1, 0].map(|back| vertices - back);
            text += &match (random(60) * 8.0) as u32 {
                0 => format!("f {a} {b} {c} {d}\n"),
                1 => format!("f {a}/{a} {b}/{b} {c}/{c}\nf {a}//{a} {c}//{c} {d}//{d}\n"),
                2 => "f -1 -2 -3\nf -1/-1/-1 -2/-2/-2 -4/-4/-4\n".to_owned(),
                3 => {
                    format!("g part {block}\nusemtl m{}\nf {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}\n", block % 7)
                }
                4 => format!("f {a} {b} {}\n", vertices + 3),
                5 => format!("f {a} {b} {c}\nf {a} {c} {d}\nf {a} 1 {d}\n").repeat(5),
                _ => format!("f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}\n"),
            };
        }
        assert_same("generated", &text);
    }
}

#[test]
fn files_that_once_broke_something_are_read_alike() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/corpus/obj");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = crate::import::text::decode(std::fs::read(&path).unwrap()).text;
        assert_same(&path.display().to_string(), &text);
    }
}

#[test]
fn published_scenes_are_read_alike() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    if !folder.is_dir() {
        // Written directly: the test runner hides the output of passing tests.
        let _ = writeln!(std::io::stderr(), "skipped: {} is absent", folder.display());
        return;
    }
    let files = |path: PathBuf| std::fs::read_dir(path).into_iter().flatten().map(|e| e.unwrap().path());
    for path in files(folder).flat_map(files).filter(|p| p.extension().is_some_and(|e| e == "obj")) {
        let text = crate::import::text::decode(std::fs::read(&path).unwrap()).text;
        assert_same(&path.display().to_string(), &text);
    }
}
