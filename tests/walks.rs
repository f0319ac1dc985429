//! Whole scenes, rendered along walks: our own, imported from a file, and third-party scenes where
//! they are present.

use afterimage::import::{ImportOptions, load};
use afterimage::{
    FrameRequest, Mode, RenderSettings, Renderer, Tracer, camera::CameraPath, reference::ReferenceFrame,
    trace::TraceSettings, trace::parallel::NEVER,
};
use std::io::Write as _;
use std::{collections::BTreeMap, path::Path, sync::Arc};

const SIZE: [u32; 2] = [64, 36];
const TRACE: TraceSettings = TraceSettings { samples: 1, bounces: 1, seed: 0 };

fn open(path: &Path) -> Tracer {
    Tracer::new(Arc::new(load(path, &ImportOptions::default(), &|_, _| true).unwrap()))
}

/// Renders a few frames of a walk in mode `paper`, each from a reference taken two frames before.
fn walk(name: &str, tracer: &Tracer, path: &CameraPath) {
    let mut renderer = Renderer::default();
    let settings = RenderSettings { mode: Mode::Paper, trace: TRACE };
    let (mut lit, mut reused, mut pixels) = (0, 0, 0);
    for frame in [10, 120, 240] {
        let [before, camera] = [frame - 2, frame].map(|f| path.camera(f, 300).unwrap());
        let reference = ReferenceFrame::trace(tracer, &before, SIZE, &TRACE, NEVER).unwrap();
        let frame =
            renderer.render(&FrameRequest::new(tracer, &camera, SIZE, &settings).warping(&[&reference]));
        assert!(frame.radiance.iter().all(|r| r.is_finite() && r.min_element() >= 0.0), "{name}");
        assert_eq!(frame.stats.types.total(), frame.radiance.len(), "{name}");
        lit += frame.radiance.iter().filter(|r| r.max_element() > 0.0).count();
        reused += frame.stats.types.reused + frame.stats.types.secondary;
        pixels += frame.radiance.len();
    }
    // A house lit through small windows is mostly black with one sample: the light of the sky is
    // found by the one path of a pixel, not by a shadow ray of its own.
    assert!(lit * 40 > pixels, "{name}: {lit} of {pixels} pixels are lit");
    assert!(reused * 4 > pixels, "{name}: {reused} of {pixels} pixels are reused");
}

#[test]
fn our_own_model_is_imported_completely() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/studio");
    let tracer = open(&folder.join("studio.obj"));
    let scene = tracer.scene();
    assert_eq!(scene.warnings, []);
    assert!(scene.features.mirror && scene.features.glass && scene.features.textures && scene.features.sky);
    assert!(scene.triangles.len() > 3000 && scene.views.len() > 1 && scene.lights.len() > 3);
    assert!(!scene.solids.is_empty());
    walk("studio", &tracer, &scene.walk);
}

#[test]
fn third_party_scenes_can_be_walked() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    let Ok(text) = std::fs::read(folder.join("cameras.json")) else {
        let _ = writeln!(std::io::stderr(), "skipped: {} has no cameras.json", folder.display());
        return;
    };
    let cameras: BTreeMap<String, serde_json::Value> = serde_json::from_slice(&text).unwrap();
    for (name, entry) in cameras {
        let path: CameraPath = serde_json::from_value(entry.clone()).unwrap();
        // One of the variants represents all: `CornellBox-*.obj`.
        let file = folder.join(entry["file"].as_str().unwrap().replace('*', "Mirror"));
        walk(&name, &open(&file), &path);
    }
}
