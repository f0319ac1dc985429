//! Published scenes, where they are present, and the time to import a large model.

use super::{doubts, material};
use afterimage::import::{ImportOptions, load};
use afterimage::scene::{MaterialKind, Scene};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Returns the folder of the scenes. `None`, with a message, where they are absent.
fn shared_scenes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    if !folder.is_dir() {
        // Written directly: the test runner hides the output of passing tests.
        let _ = writeln!(std::io::stderr(), "skipped: {} is absent", folder.display());
        return None;
    }
    Some(folder)
}

fn load_real(path: &Path) -> Scene {
    load(path, &ImportOptions::default(), &|_, _| true).unwrap()
}

#[test]
fn import_reads_every_real_scene() {
    let Some(folder) = shared_scenes() else { return };
    let mut names: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .filter_map(|e| std::fs::read_dir(e.unwrap().path()).ok())
        .flat_map(|files| files.map(|f| f.unwrap().path()))
        .filter(|p| p.extension().is_some_and(|e| e == "obj"))
        .collect();
    names.sort();
    assert!(names.len() > 10);
    for path in names {
        let start = Instant::now();
        let scene = load_real(&path);
        let secs = start.elapsed().as_secs_f64();
        let name = path.file_name().unwrap().to_string_lossy();
        eprintln!("{name}: {} triangles, {secs:.3} s, {:?}", scene.triangles.len(), doubts(&scene));
        assert!(!doubts(&scene).iter().any(|d| d.contains("face") || d.contains("lie on its side")));
    }
}

#[test]
fn import_counts_what_an_independent_parser_counted() {
    let Some(folder) = shared_scenes() else { return };
    let counts = [
        ("sponza/sponza.obj", 66_445, 19),
        ("living-room/living-room.obj", 143_035, 19),
        ("staircase/staircase.obj", 261_458, 25),
        ("office/office.obj", 45_653, 15),
        ("fzk_haus/fzk_haus.obj", 19_708, 7),
    ];
    for (name, triangles, materials) in counts {
        let scene = load_real(&folder.join(name));
        let dropped: usize = doubts(&scene)
            .iter()
            .filter_map(|d| d.strip_suffix(" triangles without area were left out")?.parse::<usize>().ok())
            .sum();
        assert_eq!(scene.triangles.len() + dropped, triangles, "{name}");
        assert!(scene.materials.len() <= materials, "{name}");
    }
}

#[test]
fn import_keeps_the_materials_of_published_scenes() {
    let Some(folder) = shared_scenes() else { return };
    let room = load_real(&folder.join("living-room/living-room.obj"));
    assert!(matches!(material(&room, "Mirror").kind, MaterialKind::Mirror { .. }));
    assert!(matches!(material(&room, "Glass").kind, MaterialKind::Glass { eta: 1.5, .. }));
    assert!(material(&room, "Leaves").alpha_texture.is_some());
    let box_with_water = load_real(&folder.join("cornell/CornellBox-Water.obj"));
    assert!(matches!(
        material(&box_with_water, "leftSphere").kind,
        MaterialKind::Mirror { fresnel: true, .. }
    ));
    assert_eq!(box_with_water.lights.len(), 1);
}

/// A wavy floor with normals and texture coordinates, two triangles per cell.
fn wavy(cells: usize) -> String {
    let mut obj = String::new();
    for i in 0..(cells + 1) * (cells + 1) {
        let (x, z) = ((i % (cells + 1)) as f64 * 0.0137, (i / (cells + 1)) as f64 * 0.0137);
        let y = (x * 3.1).sin() * (z * 2.3).cos();
        writeln!(
            obj,
            "v {x:.6} {y:.6} {z:.6}\nvt {:.6} {:.6}\nvn {y:.6} 1.000000 {:.6}",
            x / 7.0,
            z / 7.0,
            -y
        )
        .unwrap();
    }
    for i in 0..cells * cells {
        let a = i / cells * (cells + 1) + i % cells + 1;
        let [b, c, d] = [a + 1, a + cells + 2, a + cells + 1];
        writeln!(obj, "f {a}/{a}/{a} {c}/{c}/{c} {b}/{b}/{b}\nf {a}/{a}/{a} {d}/{d}/{d} {c}/{c}/{c}")
            .unwrap();
    }
    obj
}

#[test]
fn a_quarter_of_a_million_triangles_import_in_under_a_second() {
    let text = wavy(354);
    let folder = super::Folder::with_obj(&text);
    let best = |work: &dyn Fn() -> usize| {
        let time = |_| {
            let start = Instant::now();
            assert_eq!(work(), 250_632);
            start.elapsed().as_secs_f64()
        };
        (0..3).map(time).fold(f64::INFINITY, f64::min)
    };
    let ours = best(&|| folder.load().triangles.len());
    let options = tobj::LoadOptions { single_index: false, ..Default::default() };
    let theirs = best(&|| {
        let models =
            tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| Ok(Default::default())).unwrap().0;
        models[0].mesh.indices.len() / 3
    });
    eprintln!("{} MB: import {ours:.3} s, tobj alone {theirs:.3} s", text.len() >> 20);
    // The limit leaves room for an unoptimised build on a busy machine.
    assert!(ours < if cfg!(debug_assertions) { 5.0 } else { 1.0 }, "{ours} s");
}
