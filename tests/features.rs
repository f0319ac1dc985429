//! The renderer skips the features that a scene does not use, which does not change its pictures.

use afterimage::lookup::LookupSet;
use afterimage::reference::{ReferenceCache, ReferenceFrame};
use afterimage::scene::{Scene, SceneFeatures, builtin};
use afterimage::trace::TraceSettings;
use afterimage::trace::parallel::NEVER;
use afterimage::{FrameRequest, Mode, RenderSettings, Renderer, Tracer};
use glam::Vec3;
use std::sync::Arc;

const SIZE: [u32; 2] = [64, 40];
const TRACE: TraceSettings = TraceSettings { samples: 2, bounces: 1, seed: 9 };

/// Returns the pictures of mode `full` and of both lookup modes, with references traced for them.
fn pictures(scene: Scene) -> Vec<Vec<Vec3>> {
    let tracer = Tracer::new(Arc::new(scene));
    let [from, to] = [0, 1].map(|frame| tracer.scene().walk.camera(frame, 60).unwrap());
    let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
    let known = cache.snapshot();
    let lookup = LookupSet::of_snapshot(&known, tracer.epoch());
    let reference = ReferenceFrame::trace_sparse(&tracer, &from, SIZE, &TRACE, &lookup, NEVER).unwrap();
    cache.insert(Arc::new(reference));
    let mut renderer = Renderer::default();
    [Mode::Full, Mode::Fast, Mode::Exact]
        .map(|mode| {
            let settings = RenderSettings { mode, trace: TRACE };
            let request = FrameRequest::new(&tracer, &to, SIZE, &settings);
            renderer.render(&request.reusing(&cache)).radiance.clone()
        })
        .into()
}

#[test]
fn a_scene_with_all_features_forced_on_has_the_same_pictures_bit_for_bit() {
    let mut left_out = 0;
    for name in builtin::NAMES {
        let scene = builtin::build(name).unwrap();
        left_out += scene.features.left_out().len();
        let forced = Scene { features: SceneFeatures::EVERYTHING, ..scene.clone() };
        let (lean, full) = (pictures(scene), pictures(forced));
        assert!(lean.iter().all(|p| p.iter().any(|r| *r != Vec3::ZERO)), "{name} is black");
        assert!(lean == full, "{name}");
    }
    assert!(left_out > 5, "no feature was skipped, so the test compared nothing");
}
