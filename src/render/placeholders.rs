//! What a frame that was stopped shows where it is not done.
//!
//! Where the surface is known, only the light is taken from around, so that textures and edges are sharp all the same; of
//! mirrors and glass what they show. Where nothing is known it is the colour.

use crate::raster::fill::{Levels, Surroundings, fill_unknown};
use crate::render::renderer::Renderer;
use crate::trace::NO_TRIANGLE;
use crate::trace::Tracer;
use glam::Vec3;
use rayon::prelude::*;

/// Scratch memory, kept from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Placeholders {
    /// What is known of some pixels; not a number elsewhere.
    known: Vec<Vec3>,
    is_known: Vec<bool>,
    found: Vec<Option<Vec3>>,
    levels: Levels,
}

impl Placeholders {
    /// An upper bound.
    pub(crate) const BYTES_PER_PIXEL: usize = 3 * size_of::<Vec3>() + size_of::<Option<Vec3>>() + 1;

    /// For each pixel of a list what the done ones around it have; `None` where it is done itself.
    fn find<'a>(
        &mut self,
        size: [u32; 2],
        list: &[u32],
        done: impl Iterator<Item = Option<Vec3>> + 'a,
    ) -> &[Option<Vec3>] {
        let [width, height] = size.map(|s| s as usize);
        self.known.clear();
        self.known.resize(width * height, Vec3::NAN);
        for (&pixel, value) in list.iter().zip(done) {
            self.known[pixel as usize] = value.unwrap_or(Vec3::NAN);
        }
        let known = |pixel: usize| Some(self.known[pixel]).filter(|v| !v.is_nan());
        let surroundings = Surroundings::gather([width, height], known, &mut self.levels);
        let around = |&pixel: &u32| {
            let pixel = pixel as usize;
            known(pixel).is_none().then(|| surroundings.around([pixel % width, pixel / width])).flatten()
        };
        list.par_iter().map(around).collect_into_vec(&mut self.found);
        &self.found
    }
}

impl Renderer {
    /// Gives the pixels that a stop left undone something to show.
    pub(crate) fn placeholder(&mut self, tracer: &Tracer) {
        if !self.knows_hits {
            self.forget_undone();
            self.stand_in_colour();
            return;
        }
        self.stand_in_specular();
        if self.traced.iter().any(Option::is_some) {
            self.stand_in_light(tracer);
        } else {
            self.stand_in_colour();
        }
    }

    /// Modes that do not look up know nothing of what is seen there.
    fn forget_undone(&mut self) {
        for (&pixel, _) in self.unseen.iter().zip(&self.traced).filter(|(_, traced)| traced.is_none()) {
            let pixel = pixel as usize;
            (self.frame.disparity[pixel], self.frame.triangle[pixel]) = (0.0, NO_TRIANGLE);
        }
    }

    fn stand_in_colour(&mut self) {
        let Placeholders { is_known, levels, .. } = &mut self.placeholders;
        is_known.clear();
        is_known.resize(self.frame.radiance.len(), true);
        let width = self.frame.view.size[0] as usize;
        for (&pixel, traced) in self.unseen.iter().zip(&self.traced) {
            is_known[pixel as usize] = traced.is_some();
        }
        if !self.knows_hits {
            for (&pixel, specular) in self.secondary.iter().zip(&self.specular) {
                is_known[pixel as usize] = specular.is_some();
            }
        }
        fill_unknown(&mut self.frame.radiance, is_known, width, levels);
    }

    /// Mirrors and glass show what those around them do.
    fn stand_in_specular(&mut self) {
        if self.specular.iter().all(Option::is_some) {
            return;
        }
        let found =
            self.placeholders.find(self.frame.view.size, &self.secondary, self.specular.iter().copied());
        for ((&pixel, found), own) in self.secondary.iter().zip(found).zip(&self.own) {
            if let Some(specular) = found {
                self.frame.radiance[pixel as usize] = *own + *specular;
            }
        }
    }

    /// Surfaces show their own texture in the light around them.
    fn stand_in_light(&mut self, tracer: &Tracer) {
        if self.traced.iter().all(Option::is_some) {
            return;
        }
        let light = self.traced.iter().map(|traced| traced.as_ref().map(|traced| traced.light));
        let found = self.placeholders.find(self.frame.view.size, &self.unseen, light);
        let frame = &mut self.frame;
        for (&pixel, light) in self.unseen.iter().zip(found) {
            let (at, ray) = (pixel as usize, Tracer::primary_ray(&frame.view, pixel));
            if let (Some(light), Some(hit)) = (light, tracer.hit_on_triangle(&ray, frame.triangle[at])) {
                let emission = tracer.scene().material_of(hit.triangle).emission;
                frame.radiance[at] = emission + tracer.albedo(&hit) * *light;
            }
        }
    }
}
