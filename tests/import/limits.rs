//! Hostile and endless files: nothing outside the folder is read, nothing that is not a regular
//! file, nothing too long.

use super::{Folder, TRIANGLE, material, warning};
use afterimage::import::{Phase, load};
use afterimage::scene::SceneError;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// A folder `inner` with the model, and files outside it that must not be opened.
fn jailed(obj: &str) -> Folder {
    Folder::with_obj("")
        .add("inner/scene.obj", format!("{obj}\nusemtl a\n{TRIANGLE}"))
        .add("secret.mtl", "newmtl a\nKd 0.125 0.125 0.125\n")
        .add("secret.png", super::textures::png(1, 1, &[[1, 2, 3, 255]]))
}

#[test]
fn a_library_outside_the_folder_is_not_read() {
    let folder = jailed("");
    let absolute = folder.path("secret.mtl").display().to_string();
    for name in ["../secret.mtl", "..\\secret.mtl", "../../etc/passwd", "/etc/passwd", &absolute] {
        let folder = jailed(&format!("mtllib {name}"));
        let scene = folder.try_load_file("inner/scene.obj").unwrap();
        assert_eq!(material(&scene, "a").diffuse.x, 0.6, "{name}");
        assert!(warning(&scene, "was not found").2.contains("inside the scene's folder"), "{name}");
    }
}

#[test]
fn a_library_outside_the_folder_is_read_when_allowed() {
    let mut folder = jailed("mtllib ../secret.mtl");
    folder.options.allow_outside = true;
    let scene = folder.try_load_file("inner/scene.obj").unwrap();
    assert_eq!(material(&scene, "a").diffuse.x, 0.125);
}

#[test]
fn a_texture_outside_the_folder_is_not_read() {
    let folder = jailed("mtllib in.mtl");
    let folder = folder.add("inner/in.mtl", "newmtl a\nmap_Kd ../secret.png\n");
    let scene = folder.try_load_file("inner/scene.obj").unwrap();
    assert_eq!(scene.textures[0].width, 8);
    assert!(warning(&scene, "secret.png").2.contains("outside the scene's folder"));
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_not_followed() {
    let folder = jailed("mtllib link.mtl");
    std::os::unix::fs::symlink(folder.path("secret.mtl"), folder.path("inner/link.mtl")).unwrap();
    std::os::unix::fs::symlink(folder.path(""), folder.path("inner/textures")).unwrap();
    let scene = folder.try_load_file("inner/scene.obj").unwrap();
    assert_eq!(material(&scene, "a").diffuse.x, 0.6);
    assert!(warning(&scene, "link.mtl").2.contains("inside the scene's folder"));
    let folder = jailed("mtllib in.mtl");
    let folder = folder.add("inner/in.mtl", "newmtl a\nmap_Kd SECRET.png\n");
    std::os::unix::fs::symlink(folder.path(""), folder.path("inner/textures")).unwrap();
    let scene = folder.try_load_file("inner/scene.obj").unwrap();
    assert_eq!(scene.textures[0].width, 8);
}

#[cfg(unix)]
#[test]
fn devices_pipes_and_folders_are_not_read() {
    let mut folder = jailed("mtllib /dev/zero\nmtllib pipe.mtl\nmtllib folder.mtl");
    folder.options.allow_outside = true;
    std::fs::create_dir(folder.path("inner/folder.mtl")).unwrap();
    let pipe = folder.path("inner/pipe.mtl");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().is_ok_and(|s| s.success());
    assert!(made, "mkfifo");
    let start = Instant::now();
    let scene = folder.try_load_file("inner/scene.obj").unwrap();
    assert!(start.elapsed() < Duration::from_secs(1));
    for name in ["/dev/zero", "pipe.mtl", "folder.mtl"] {
        assert!(warning(&scene, name).2.contains("was not found"));
    }
}

#[test]
fn folders_missing_files_and_other_formats_are_errors_with_a_remedy() {
    let folder = Folder::with_obj(TRIANGLE).add("model.fbx", "Kaydara FBX Binary").add("deep.obj/x", "");
    let error = |name: &str| folder.try_load_file(name).unwrap_err().to_string();
    assert!(error("nothing.obj").contains("check the path"));
    assert!(error("model.fbx").contains("export the model as one of .obj, .gltf, .glb"));
    assert!(error("deep.obj").contains("folder"));
}

#[test]
fn sizes_beyond_the_limits_are_errors_or_warnings() {
    let mut folder = Folder::with_mtl(&["a"], "newmtl a\nnewmtl b\nKd 0 0 0\n");
    folder.options.limits.obj_bytes = 10;
    assert!(folder.try_load().unwrap_err().to_string().contains("at most 10"));
    folder.options = Default::default();
    folder.options.limits.mtl_bytes = 10;
    assert!(warning(&folder.load(), "is not used").2.contains("at most 10"));
    folder.options = Default::default();
    folder.options.limits.materials = 1;
    assert!(matches!(folder.try_load(), Err(SceneError::TooLarge { what: "materials", count: 2, .. })));
    folder.options = Default::default();
    folder.options.limits.corners = 2;
    assert!(matches!(folder.try_load(), Err(SceneError::TooLarge { what: "corners", count: 3, .. })));
}

#[test]
fn a_line_without_end_is_an_error_that_names_it() {
    let error = Folder::with_obj(format!("{TRIANGLE}f {}", "1 ".repeat(9 << 20))).try_load().unwrap_err();
    assert!(matches!(error, SceneError::Line { line: 5, .. }), "{error}");
    let endless = format!("{TRIANGLE}f {}", "1 \\\n".repeat(7 << 20));
    assert!(Folder::with_obj(endless).try_load().unwrap_err().to_string().contains("16 MB"));
}

#[test]
fn names_beyond_4_kb_are_ignored() {
    let long = "n".repeat(5000);
    let scene = super::load_obj(format!("usemtl {long}\nmtllib {long}.mtl\n{TRIANGLE}"));
    assert_eq!(warning(&scene, "longer than 4 kB").1, 1);
}

#[test]
fn a_face_with_too_many_corners_is_skipped() {
    let mut face = "f".to_owned();
    (0..5000).for_each(|i| face += &format!(" {}", i % 3 + 1));
    let scene = super::load_obj(format!("{TRIANGLE}{face}\n"));
    assert_eq!((scene.triangles.len(), warning(&scene, "4096").1), (1, 5));
}

#[test]
fn every_phase_reports_and_can_cancel() {
    let folder = Folder::with_mtl(&["a"], "newmtl a\nmap_Kd a.png\n");
    let folder = folder.add("a.png", super::textures::png(1, 1, &[[9, 9, 9, 255]]));
    for phase in [Phase::Reading, Phase::Parsing, Phase::Materials, Phase::Textures, Phase::Building] {
        assert!(!phase.label().is_empty());
        let result = load(&folder.path("scene.obj"), &folder.options, &|p, fraction| {
            assert!((0.0..=1.0).contains(&fraction));
            p != phase
        });
        assert!(matches!(result, Err(SceneError::Cancelled)), "{phase:?}");
    }
}

#[test]
fn a_cancel_is_noticed_quickly() {
    let mut obj = String::new();
    for i in 0..400_000 {
        obj += &format!("v {i} 0.25 0.75\n");
    }
    let folder = Folder::with_obj(obj + "f 1 2 3\n");
    let calls = AtomicUsize::new(0);
    let result = load(&folder.path("scene.obj"), &folder.options, &|phase, _| {
        phase != Phase::Parsing || calls.fetch_add(1, Ordering::Relaxed) < 3
    });
    assert!(matches!(result, Err(SceneError::Cancelled)));
    // Of about 14 pieces, each counted and then read, only those in progress were finished.
    assert!(calls.load(Ordering::Relaxed) < 4 + 2 * rayon::current_num_threads(), "{calls:?}");
}

/// Run by hand: `cargo test -p afterimage --test afterimage -- --ignored a_cancel_answers
/// --nocapture`. Needs 1 GB of disk and 4 GB of memory.
#[test]
#[ignore = "reads a gigabyte"]
fn a_cancel_answers_within_200_ms_on_a_gigabyte() {
    use std::io::Write;
    use std::sync::Mutex;
    let folder = Folder::with_obj("");
    let mut file = std::io::BufWriter::new(std::fs::File::create(folder.path("scene.obj")).unwrap());
    for i in 0..16_000_000u32 {
        let (x, y) = (i % 3000, i / 3000);
        writeln!(file, "v {x}.125 {y}.25 0.0625\nf -1 {} {} {}", i / 2 + 1, i / 3 + 1, i / 5 + 1).unwrap();
        if i % 3 == 0 {
            writeln!(file, "vt 0.{i} 0.5\nvn 0 0 1\nv {y}.5 {x}.5 0.{i}").unwrap();
        }
    }
    // Data that is not on the disk yet would be written when the importer closes the file.
    file.into_inner().unwrap().sync_all().unwrap();
    let bytes = folder.path("scene.obj").metadata().unwrap().len();
    for (phase, share) in
        [(Phase::Reading, 0.5), (Phase::Parsing, 0.0), (Phase::Parsing, 0.5), (Phase::Building, 0.5)]
    {
        let cancelled: Mutex<Option<Instant>> = Mutex::new(None);
        let result = load(&folder.path("scene.obj"), &folder.options, &|p, fraction| {
            if p == phase && fraction >= share {
                cancelled.lock().unwrap().get_or_insert_with(Instant::now);
                return false;
            }
            true
        });
        assert!(matches!(result, Err(SceneError::Cancelled)));
        let took = cancelled.lock().unwrap().unwrap().elapsed();
        eprintln!("{bytes} bytes, {phase:?} at {share}: answered in {took:?}");
        assert!(took < Duration::from_millis(200), "{phase:?}: {took:?}");
    }
}

#[test]
fn no_bytes_make_the_importer_panic() {
    let words = "v|vt|vn|f|usemtl|mtllib|\\|\n|\r|1|-1|1/1/1|1e308|nan|#|\"|\u{fffd}|l| |\t|/|-|\
                 9999999999999999999|\0|newmtl|map_Kd -s|Kd";
    let words: Vec<&str> = words.split('|').collect();
    let mut state = 1u64;
    for _ in 0..300 {
        let mut text = TRIANGLE.to_owned() + "mtllib scene.obj\n";
        for _ in 0..60 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            text += words[(state >> 33) as usize % words.len()];
            text += if state & 1 << 40 == 0 { " " } else { "\n" };
        }
        if let Err(error) = Folder::with_obj(&text).try_load() {
            assert!(!error.to_string().contains("importer failed"), "{error}: {text:?}");
        }
    }
}
