//! The importer with small files: each is one way in which real files are wrong.

mod cases;
mod files;
mod gltf;
mod habits;
mod lamps;
mod limits;
mod lines;
mod materials;
mod objects;
mod properties;
mod real;
mod saving;
mod sidecar;
mod sky;
mod textures;

use afterimage::import::{ImportOptions, load};
use afterimage::scene::{Material, Scene, SceneError};
use std::path::PathBuf;
use tempfile::TempDir;

/// A triangle of area 1/2, as simple as an OBJ file can be.
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A temporary folder with a model in it.
struct Folder {
    dir: TempDir,
    options: ImportOptions,
}

impl Folder {
    /// A folder with `scene.obj`.
    fn with_obj(text: impl AsRef<[u8]>) -> Self {
        let folder = Self { dir: tempfile::tempdir().unwrap(), options: ImportOptions::default() };
        folder.add("scene.obj", text)
    }

    /// A folder with `scene.obj`, which has a triangle of each material, and `scene.mtl`.
    fn with_mtl(materials: &[&str], mtl: impl AsRef<[u8]>) -> Self {
        let mut obj = "mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n".to_owned();
        materials.iter().for_each(|m| obj += &format!("usemtl {m}\nf 1/1 2/2 3/3\n"));
        Self::with_obj(obj).add("scene.mtl", mtl)
    }

    fn add(self, name: &str, bytes: impl AsRef<[u8]>) -> Self {
        let path = self.dir.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
        self
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn try_load(&self) -> Result<Scene, SceneError> {
        self.try_load_file("scene.obj")
    }

    fn try_load_file(&self, name: &str) -> Result<Scene, SceneError> {
        load(&self.path(name), &self.options, &|_, _| true)
    }

    fn load(&self) -> Scene {
        self.try_load().unwrap()
    }
}

fn load_obj(text: impl AsRef<[u8]>) -> Scene {
    Folder::with_obj(text).load()
}

/// Returns the area of all triangles in square metres.
fn area_m2(scene: &Scene) -> f64 {
    let area = |t: u32| {
        let [a, b, c] = scene.corners(t).map(|p| p.as_dvec3());
        (b - a).cross(c - a).length() / 2.0
    };
    let sum: f64 = (0..scene.triangles.len() as u32).map(area).sum();
    sum / scene.frame.units_per_metre.powi(2)
}

fn material<'a>(scene: &'a Scene, name: &str) -> &'a Material {
    let found = scene.materials.iter().find(|m| m.name == name);
    found.unwrap_or_else(|| panic!("no material '{name}' in {:?}", scene.materials))
}

/// Returns file, line and message of the warning that contains `part`.
fn warning<'a>(scene: &'a Scene, part: &str) -> (&'a str, u64, &'a str) {
    let found = scene.warnings.iter().find(|w| w.message.contains(part));
    let w = found.unwrap_or_else(|| panic!("no warning with '{part}' in {:#?}", scene.warnings));
    (&w.file, w.line, &w.message)
}

/// Returns the warnings except those that every small file causes: no light, and faces before any
/// `usemtl`.
fn doubts(scene: &Scene) -> Vec<&str> {
    let all = scene.warnings.iter().map(|w| w.message.as_str());
    all.filter(|m| !m.contains("no light") && !m.contains("before any usemtl")).collect()
}

fn assert_clean(scene: &Scene) {
    assert_eq!(doubts(scene), Vec::<&str>::new());
}
