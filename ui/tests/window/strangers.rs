//! Sessions that come from elsewhere: what they name is read only where that is allowed.

use super::*;
use afterimage::scene::SkyKind;
use egui::Key;
use std::path::Path;

const WALL: &str = "usemtl wall\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nf 1 2 3 4\n";

/// A model with a session next to it, and pictures of the sky in its folder and outside it.
struct Received {
    folder: tempfile::TempDir,
}

impl Received {
    fn new() -> Self {
        let received = Self { folder: tempfile::tempdir().expect("a folder") };
        std::fs::create_dir(received.path("model")).expect("a folder");
        std::fs::write(received.path("model/wall.obj"), WALL).expect("a file");
        let sky = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n";
        for name in ["model/inside.hdr", "outside.hdr"] {
            std::fs::write(received.path(name), [&sky[..], &[128; 128]].concat()).expect("a file");
        }
        received
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Opens the model whose session names this picture of the sky.
    fn open_with_sky(&self, picture: &Path) -> Harness<'static, App> {
        let text = format!(
            "version = 2\nscene = 'wall.obj'\nmode = 'exact'\nsamples = 1\nbounces = 1\nexposure = 0.0\n\
             tone_map = 'linear'\n[camera]\neye = [0.0, 1.0, 4.0]\nyaw = 0.0\npitch = 0.0\nfov_y = 1.0\n\
             roll = 0.0\n[edits.sky]\nkind = 'picture'\npicture = '{}'\n",
            picture.display()
        );
        std::fs::write(self.path("model/wall.afterimage-session.toml"), text).expect("a file");
        let scene = Some(SceneSource::file(self.path("model/wall.obj")));
        begin(LaunchOptions { scene, ..request() }, false)
    }
}

fn kind(app: &App) -> Option<SkyKind> {
    let document = app.state().document.as_ref()?;
    document.scene().daylight.sky.as_ref().map(afterimage::scene::Sky::kind)
}

fn asks(app: &App) -> bool {
    app.state().dialogs.outside_picture.is_some()
}

#[test]
fn a_session_uses_a_sky_in_the_folder_of_its_model_without_a_question() {
    let received = Received::new();
    let mut window = received.open_with_sky(Path::new("inside.hdr"));
    step_until(&mut window, "the sky or a question", |app| kind(app).is_some() || asks(app));
    assert_eq!((kind(window.state()), asks(window.state())), (Some(SkyKind::Picture), false));
    assert!(!window.state().state().is_unsaved());
}

#[test]
fn a_sky_outside_the_folder_is_read_only_where_the_user_agrees() {
    let received = Received::new();
    for picture in [received.path("outside.hdr"), PathBuf::from("../outside.hdr")] {
        let mut window = received.open_with_sky(&picture);
        step_until(&mut window, "the question", asks);
        window.run_steps(2);
        assert!(kind(window.state()).is_none(), "nothing is shown before the answer");
        window.key_press(Key::Enter);
        step_until(&mut window, "the scene", |app| kind(app).is_some());
        assert_eq!(kind(window.state()), Some(SkyKind::Gradient), "the first answer reads nothing");
        assert!(says(window.state(), "was left out"));
        let mut window = received.open_with_sky(&picture);
        step_until(&mut window, "the question", asks);
        window.run_steps(2);
        window.get_by_label("Read it").click_accesskit();
        step_until(&mut window, "the scene", |app| kind(app).is_some());
        assert_eq!(kind(window.state()), Some(SkyKind::Picture));
    }
}
