//! Every way in which bytes from outside enter the program. Each is a function of bytes, which
//! asserts what must hold for any bytes.
//!
//! The fuzz targets, the property tests and the replay of the corpus call these functions.

use afterimage::camera::CameraPath;
use afterimage::experiment::run::{Journal, merge, read_manifest};
use afterimage::import::{EditFolder, ImportOptions, apply_edit_text, load};
use afterimage::scene::{MaterialKind, Scene, SceneError};
use afterimage::{Camera, raster::load::Picture, raster::load::read_notes};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Name and function of an entry point.
pub(crate) type EntryPoint = (&'static str, fn(&[u8]));

/// All entry points, by the names that the fuzz targets and the corpus use.
pub(crate) const ALL: &[EntryPoint] = &[
    ("obj", obj),
    ("mtl", mtl),
    ("texture", texture),
    ("gltf", gltf),
    ("sidecar", sidecar),
    ("session", session),
    ("ies", ies),
    ("walk", walk),
    ("journal", journal),
    ("picture", picture),
    ("draco", draco),
    ("meshopt", meshopt),
    ("webp", webp),
    ("tiff", tiff),
    ("gif", gif),
    ("dds", dds),
    ("exr", exr),
];

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n";

/// An OBJ model.
pub(crate) fn obj(bytes: &[u8]) {
    check_load("scene.obj", &[("scene.obj", bytes)]);
}

/// The material library of a valid model.
pub(crate) fn mtl(bytes: &[u8]) {
    let obj = format!("mtllib scene.mtl\n{TRIANGLE}usemtl b\nf 1/1 2/2 3/3\n");
    check_load("scene.obj", &[("scene.obj", obj.as_bytes()), ("scene.mtl", bytes)]);
}

/// The picture of a valid material. The first byte selects its name.
pub(crate) fn texture(bytes: &[u8]) {
    const NAMES: [&str; 12] = [
        "a.png", "a.jpg", "a.tga", "a.bmp", "a.hdr", "a", "a.webp", "a.tif", "a.gif", "a.dds", "a.ppm",
        "a.exr",
    ];
    let Some((first, bytes)) = bytes.split_first() else { return };
    texture_of(NAMES[usize::from(*first) % NAMES.len()], bytes);
}

/// A picture in WebP.
pub(crate) fn webp(bytes: &[u8]) {
    texture_of("a.webp", bytes);
}

/// A picture in TIFF.
pub(crate) fn tiff(bytes: &[u8]) {
    texture_of("a.tif", bytes);
}

/// A picture in GIF.
pub(crate) fn gif(bytes: &[u8]) {
    texture_of("a.gif", bytes);
}

/// A picture in DDS.
pub(crate) fn dds(bytes: &[u8]) {
    texture_of("a.dds", bytes);
}

/// A picture in OpenEXR.
pub(crate) fn exr(bytes: &[u8]) {
    texture_of("a.exr", bytes);
}

/// The picture of a valid material, with this name.
fn texture_of(name: &str, bytes: &[u8]) {
    let mtl = format!("newmtl a\nKd 1 1 1\nmap_Kd {name}\nmap_d {name}\nmap_Ke {name}\n");
    let obj = format!("mtllib scene.mtl\n{TRIANGLE}");
    check_load("scene.obj", &[("scene.obj", obj.as_bytes()), ("scene.mtl", mtl.as_bytes()), (name, bytes)]);
}

/// A mesh that is compressed by Draco, in a valid glTF model.
pub(crate) fn draco(bytes: &[u8]) {
    let json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 1}},
            "extensions": {{"KHR_draco_mesh_compression": {{"bufferView": 0,
                "attributes": {{"POSITION": 2, "NORMAL": 1, "TEXCOORD_0": 0}}}}}}}}]}}],
        "accessors": [{{"count": 25, "componentType": 5126, "type": "VEC3"}},
            {{"count": 25, "componentType": 5126, "type": "VEC2"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": {length}}}],
        "buffers": [{{"byteLength": {length}, "uri": "mesh.bin"}}]}}"#,
        length = bytes.len()
    );
    check_load("scene.gltf", &[("scene.gltf", json.as_bytes()), ("mesh.bin", bytes)]);
}

/// A buffer view that is compressed by meshoptimizer, in a valid glTF model. The first bytes select
/// mode and filter, a quarter of the stride, and the number of elements.
pub(crate) fn meshopt(bytes: &[u8]) {
    const MODES: [&str; 3] = ["ATTRIBUTES", "TRIANGLES", "INDICES"];
    const FILTERS: [&str; 5] = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"];
    let Some(([kind, quarter, count], stored)) = bytes.split_first_chunk() else { return };
    let (kind, stride) = (usize::from(*kind), usize::from(*quarter) * 4);
    let json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
        "accessors": [{{"bufferView": 0, "count": {count}, "componentType": 5126, "type": "VEC3"}}],
        "bufferViews": [{{"buffer": 1, "byteLength": {size}, "extensions": {{"EXT_meshopt_compression":
            {{"buffer": 0, "byteLength": {length}, "byteStride": {stride}, "count": {count},
            "mode": "{mode}", "filter": "{filter}"}}}}}}],
        "buffers": [{{"byteLength": {length}, "uri": "mesh.bin"}}, {{"byteLength": {size}}}]}}"#,
        size = stride * usize::from(*count),
        length = stored.len(),
        mode = MODES[kind % MODES.len()],
        filter = FILTERS[kind / MODES.len() % FILTERS.len()],
    );
    check_load("scene.gltf", &[("scene.gltf", json.as_bytes()), ("mesh.bin", stored)]);
}

/// A glTF model. Its first bytes decide between text and binary.
pub(crate) fn gltf(bytes: &[u8]) {
    let name = if bytes.starts_with(b"glTF") { "scene.glb" } else { "scene.gltf" };
    check_load(name, &[(name, bytes)]);
}

/// The sidecar of a valid model.
pub(crate) fn sidecar(bytes: &[u8]) {
    check_load("scene.obj", &[("scene.obj", TRIANGLE.as_bytes()), ("scene.afterimage.toml", bytes)]);
}

/// The changes of a scene that a session, or the note of a picture, holds.
pub(crate) fn session(bytes: &[u8]) {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    let scene = SCENE.get_or_init(|| {
        let mut loaded = None;
        in_folder(&[("scene.obj", TRIANGLE.as_bytes())], |folder| {
            loaded = load(&folder.join("scene.obj"), &limited(), &|_, _| true).ok();
        });
        loaded.expect("a valid model")
    });
    let folder = EditFolder { model: None, allow_outside: false };
    let text = String::from_utf8_lossy(bytes);
    let Ok(applied) = apply_edit_text(&text, folder, scene, &scene.to_edit()) else { return };
    assert!(applied.messages.iter().all(|message| !message.is_empty() && message.len() < 20_000));
    check_scene(&scene.with_edit(&applied.edit));
}

/// The light profile of a lamp.
pub(crate) fn ies(bytes: &[u8]) {
    let lamp = "[[point_light]]\nposition_m = [0, 0, 1]\nies = \"a.ies\"\n";
    let sidecar = ("scene.afterimage.toml", lamp.as_bytes());
    check_load("scene.obj", &[("scene.obj", TRIANGLE.as_bytes()), sidecar, ("a.ies", bytes)]);
}

/// A camera path.
pub(crate) fn walk(bytes: &[u8]) {
    for name in [None, Some("a")] {
        let Ok(walk) = CameraPath::from_json(bytes, name) else { continue };
        for frame in [0, 1, walk.frames / 2, walk.frames - 1] {
            check_camera(&walk.camera(frame, walk.frames).expect("a walk has key frames"));
        }
        assert!(walk.length_m() >= 0.0);
    }
}

/// The journal and the manifest of a run.
pub(crate) fn journal(bytes: &[u8]) {
    in_folder(&[("journal.jsonl", bytes), ("manifest.json", bytes)], |folder| {
        let before = Journal::read(folder).expect("a journal is read as far as it is whole");
        let _ = read_manifest(folder);
        let into = folder.join("merged");
        let _ = merge(&[folder.to_owned()], &into, afterimage::experiment::run::Session::default());
        let _ = std::fs::remove_dir_all(into);
        assert_eq!(Journal::open(folder).expect("a journal can be gone on with").done(), before);
        // Incomplete lines were removed from the file too.
        assert_eq!(Journal::read(folder).expect("a journal is read"), before);
    });
}

/// A picture to be compared, or dropped on the window.
pub(crate) fn picture(bytes: &[u8]) {
    in_folder(&[("a", bytes)], |folder| {
        let _ = read_notes(&folder.join("a"));
        let Ok(picture) = Picture::load(&folder.join("a")) else { return };
        assert_eq!(picture.values.len(), (picture.size[0] * picture.size[1]) as usize);
        assert!(picture.display(0.0).iter().all(|v| v.is_finite()));
    });
}

fn check_load(name: &str, files: &[(&str, &[u8])]) {
    in_folder(files, |folder| check(load(&folder.join(name), &limited(), &|_, _| true)));
}

/// Limits that small files do not reach, and that stop hostile ones early.
fn limited() -> ImportOptions {
    let mut options = ImportOptions::default();
    options.limits.texture_bytes = 4 << 20;
    options.limits.textures_bytes = 8 << 20;
    options.limits.buffers_bytes = 8 << 20;
    options.limits.gltf_vertices = 200_000;
    options
}

/// Asserts what must hold for every outcome.
pub(crate) fn check(outcome: Result<Scene, SceneError>) {
    match outcome {
        Ok(scene) => check_scene(&scene),
        Err(error) => {
            let message = error.to_string();
            assert!(!message.contains("importer failed"), "a panic inside: {message}");
            assert!(message.len() < 2000, "an endless message: {message}");
        }
    }
}

fn check_scene(scene: &Scene) {
    assert!(!scene.triangles.is_empty() && !scene.views.is_empty() && !scene.materials.is_empty());
    assert!(scene.bounds_m.iter().all(|b| b.is_finite()));
    assert!(scene.normals.iter().all(|n| n.is_finite()));
    assert!(scene.uvs.iter().all(|uv| uv.is_finite()));
    for (triangle, material) in scene.triangles.iter().zip(scene.triangle_materials.iter()) {
        assert!(triangle.iter().all(|v| scene.positions[*v as usize].is_finite()));
        assert!((material.0 as usize) < scene.materials.len());
    }
    scene.views.iter().for_each(|view| check_camera(&view.camera));
    scene.materials.iter().for_each(check_material);
    for texture in scene.textures.iter() {
        assert_eq!(texture.texels.len(), (texture.width * texture.height) as usize);
    }
    for warning in &scene.warnings {
        assert!(!warning.message.is_empty() && warning.message.len() < 20_000, "{warning:?}");
        assert!(!warning.file.is_empty(), "{warning:?}");
    }
}

fn check_material(m: &afterimage::scene::Material) {
    let specular = match m.kind {
        MaterialKind::Diffuse => glam::Vec3::ZERO,
        MaterialKind::Mirror { reflectance, .. } => reflectance,
        MaterialKind::Glass { eta, transmittance } => {
            assert!((1.0..=10.0).contains(&eta), "{m:?}");
            transmittance
        }
        MaterialKind::Glossy { reflectance, roughness } => {
            assert!((0.0..=1.0).contains(&roughness) && reflectance.max_element() <= 1.0, "{m:?}");
            // The coat covers the diffuse part, so their sum means nothing.
            glam::Vec3::ZERO
        }
        MaterialKind::Frosted { eta, transmittance, roughness } => {
            assert!((1.0..=10.0).contains(&eta) && (0.0..=1.0).contains(&roughness), "{m:?}");
            transmittance
        }
    };
    let sum = m.diffuse + specular;
    assert!(m.diffuse.min_element() >= 0.0 && specular.min_element() >= 0.0, "{m:?}");
    assert!(sum.max_element() <= 1.0 + 1e-5, "it reflects more than arrives: {m:?}");
    assert!(m.emission.is_finite() && m.emission.min_element() >= 0.0, "{m:?}");
}

fn check_camera(camera: &Camera) {
    assert!(camera.eye.is_finite() && camera.forward().is_finite(), "{camera:?}");
    assert!(camera.fov_y > 0.0 && camera.fov_y < std::f64::consts::PI, "{camera:?}");
}

/// Calls `work` with a folder that holds only these files.
fn in_folder(files: &[(&str, &[u8])], work: impl FnOnce(&Path)) {
    thread_local! {
        static FOLDER: RefCell<Option<tempfile::TempDir>> = const { RefCell::new(None) };
    }
    let folder: PathBuf = FOLDER.with(|folder| {
        let mut folder = folder.borrow_mut();
        let made = folder.get_or_insert_with(|| {
            // In memory where the system supports it: a fuzzer writes a million files.
            let memory = Path::new("/dev/shm");
            let in_memory = memory.is_dir().then(|| tempfile::tempdir_in(memory).ok()).flatten();
            in_memory.unwrap_or_else(|| tempfile::tempdir().expect("a temporary folder"))
        });
        made.path().to_owned()
    });
    for (name, bytes) in files {
        std::fs::write(folder.join(name), bytes).expect("a file in a temporary folder");
    }
    work(&folder);
    for (name, _) in files {
        let _ = std::fs::remove_file(folder.join(name));
    }
}
