//! References in scenes whose groups of lights are dimmed, switched and coloured.

use super::ReferenceFrame;
use super::traced_light::TracedLight;
use crate::reference::layers::{LightLayers, LightWords};
use crate::reference::light::UNLIT;
use crate::reference::stale::Mark;
use crate::scene::Scene;
use crate::trace::Tracer;
use glam::Vec3;
use std::sync::Arc;

impl ReferenceFrame {
    /// True where the light is known by groups for a scene, given by its hash at full light.
    pub(crate) fn has_layers(&self, scene: &str) -> bool {
        self.layers.as_ref().is_some_and(|layers| layers.are_of(scene))
    }

    /// Adds the light by groups, and shows that of the tracer's scene. Light that was traced in the
    /// same scene, and still holds, keeps its bits. Returns true where other light is shown than
    /// before.
    pub(crate) fn set_layers(&mut self, layers: Arc<LightLayers>, tracer: &Tracer) -> bool {
        let scene = tracer.scene();
        if !layers.are_of(scene.full_hash()) {
            return false;
        }
        let is_shown = self.epoch == tracer.epoch() && self.stale.is_none();
        self.layers = Some(layers);
        match self.knows_lights(scene) {
            true if is_shown => return false,
            true => self.set_lights(tracer),
            false => {
                (self.stale, self.traced, self.lost) = (None, None, Vec::new());
                self.show_sum(tracer);
            }
        }
        true
    }

    /// True where the light of a state of the scene follows from what is known, without a ray: it
    /// was traced in that state, or is known by groups, or all groups change by the same factor.
    pub(crate) fn knows_lights(&self, scene: &Scene) -> bool {
        self.lost.is_empty()
            && self.origin.full_hash() == scene.full_hash()
            && (self.traced_in().hash == scene.hash
                || self.has_layers(scene.full_hash())
                || self.common_ratio(scene).is_some())
    }

    /// Shows the light of the tracer's scene, where [`Self::knows_lights`].
    pub(crate) fn set_lights(&mut self, tracer: &Tracer) {
        let scene = tracer.scene();
        if self.stale.is_some() {
            self.mark(tracer.epoch(), vec![Mark::Holds; self.view.pixel_count()]);
        }
        self.epoch = tracer.epoch();
        if self.traced_in().hash == scene.hash {
            if let Some(traced) = self.traced.take() {
                self.swap_words(traced.words);
                self.origin = traced.origin;
            }
            return;
        }
        let words = match self.common_ratio(scene) {
            Some(ratio) if !self.has_layers(scene.full_hash()) => match &self.traced {
                Some(traced) => traced.words.scaled(ratio),
                None => self.words().scaled(ratio),
            },
            _ => self.sum(scene),
        };
        let (before, origin) = (self.swap_words(words), std::mem::replace(&mut self.origin, scene.clone()));
        self.traced.get_or_insert_with(|| Box::new(TracedLight { words: before, origin }));
    }

    /// State of the scene that the light was traced in.
    fn traced_in(&self) -> &Arc<Scene> {
        self.traced.as_ref().map_or(&self.origin, |traced| &traced.origin)
    }

    /// The factor per channel by which the light differs from that which was traced, where it is
    /// the same for all groups.
    fn common_ratio(&self, scene: &Scene) -> Option<Vec3> {
        let ratio = |(before, now): (Vec3, Vec3)| (before.min_element() > 0.0).then(|| now / before);
        let mut ratios = self.traced_in().light_factors().into_iter().zip(scene.light_factors()).map(ratio);
        let first = ratios.next()??;
        ratios.all(|ratio| ratio == Some(first)).then_some(first)
    }

    /// Shows the sum of the layers, and forgets all other light.
    fn show_sum(&mut self, tracer: &Tracer) {
        let sum = self.sum(tracer.scene());
        self.swap_words(sum);
        (self.origin, self.epoch) = (tracer.scene().clone(), tracer.epoch());
    }

    fn sum(&self, scene: &Scene) -> LightWords {
        match &self.layers {
            Some(layers) => layers.sum(&scene.light_factors()),
            None => self.words(),
        }
    }

    fn words(&self) -> LightWords {
        LightWords {
            light: self.light.clone(),
            light_scale: self.light_scale,
            smooth: self.smooth.clone(),
            smooth_scale: self.smooth_scale,
        }
    }

    /// Replaces the light of all pixels and returns that of before.
    fn swap_words(&mut self, words: LightWords) -> LightWords {
        self.lit = words.light.iter().filter(|&&word| word != UNLIT).count();
        LightWords {
            light: std::mem::replace(&mut self.light, words.light),
            light_scale: std::mem::replace(&mut self.light_scale, words.light_scale),
            smooth: std::mem::replace(&mut self.smooth, words.smooth),
            smooth_scale: std::mem::replace(&mut self.smooth_scale, words.smooth_scale),
        }
    }

    /// Forgets the light by groups, and that of other settings of the lights.
    pub(super) fn forget_layers(&mut self) {
        (self.layers, self.traced) = (None, None);
    }

    /// Memory of the light by groups, bytes.
    pub(super) fn layer_bytes(&self) -> usize {
        let layers = self.layers.as_ref().map_or(0, |layers| layers.bytes());
        layers + self.traced.as_ref().map_or(0, |traced| traced.words.bytes())
    }
}
