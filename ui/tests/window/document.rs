//! One document: saved whole, recovered whole, merged with files that change. Each test that names
//! what happened before fails without the one document.

use super::*;
use afterimage::import::{ImportOptions, Unit};
use afterimage::scene::{Material, MaterialKind};
use afterimage_ui::window::state::{OpenDocument, Severity};
use eframe::App as _;
use egui::{Key, Modifiers};
use std::path::Path;

const WALL: &str = "usemtl wall\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nf 1 2 3 4\n";

/// A model in a folder of its own, and a folder for the state of the program.
struct House {
    folder: tempfile::TempDir,
}

impl House {
    fn new() -> Self {
        let house = Self { folder: tempfile::tempdir().expect("a folder") };
        std::fs::create_dir(house.path("model")).expect("a folder");
        std::fs::write(house.path("model/wall.obj"), WALL).expect("a file");
        house
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn session(&self) -> PathBuf {
        self.path("model/wall.afterimage-session.toml")
    }

    fn request(&self, scene: &Path) -> LaunchOptions {
        LaunchOptions {
            scene: Some(SceneSource::file(scene)),
            pictures: Some(self.folder.path().to_owned()),
            state_folder: Some(self.path("state")),
            ..request()
        }
    }

    fn open(&self) -> Harness<'static, App> {
        open(self.request(&self.path("model/wall.obj")), false)
    }

    /// The sessions that are kept in case of a crash.
    fn kept(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.path("state")).into_iter().flatten();
        let is_kept = |path: &PathBuf| {
            let name = path.to_string_lossy();
            name.contains("recovery-") && name.ends_with(".toml")
        };
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_kept).collect()
    }
}

fn document(app: &App) -> &OpenDocument {
    app.state().document.as_ref().expect("a document")
}

fn is_mirror(app: &App) -> bool {
    let mirrors = |m: &Material| matches!(m.kind, MaterialKind::Mirror { .. });
    app.state().document.as_ref().is_some_and(|d| d.scene().materials.iter().any(mirrors))
}

fn has_view(app: &App, key: u8) -> bool {
    app.state().views().iter().any(|view| view.key == Some(key))
}

fn make_mirror(window: &mut Harness<'static, App>) {
    editing::click(window, 0.0, 0.0);
    window.get_by_label("Mirror").click_accesskit();
    step_until(window, "a mirror", is_mirror);
}

/// Changes the material, a view and the path, by click and keys.
fn change_all(window: &mut Harness<'static, App>) {
    make_mirror(window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Num7);
    window.step();
    window.key_press(Key::K);
    step_until(window, "a key of the path", |app| app.state().has_own_path() && has_view(app, 7));
}

fn has_all(app: &App) -> bool {
    is_mirror(app) && has_view(app, 7) && app.state().has_own_path()
}

fn save(window: &mut Harness<'static, App>) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    step_until(window, "a saved session", |app| !app.state().is_unsaved());
}

fn drop_on(window: &mut Harness<'static, App>, path: PathBuf) {
    window.input_mut().dropped_files.push(Arc::new(driving::Dropped(path)));
}

#[test]
fn a_reload_keeps_views_path_and_undo_history_which_it_deleted_before() {
    let house = House::new();
    let mut window = house.open();
    change_all(&mut window);
    window.get_by_label("Save changes").click_accesskit();
    step_until(&mut window, "a saved scene", |app| !document(app).differs_from_files());
    assert!(window.state().state().is_unsaved(), "view and path are not in the sidecar");
    let triangles = |app: &App| app.state().scene.as_ref().map_or(0, |s| s.triangles);
    let before = triangles(window.state());
    std::fs::write(house.path("model/wall.obj"), format!("{WALL}f 1 3 2\n")).expect("a file");
    step_until(&mut window, "the new model", |app| triangles(app) == before + 1);
    assert!(has_all(window.state()));
    window.key_press(Key::F5);
    window.step();
    settle(&mut window);
    assert!(has_all(window.state()));
    let mut undone = 0;
    while document(window.state()).can_undo() {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        window.run_steps(2);
        undone += 1;
    }
    assert_eq!(undone, 3);
    assert!(!is_mirror(window.state()) && !has_view(window.state(), 7));
}

#[test]
fn ctrl_s_saves_everything_and_the_model_opens_with_it_where_materials_were_left_out_before() {
    let house = House::new();
    let mut window = house.open();
    change_all(&mut window);
    window.get_by_label("Unsaved changes");
    save(&mut window);
    window.run_steps(2);
    assert!(window.query_by_label("Unsaved changes").is_none());
    let saved = document(window.state()).now().clone();
    drop(window);
    let window = house.open();
    assert!(says(window.state(), "with the session"));
    assert_eq!(*document(window.state()).now(), saved);
    assert!(!window.state().state().is_unsaved());
    let placed = Camera::look_at(glam::DVec3::new(0.5, 1.0, 4.0), glam::DVec3::Y, 50.0);
    let request = LaunchOptions { camera: Some(placed), ..house.request(&house.path("model/wall.obj")) };
    assert_eq!(camera(&open(request, false)), placed, "flags take precedence");
}

#[test]
fn what_is_saved_before_its_own_session_is_opened_again_stays_where_the_old_session_came_back() {
    let house = House::new();
    let mut window = house.open();
    save(&mut window);
    make_mirror(&mut window);
    drop_on(&mut window, house.session());
    step_until(&mut window, "the question", |app| app.state().dialogs.leaving.is_some());
    window.run_steps(2);
    window.get_by_label("Save").click_accesskit();
    // A restored document has no steps.
    step_until(&mut window, "the session", |app| !document(app).can_undo());
    settle(&mut window);
    assert!(is_mirror(window.state()) && !window.state().state().is_unsaved());
    assert!(std::fs::read_to_string(house.session()).expect("the session").contains("mirror"));
}

#[test]
fn a_unit_given_by_hand_comes_back_with_the_session() {
    let house = House::new();
    let options = ImportOptions { unit: Some(Unit::Millimetre), ..ImportOptions::default() };
    let source = SceneSource::File { path: house.path("model/wall.obj"), options };
    let mut window = open(LaunchOptions { scene: Some(source), ..house.request(Path::new("")) }, false);
    let extent = |app: &App| app.state().scene.as_ref().map(|scene| scene.extent_m);
    let before = extent(window.state());
    save(&mut window);
    drop(window);
    let window = open(house.request(&house.session()), false);
    assert_eq!(extent(window.state()), before);
}

#[test]
fn loading_again_does_not_take_the_place_of_another_scene_that_is_being_opened() {
    let house = House::new();
    let other = house.path("other.obj");
    std::fs::write(&other, format!("{WALL}f 1 3 2\n")).expect("a file");
    let mut window = house.open();
    let triangles = |app: &App| app.state().scene.as_ref().map_or(0, |s| s.triangles);
    let before = triangles(window.state());
    drop_on(&mut window, other);
    window.step();
    window.key_press(Key::F5);
    step_until(&mut window, "the other scene", |app| triangles(app) == before + 1);
    settle(&mut window);
    assert_eq!(triangles(window.state()), before + 1);
}

#[test]
fn a_session_finds_its_model_after_the_folder_was_moved_which_failed_before() {
    let house = House::new();
    let mut window = house.open();
    change_all(&mut window);
    save(&mut window);
    drop(window);
    let text = std::fs::read_to_string(house.session()).expect("a session");
    assert!(text.contains("scene = \"wall.obj\""), "{text}");
    std::fs::rename(house.path("model"), house.path("elsewhere")).expect("a moved folder");
    let session = house.path("elsewhere/wall.afterimage-session.toml");
    let window = open(house.request(&session), false);
    assert!(has_all(window.state()));
}

#[test]
fn after_a_crash_everything_comes_back_where_materials_were_lost_before() {
    let house = House::new();
    let mut window = house.open();
    change_all(&mut window);
    let is_kept = || {
        let text = house.kept().first().and_then(|path| std::fs::read_to_string(path).ok());
        text.is_some_and(|text| text.contains("mirror") && text.contains("[[path.keyframes]]"))
    };
    step_until(&mut window, "a kept session", |_| is_kept());
    let changed = document(window.state()).now().clone();
    // The process is gone: `on_exit` is not called, and no process has this number.
    drop(window);
    let kept = house.kept().remove(0);
    let left = house.path("state/recovery-4000000000.afterimage-session.toml");
    std::fs::rename(kept, &left).expect("a kept session");
    let mut window = begin(house.request(&house.path("model/wall.obj")), false);
    window.step();
    window.get_by_label("Restore").click();
    settle(&mut window);
    assert_eq!(*document(window.state()).now(), changed);
    assert!(window.state().state().is_unsaved(), "it is in no file of the user");
    assert!(!left.exists() && house.kept().len() == 1, "it is kept for this process now");
}

#[test]
fn the_system_ends_the_program_without_a_question_and_loses_nothing() {
    let house = House::new();
    for is_changed in [true, false] {
        let mut window = house.open();
        if is_changed {
            change_all(&mut window);
        }
        window.state().ended().store(true, std::sync::atomic::Ordering::Relaxed);
        window.step();
        assert!(sends(&window, &egui::ViewportCommand::Close));
        assert!(window.state().state().dialogs.leaving.is_none());
        window.state_mut().on_exit();
        assert_eq!(house.kept().len(), usize::from(is_changed));
        house.kept().iter().for_each(|path| std::fs::remove_file(path).expect("a file"));
    }
}

#[test]
fn undo_of_light_keeps_place_and_time_which_flipped_to_a_direction_before() {
    let mut window = app();
    show_tab(&mut window, "Look");
    window.get_by_label("Sun").click_accesskit();
    window.run_steps(3);
    window.get_by_label("By place and time").click_accesskit();
    window.run_steps(3);
    settle(&mut window);
    let is_by_place = |app: &App| document(app).now().sun.is_by_place;
    show_tab(&mut window, "Scene");
    editing::click(&mut window, 0.0, 180.0);
    window.get_by_label("Mirror").click_accesskit();
    window.run_steps(2);
    show_tab(&mut window, "Look");
    window.get_by_label("Sky").click_accesskit();
    step_until(&mut window, "a sky", |app| document(app).scene().daylight.sky.is_some());
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    step_until(&mut window, "no sky", |app| document(app).scene().daylight.sky.is_none());
    assert!(is_by_place(window.state()));
    for _ in 0..2 {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        window.run_steps(2);
    }
    assert!(!is_by_place(window.state()), "as it was before");
}

#[test]
fn a_picture_brings_back_its_materials_which_it_did_not_say_before() {
    let house = House::new();
    let mut window = house.open();
    make_mirror(&mut window);
    settle(&mut window);
    window.key_press(Key::F12);
    step_until(&mut window, "a picture", |app| says(app, "png"));
    let picture = house.path("afterimage-wall-0001.png");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    step_until(&mut window, "a matte wall", |app| !is_mirror(app));
    settle(&mut window);
    drop_on(&mut window, picture);
    step_until(&mut window, "the mirror", is_mirror);
    assert!(says(window.state(), "those of the picture"));
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    step_until(&mut window, "a matte wall", |app| !is_mirror(app));
}

#[test]
fn a_hostile_note_in_a_picture_is_reported_and_changes_nothing() {
    let house = House::new();
    let mut window = house.open();
    let before = document(window.state()).now().clone();
    let scene = format!("{} 0", house.path("model/wall.obj").display());
    let sky = "version = 2\nscene = 'x'\nmode = 'exact'\nsamples = 1\nbounces = 1\nexposure = 0.0\ntone_map = 'linear'\n\
               [camera]\neye = [0.0, 0.0, 0.0]\nyaw = 0.0\npitch = 0.0\nfov_y = 1.0\nroll = 0.0\n\
               [edits.sky]\nkind = 'picture'\npicture = '/etc/passwd'\n";
    let long = "x".repeat((1 << 20) + 1);
    for (note, expected) in
        [("version = ", "not restored"), (sky, "/etc/passwd"), (long.as_str(), "not read")]
    {
        let file = house.path("hostile.png");
        let pose = "--eye 0,1,4 --look-at 0,1,0 --fov-y 60".to_owned();
        let notes = [("Scene", scene.clone()), ("Pose", pose), ("Document", note.to_owned())];
        afterimage::raster::save::save_png(&file, [1, 1], &[[0; 3]], &notes).expect("a picture");
        drop_on(&mut window, file);
        step_until(&mut window, expected, |app| {
            app.state().notices.iter().any(|n| n.severity == Severity::Error && n.text.contains(expected))
        });
        assert_eq!(*document(window.state()).now(), before);
    }
}

#[test]
fn a_texture_that_appears_or_changes_is_loaded() {
    let house = House::new();
    let mtl = "newmtl wall\nKd 1 1 1\nmap_Kd paint.png\n";
    std::fs::write(house.path("model/wall.mtl"), mtl).expect("a file");
    let textured = WALL.replace("f 1 2 3 4", "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4");
    std::fs::write(house.path("model/wall.obj"), format!("mtllib wall.mtl\n{textured}")).expect("a file");
    let mut window = house.open();
    let is_warned = |app: &App| {
        app.state().scene.as_ref().is_some_and(|s| s.warnings.iter().any(|w| w.message.contains("paint.png")))
    };
    assert!(is_warned(window.state()), "the picture is missing");
    let picture = image::RgbaImage::from_pixel(2, 2, image::Rgba([200, 40, 40, 255]));
    picture.save(house.path("model/paint.png")).expect("a picture");
    step_until(&mut window, "the picture that appeared", |app| !is_warned(app));
    std::fs::write(house.path("model/paint.png"), "no picture any more").expect("a file");
    step_until(&mut window, "the picture that changed", is_warned);
}
