//! What a walk measures on its finished frames: their error and their stability.

use super::audit::{Audited, Auditor};
use super::renderer::Renderer;
use super::settings::WalkthroughSettings;
use super::temporal_stability::TemporalStabilityMeter;
use crate::reference::ReferenceCache;
use crate::trace::Tracer;

/// The measurements that the settings of a walk ask for.
#[derive(Debug, Default)]
pub(super) struct FrameMeasures {
    /// `None` while audits are disabled.
    auditor: Option<Auditor>,
    /// `None` while stability is not measured.
    stability: Option<TemporalStabilityMeter>,
}

impl FrameMeasures {
    /// Measures a frame, where it is complete, and adds the results to its statistics.
    pub(super) fn measure(
        &mut self,
        settings: &WalkthroughSettings,
        tracer: &Tracer,
        cache: &mut ReferenceCache,
        renderer: &mut Renderer,
    ) {
        self.audit(settings, tracer, cache, renderer);
        if !settings.measures_stability {
            self.stability = None;
        } else if renderer.frame().stats.is_complete {
            let meter = self.stability.get_or_insert_default();
            let stability = meter.measure(tracer.scene(), renderer.frame());
            renderer.frame_mut().stats.temporal_stability = stability;
        }
    }

    fn audit(
        &mut self,
        settings: &WalkthroughSettings,
        tracer: &Tracer,
        cache: &mut ReferenceCache,
        renderer: &mut Renderer,
    ) {
        if !settings.audits || !settings.render.mode.looks_up() {
            self.auditor = None;
            return;
        }
        let auditor = self.auditor.get_or_insert_default();
        let frame = renderer.frame();
        if frame.stats.is_complete {
            let trace = &settings.render.trace;
            let (secs, estimate) = auditor.audit(&Audited { tracer, frame, trace }, cache);
            let stats = &mut renderer.frame_mut().stats;
            stats.audit = Some(estimate);
            stats.secs.audit = secs;
            stats.secs.frame += secs;
        }
    }
}
