//! A session next to a model is opened with it, whoever has written it. Whatever its bytes are, it
//! is read or refused with a message: without a panic, and in bounded time and memory.

use super::SessionFile;
use crate::window::rendering::SceneSource;
use crate::window::state::{AppState, Document, OpenDocument, SceneInfo, SunControls};
use afterimage::import::{ImportOptions, load};
use afterimage::{Scene, Tracer};
use proptest::prelude::*;
use std::path::Path;
use std::sync::{Arc, LazyLock};

const MODEL: &str =
    "o a\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no b\nusemtl b\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 4 5 6\n";

/// Pieces of sessions, valid and not.
const PIECES: &[&str] = &[
    "[edits]\n",
    "[edits.sky]\n",
    "[edits.sun]\n",
    "[[edits.material]]\n",
    "[[edits.object]]\n",
    "[[edits.lights]]\n",
    "[edits.ground]\n",
    "[sun]\n",
    "[camera]\n",
    "[[views]]\n",
    "[path]\n",
    "[[path.keyframes]]\n",
    "name = 'a'\n",
    "number = 2\n",
    "kind = 'mirror'\n",
    "kind = 'picture'\n",
    "picture = '/dev/zero'\n",
    "picture = '../x.hdr'\n",
    "off = true\n",
    "diffuse = [1e30, 0, 0]\n",
    "emission = 1e9\n",
    "move_m = [1e300, 0, 0]\n",
    "turn_deg = 1e308\n",
    "deleted = true\n",
    "height_m = -1e6\n",
    "without = ['sun', 'sky']\n",
    "samples = 4294967295\n",
    "eta = 1\n",
    "eye = [nan, inf, 0.0]\n",
    "at = [0, 0, 0]\n",
    "yaw = 1e308\n",
    "fov_y = 0.0\n",
    "frames = 1000000\n",
    "place = '52, 13'\ntime = '2026-06-21T12:00[Europe/Berlin]'\n",
    "year = -2147483648\n",
    "month = 99\n",
    "hours = 24.0\n",
    "exposure = inf\n",
    "exposure = 1e30\n",
    "zone = '\u{fffd}'\n",
    "[[[[",
    "'''",
    "\"\\u{0}\"",
    "= ",
    "\n",
    "{",
    "[",
    "1e999",
    "secs = -1\n",
];

struct Bench {
    folder: tempfile::TempDir,
    scene: Arc<Scene>,
    valid: String,
}

/// A model, and its session as the program writes it.
static BENCH: LazyLock<Bench> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("model.obj");
    std::fs::write(&model, MODEL).expect("a file");
    let scene = Arc::new(load(&model, &ImportOptions::default(), &|_, _| true).expect("a sound model"));
    let valid = SessionFile::example().text(None).expect("a session");
    Bench { folder, scene, valid }
});

/// Opens a session with the model, as the window does.
fn open(text: &str) {
    let Bench { folder, scene, .. } = &*BENCH;
    let Ok(session) = SessionFile::parse(text, Path::new("a.afterimage-session.toml")) else { return };
    let source = SceneSource::file(folder.path().join("model.obj"));
    let applied = session.edit(scene, &scene.to_edit(), &source, false);
    let files = Document { scene: scene.to_edit(), ..Document::default() };
    let info = SceneInfo::new(source, &Tracer::new(scene.clone()));
    let mut state = AppState { scene: Some(info), ..AppState::default() };
    state.document = Some(OpenDocument::new(files, state.quality));
    session.restore(&mut state, applied.edit);
    let document = state.document.as_ref().expect("it was just set").now();
    let edited = scene.with_edit(&document.scene);
    assert!(!edited.triangles.is_empty() && document.views.iter().all(|view| view.camera.is_valid()));
    let sun: &SunControls = &document.sun;
    let _ = (sun.words(), sun.daylight(), sun.position());
    let render = &state.quality.walk.render;
    assert!((1..=1 << 16).contains(&render.trace.samples), "a frame would never end");
    assert!(state.exposure_ev().is_finite());
    assert!(session.text(None).is_ok(), "it can be saved again");
}

/// A valid session of which some bytes are others, and some parts are doubled or gone.
fn mutated() -> impl Strategy<Value = String> {
    let edit = (any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..4_u8, 0..PIECES.len());
    prop::collection::vec(edit, 1..6).prop_map(|edits| {
        let mut bytes = BENCH.valid.clone().into_bytes();
        for (from, to, how, piece) in edits {
            let (a, b) = (from.index(bytes.len() + 1), to.index(bytes.len() + 1));
            let (a, b) = (a.min(b), a.max(b).min(a.min(b) + 200));
            let part = bytes[a..b].to_vec();
            match how {
                0 => drop(bytes.splice(a..b, [])),
                1 => drop(bytes.splice(a..a, part)),
                2 => drop(bytes.splice(a..a, PIECES[piece].bytes())),
                _ => bytes.iter_mut().skip(a).take(1).for_each(|byte| *byte = byte.wrapping_add(1)),
            }
        }
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// A valid session with pieces after it, which are well-formed more often.
fn extended() -> impl Strategy<Value = String> {
    prop::collection::vec(0..PIECES.len(), 0..12).prop_map(|pieces| {
        let end: String = pieces.into_iter().map(|piece| PIECES[piece]).collect();
        let edits = BENCH.valid.find("[[edits").unwrap_or(BENCH.valid.len());
        format!("{}{end}", &BENCH.valid[..edits])
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_are_no_session(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        open(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn a_damaged_session_is_opened_or_refused(text in mutated()) {
        open(&text);
    }

    #[test]
    fn a_session_with_more_in_it_is_opened_or_refused(text in extended()) {
        open(&text);
    }
}

#[test]
fn deep_and_long_sessions_end_with_a_message() {
    let deep = format!("version = 2\nx = {}", "[".repeat(200_000));
    let dotted = format!("version = 2\n{}x = 1", "a.".repeat(100_000));
    let tables = format!("version = 2\n[{}a]\n", "a.".repeat(100_000));
    for text in [deep, dotted, tables] {
        assert!(SessionFile::parse(&text, Path::new("a.afterimage-session.toml")).is_err());
    }
}

#[test]
fn what_is_not_possible_is_not_restored() {
    let many = BENCH.valid.replace("samples = 4\n", "samples = 4294967295\n");
    assert_ne!(many, BENCH.valid);
    open(&many);
}
