//! A soak of the document: random edits, undo, redo, saving, reloading, kills and recoveries, with
//! the code that writes and reads files. Nothing may be lost.

use super::{SessionFile, write_session};
use crate::window::export::Destination;
use crate::window::rendering::SceneSource;
use crate::window::state::{AppState, Change, Document, OpenDocument, SavedView, SceneInfo, SunControls};
use afterimage::camera::{CameraKey, CameraPath};
use afterimage::import::{ImportOptions, load, save_edit};
use afterimage::scene::{
    Ground, LightSetting, Material, MaterialId, MaterialKind, ObjectEdit, ObjectKey, Scene,
    solar::SunPosition,
};
use afterimage::{Camera, Tracer};
use glam::{DVec3, Vec3};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Table;

const SEQUENCES: u64 = 200;
const STEPS: usize = 25;

const MODEL: &str = "o box\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no lid\nusemtl b\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 4 5 6\n";

/// Random numbers, the same in every run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, sides: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % sides
    }

    fn unit(&mut self) -> f64 {
        self.below(1 << 20) as f64 / f64::from(1 << 20)
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), 4.0 * self.unit() + 1.0)
    }

    fn camera(&mut self) -> Camera {
        Camera::look_at(self.point(), DVec3::new(0.3, 0.3, -1.0), 60.0)
    }
}

/// The window's state over the files of a model.
struct Desk {
    folder: tempfile::TempDir,
    scene: Arc<Scene>,
    state: AppState,
    file: Option<PathBuf>,
}

impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("model.obj"), MODEL).unwrap();
        let (scene, state) = opened(&folder.path().join("model.obj"));
        Self { folder, scene, state, file: None }
    }

    fn model(&self) -> PathBuf {
        self.folder.path().join("model.obj")
    }

    fn document(&mut self) -> &mut OpenDocument {
        self.state.document.as_mut().unwrap()
    }

    fn now(&self) -> &Document {
        self.state.document.as_ref().unwrap().now()
    }

    fn change(&mut self, dice: &mut Dice) {
        let now = self.now().clone();
        let change = match dice.below(8) {
            0 => {
                let id = dice.below(now.scene.materials.len() as u64) as u32;
                let material = material(dice, &now.scene.materials[id as usize]);
                Change::Material(MaterialId(id), Box::new(material))
            }
            1 => {
                let name = ["box", "lid"][dice.below(2) as usize];
                let moved_m = if dice.below(3) == 0 { DVec3::ZERO } else { dice.point() };
                // Something of the model must be left.
                let is_hidden = name == "lid" && dice.below(3) == 0;
                let edit = ObjectEdit { moved_m, is_hidden, ..ObjectEdit::default() };
                Change::Object(ObjectKey::first(name), edit)
            }
            2 => daylight(dice, &now.sun),
            7 => Change::Ground((dice.below(2) == 0).then(|| ground(dice))),
            3 => {
                let setting = LightSetting { intensity: dice.unit() as f32, ..LightSetting::FULL };
                Change::Light(["sun", "sky"][dice.below(2) as usize].to_owned(), setting)
            }
            4 => {
                let view = |dice: &mut Dice, i| SavedView {
                    name: format!("view {i}"),
                    camera: dice.camera(),
                    key: None,
                };
                Change::Views((0..=dice.below(4)).map(|i| view(dice, i)).collect())
            }
            5 => {
                let keyframes = (0..dice.below(4)).map(|_| key(dice)).collect();
                let path = CameraPath { fov_y_deg: 50.0, frames: 90, keyframes };
                Change::Path(Some(path).filter(|path| !path.keyframes.is_empty()))
            }
            _ => Change::Measures((0..dice.below(3)).map(|_| [dice.point(), dice.point()]).collect()),
        };
        self.document().change(change);
    }

    fn session(&self) -> SessionFile {
        SessionFile::of(&self.state, &Table::new()).unwrap()
    }

    fn save(&mut self) {
        let nowhere = Destination { folders: Vec::new(), stem: String::new() };
        let path = write_session(&self.session(), self.file.clone(), &nowhere).unwrap();
        self.file = Some(path);
        let (now, quality) = (self.now().clone(), self.state.quality);
        self.document().set_saved(now, quality);
        assert!(!self.state.is_unsaved());
    }

    fn save_sidecar(&mut self) {
        let (model, now) = (self.model(), self.now().clone());
        save_edit(&model, &self.document().files().scene.clone(), &now.scene).unwrap();
        self.document().set_saved_in_files(now);
        assert!(!self.document().differs_from_files());
    }

    /// Loads the model again, perhaps with another colour of a material that the user has not
    /// touched.
    fn reload(&mut self, is_changed: bool) {
        let before = self.now().clone();
        let mut files = self.document().files().clone();
        if is_changed {
            files.scene.materials.push(Material::diffuse("new", Vec3::splat(0.25)));
            files.scene.materials.rotate_right(1);
        }
        let carried = self.document().carried_to(files, &|_| true);
        assert_eq!(carried.dropped_steps, 0);
        let now = carried.document.now().clone();
        for material in &before.scene.materials {
            let same = now.scene.materials.iter().find(|m| m.name == material.name);
            assert_eq!(same, Some(material));
        }
        assert_eq!((&now.scene.objects, &now.views), (&before.scene.objects, &before.views));
        assert_eq!((&now.path, &now.measures), (&before.path, &before.measures));
        if !is_changed {
            assert_eq!(now, before);
            self.state.document = Some(carried.document);
        }
    }

    /// The program is killed; the next one restores the text that was kept, over the model's files.
    fn recover(&mut self) {
        let text = self.session().text(None).unwrap();
        let before = self.now().clone();
        (self.scene, self.state) = opened(&self.model());
        restore(&text, Path::new("recovery"), &mut self.state, &self.scene);
        assert_same(self.now(), &before);
    }

    /// The program ends, and opens the session that was saved last.
    fn open_saved(&mut self) {
        let Some(file) = self.file.clone() else { return };
        let saved = self.document().saved().clone();
        (self.scene, self.state) = opened(&self.model());
        let text = std::fs::read_to_string(&file).unwrap();
        restore(&text, &file, &mut self.state, &self.scene);
        assert_same(self.now(), &saved);
        let (now, quality) = (self.now().clone(), self.state.quality);
        self.document().set_saved(now, quality);
    }
}

fn opened(model: &Path) -> (Arc<Scene>, AppState) {
    let scene = Arc::new(load(model, &ImportOptions::default(), &|_, _| true).unwrap());
    let info = SceneInfo::new(SceneSource::file(model), &Tracer::new(scene.clone()));
    let mut sun = SunControls { nits_per_unit: scene.nits_per_unit(), ..SunControls::default() };
    sun.show(&scene.to_edit().daylight);
    let files = Document { scene: scene.to_edit(), sun, views: info.views.clone(), ..Document::default() };
    let mut state = AppState { scene: Some(info), ..AppState::default() };
    state.document = Some(OpenDocument::new(files, state.quality));
    state.navigation.fly.jump_to(scene.views[0].camera);
    (scene, state)
}

fn restore(text: &str, file: &Path, state: &mut AppState, scene: &Scene) {
    let (session, source) = (SessionFile::parse(text, file).unwrap(), &state.scene.as_ref().unwrap().source);
    let applied = session.edit(scene, &scene.to_edit(), source, true);
    assert!(applied.messages.is_empty(), "{:?}\n{text}", applied.messages);
    session.restore(state, applied.edit);
}

fn material(dice: &mut Dice, now: &Material) -> Material {
    let mut part = || Vec3::new(dice.unit() as f32, dice.unit() as f32, dice.unit() as f32) * 0.9;
    let (color, other) = (part(), part());
    let (kind, diffuse) = match dice.below(4) {
        0 => (MaterialKind::Mirror { reflectance: color, fresnel: dice.below(2) == 0 }, Vec3::ZERO),
        1 => (MaterialKind::Glass { eta: 1.1 + dice.unit() as f32, transmittance: color }, Vec3::ZERO),
        2 => {
            let (eta, roughness) = (1.1 + dice.unit() as f32, 0.1 + 0.8 * dice.unit() as f32);
            (MaterialKind::Frosted { eta, transmittance: color, roughness }, Vec3::ZERO)
        }
        _ => (MaterialKind::Diffuse, color),
    };
    Material { kind, diffuse, emission: if dice.below(4) == 0 { other } else { now.emission }, ..now.clone() }
}

fn key(dice: &mut Dice) -> CameraKey {
    let secs = (dice.below(2) == 0).then(|| (100.0 * dice.unit()).round() / 10.0);
    CameraKey { secs, ..CameraKey::new(dice.point(), DVec3::ZERO) }
}

fn ground(dice: &mut Dice) -> Ground {
    Ground { height_m: dice.unit() * 3.0 - 1.5, albedo: dice.unit() as f32 * 0.9 }
}

fn daylight(dice: &mut Dice, now: &SunControls) -> Change {
    let mut sun = SunControls { is_by_place: dice.below(2) == 0, ..now.clone() };
    sun.direction = SunPosition { azimuth_deg: 360.0 * dice.unit(), height_deg: 80.0 * dice.unit() + 1.0 };
    sun.place.hours = 24.0 * dice.unit();
    sun.north_deg = (90.0 * dice.unit()).round();
    (sun.has_sky, sun.has_sun) = (dice.below(3) > 0, dice.below(3) > 0);
    let daylight = sun.daylight();
    Change::Daylight(daylight, Box::new(sun))
}

/// All but the last bits of directions, which files hold as decimals of unit vectors.
fn assert_same(a: &Document, b: &Document) {
    assert_eq!(a.scene.materials, b.scene.materials);
    assert_eq!(a.scene.objects, b.scene.objects);
    assert_eq!((&a.scene.lights, a.scene.ground), (&b.scene.lights, b.scene.ground));
    assert_eq!((&a.views, &a.path, &a.measures, &a.sun), (&b.views, &b.path, &b.measures, &b.sun));
    let (a, b) = (&a.scene.daylight, &b.scene.daylight);
    assert_eq!(a.sky.is_some(), b.sky.is_some());
    match (a.sun, b.sun) {
        (Some(a), Some(b)) => {
            assert!(a.direction.distance(b.direction) < 1e-6);
            assert_eq!(a.irradiance, b.irradiance);
        }
        (a, b) => assert_eq!(a, b),
    }
}

#[test]
fn nothing_is_lost_in_two_hundred_random_sessions() {
    for seed in 0..SEQUENCES {
        let (mut desk, mut dice) = (Desk::new(), Dice(seed + 1));
        for _ in 0..STEPS {
            match dice.below(14) {
                0..=5 => desk.change(&mut dice),
                6 | 7 => drop(desk.document().undo()),
                8 => drop(desk.document().redo()),
                9 => desk.save(),
                10 => desk.save_sidecar(),
                11 => desk.reload(dice.below(2) == 0),
                12 => desk.recover(),
                _ => {
                    desk.save();
                    desk.open_saved();
                }
            }
        }
    }
}
