//! The light of references by groups of lights, so that groups are dimmed, switched and coloured
//! without a ray.
//!
//! It is traced for references of the cache, those that supply most of the view first, on another
//! thread than frames. Scenes of one group need none: their light is scaled.

use super::walkthrough::Walkthrough;
use crate::reference::{GroupTracer, LightLayers, ReferenceFrame, ReferenceId};
use crate::trace::parallel::Stop;
use std::sync::Arc;

/// A reference whose light is to be traced by groups.
#[derive(Clone, Debug)]
pub struct LayerJob {
    id: ReferenceId,
    frame: Arc<ReferenceFrame>,
    light: Arc<GroupTracer>,
}

/// The light of a reference by groups.
#[derive(Debug)]
pub struct TracedLayers {
    id: ReferenceId,
    layers: LightLayers,
}

impl LayerJob {
    /// Traces the light of all groups on the current thread pool. Returns `None` after a stop.
    pub fn trace(&self, stop: Stop<'_>) -> Option<TracedLayers> {
        Some(TracedLayers { id: self.id, layers: self.light.trace(&self.frame, stop)? })
    }
}

impl Walkthrough {
    /// The reference whose light is to be traced by groups next: of those whose light is not known
    /// by groups, the one that supplied most of the last frames. `None` where none is left, in
    /// modes that look no light up, and in scenes with one group of lights.
    pub fn layer_job(&mut self) -> Option<LayerJob> {
        let tracer = self.tracer().clone();
        let (scene, render) = (tracer.scene(), self.settings().render);
        if !render.mode.looks_up() || scene.light_groups.list.len() < 2 {
            return None;
        }
        let needs = self.cache.entries().iter().filter(|entry| {
            let is_lit = entry.frame.lit() + entry.frame.stale() > 0;
            entry.is_enabled && is_lit && !entry.frame.has_layers(scene.full_hash())
        });
        let next = needs.max_by(|a, b| a.contribution.total_cmp(&b.contribution))?;
        let (id, frame) = (next.id, next.frame.clone());
        let light = match &self.group_tracer {
            Some(light) if light.is_for(scene.full_hash(), &render.trace) => light.clone(),
            _ => Arc::new(GroupTracer::new(&tracer, &render.trace)),
        };
        self.group_tracer = Some(light.clone());
        Some(LayerJob { id, frame, light })
    }

    /// Adds the light of a reference by groups. Returns true where the next frame shows other
    /// light, because that of the reference did not hold.
    pub fn insert_layers(&mut self, traced: TracedLayers) -> bool {
        let tracer = self.tracer().clone();
        self.cache.set_layers(traced.id, Arc::new(traced.layers), &tracer)
    }
}

#[cfg(test)]
mod tests;
