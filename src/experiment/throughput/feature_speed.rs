//! The cost of features that a scene does not need: the same frames with every feature forced on.

use super::settings::{ThroughputSettings, moved};
use crate::experiment::statistics::median;
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::render::{FrameRequest, Mode, RenderSettings, Renderer};
use crate::scene::{Scene, SceneFeatures};
use crate::trace::parallel::{NEVER, Stop};
use crate::trace::{TraceSettings, Tracer};
use serde::Serialize;
use std::{sync::Arc, time::Instant};

/// Number of pairs of frames that are timed. More than for other figures, because the goal is a
/// difference of 1 %.
const PAIRS: usize = 15;

/// Additional time of a frame with every feature forced on, in percent of a frame with the features
/// that the scene needs: the median of pairs. With one sample per light, so that shading does not
/// hide the cost per pixel and ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FeatureSpeed {
    /// Additional time in mode `full`.
    pub forced_full_percent: f64,
    /// Additional time in mode `exact`, with a reference ahead of the view and the light of earlier
    /// frames known.
    pub forced_exact_percent: f64,
}

/// Times frames with and without forced features. `None` after a stop.
pub(crate) fn feature_speed(
    tracer: &Tracer,
    settings: &ThroughputSettings,
    stop: Stop<'_>,
) -> Option<FeatureSpeed> {
    let scene = tracer.scene();
    let forced = Scene { features: SceneFeatures::EVERYTHING, ..Scene::clone(scene) };
    let forced = tracer.with_same_geometry(Arc::new(forced));
    let [mut lean, mut forced] = [Frames::new(tracer, settings)?, Frames::new(&forced, settings)?];
    let mut over = |mode| {
        let pair = |i: usize| {
            let second = i % 2 == 1;
            let early = if second { forced.secs(mode) } else { lean.secs(mode) };
            let late = if second { lean.secs(mode) } else { forced.secs(mode) };
            if second { early / late } else { late / early }
        };
        let ratios: Vec<f64> = (0..=PAIRS).take_while(|_| !stop()).map(pair).collect();
        // The first pair warms up caches and buffers.
        Some((median(ratios.into_iter().skip(1))? - 1.0) * 100.0)
    };
    Some(FeatureSpeed { forced_full_percent: over(Mode::Full)?, forced_exact_percent: over(Mode::Exact)? })
}

/// Renders one view repeatedly.
struct Frames<'a> {
    tracer: &'a Tracer,
    cache: ReferenceCache,
    settings: ThroughputSettings,
    renderers: [Renderer; 2],
}

impl<'a> Frames<'a> {
    fn new(tracer: &'a Tracer, settings: &ThroughputSettings) -> Option<Self> {
        let trace = TraceSettings { samples: 1, ..settings.trace };
        let settings = ThroughputSettings { trace, ..*settings };
        let ahead = moved(tracer, &settings.camera);
        let reference = ReferenceFrame::trace(tracer, &ahead, settings.size, &trace, NEVER)?;
        let mut cache = ReferenceCache::new(tracer.scene(), usize::MAX);
        cache.insert(Arc::new(reference));
        Some(Self { tracer, cache, settings, renderers: Default::default() })
    }

    fn secs(&mut self, mode: Mode) -> f64 {
        let ThroughputSettings { camera, size, trace } = self.settings;
        let render = RenderSettings { mode, trace };
        let [plain, looking] = &mut self.renderers;
        let start = Instant::now();
        let renderer = if mode.looks_up() { looking } else { plain };
        renderer.render(&FrameRequest::new(self.tracer, &camera, size, &render).reusing(&self.cache));
        start.elapsed().as_secs_f64()
    }
}
