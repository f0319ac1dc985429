//! What a frame that was stopped shows where it is not done.
//!
//! Where the surface is known, only its light is interpolated from around it, so that textures and
//! edges stay sharp; for mirrors and glass, what they show is interpolated. Where the surface is
//! not known, the colour is.

use super::{frame::Frame, worklist::WorkList};
use crate::raster::fill::{Levels, Surroundings, fill_unknown};
use crate::trace::{NO_TRIANGLE, PixelTrace, Tracer};
use glam::Vec3;
use rayon::prelude::*;

/// Scratch memory, reused between frames.
#[derive(Debug, Default)]
pub(super) struct Placeholders {
    /// Values of the pixels that are known; NaN elsewhere.
    known: Vec<Vec3>,
    is_known: Vec<bool>,
    found: Vec<Option<Vec3>>,
    levels: Levels,
}

/// A stopped frame's lists of work.
#[derive(Clone, Copy)]
pub(super) struct Unfinished<'a> {
    pub(super) tracer: &'a Tracer,
    pub(super) unseen: &'a WorkList<PixelTrace>,
    pub(super) secondary: &'a WorkList<Vec3>,
    /// Radiance of the pixels of `secondary` without what their mirror or glass shows.
    pub(super) own: &'a [Vec3],
    /// True in modes that look up, which find the hits of all pixels first.
    pub(super) looks_up: bool,
}

impl Placeholders {
    /// Memory per pixel: an upper bound.
    pub(super) const BYTES_PER_PIXEL: usize = 3 * size_of::<Vec3>() + size_of::<Option<Vec3>>() + 1;

    /// Gives the pixels that a stop left undone something to show.
    pub(super) fn fill(&mut self, unfinished: &Unfinished<'_>, frame: &mut Frame) {
        let Unfinished { unseen, looks_up, .. } = *unfinished;
        if looks_up {
            self.fill_specular(unfinished, frame);
        } else {
            for pixel in unseen.missing() {
                (frame.disparity[pixel], frame.triangle[pixel]) = (0.0, NO_TRIANGLE);
            }
        }
        if looks_up && unseen.done().next().is_some() {
            self.fill_light(unfinished, frame);
        } else {
            self.fill_colour(unfinished, frame);
        }
    }

    fn fill_colour(&mut self, unfinished: &Unfinished<'_>, frame: &mut Frame) {
        let Self { is_known, levels, .. } = self;
        is_known.clear();
        is_known.resize(frame.radiance.len(), true);
        unfinished.unseen.missing().for_each(|pixel| is_known[pixel] = false);
        if !unfinished.looks_up {
            unfinished.secondary.missing().for_each(|pixel| is_known[pixel] = false);
        }
        fill_unknown(&mut frame.radiance, is_known, frame.view.size[0] as usize, levels);
    }

    /// Mirrors and glass show what those around them show.
    fn fill_specular(&mut self, unfinished: &Unfinished<'_>, frame: &mut Frame) {
        let Unfinished { secondary, own, .. } = *unfinished;
        let found = self.interpolate(frame.view.size, secondary, |specular| *specular);
        for ((&pixel, found), own) in secondary.pixels().iter().zip(found).zip(own) {
            if let Some(specular) = found {
                frame.radiance[pixel as usize] = *own + *specular;
            }
        }
    }

    /// Surfaces show their own texture in the light around them.
    fn fill_light(&mut self, unfinished: &Unfinished<'_>, frame: &mut Frame) {
        let Unfinished { tracer, unseen, .. } = *unfinished;
        let found = self.interpolate(frame.view.size, unseen, |traced| traced.light.total());
        for (&pixel, light) in unseen.pixels().iter().zip(found) {
            let (at, ray) = (pixel as usize, Tracer::primary_ray(&frame.view, pixel));
            if let (Some(light), Some(hit)) = (light, tracer.hit_on_triangle(&ray, frame.triangle[at])) {
                let emission = tracer.scene().material_of(hit.triangle).emission;
                frame.radiance[at] = emission + tracer.albedo(&hit) * *light;
            }
        }
    }

    /// For each pixel of a list, a value interpolated from the done pixels around it; `None` where
    /// it is done itself, and for all pixels where the list is complete.
    fn interpolate<R: Send>(
        &mut self,
        size: [u32; 2],
        list: &WorkList<R>,
        value: impl Fn(&R) -> Vec3,
    ) -> &[Option<Vec3>] {
        self.found.clear();
        if list.missing().next().is_none() {
            return &self.found;
        }
        let [width, height] = size.map(|s| s as usize);
        self.known.clear();
        self.known.resize(width * height, Vec3::NAN);
        list.done().for_each(|(pixel, result)| self.known[pixel] = value(result));
        let known = |pixel: usize| Some(self.known[pixel]).filter(|v| !v.is_nan());
        let surroundings = Surroundings::gather([width, height], known, &mut self.levels);
        let around = |&pixel: &u32| {
            let pixel = pixel as usize;
            known(pixel).is_none().then(|| surroundings.around([pixel % width, pixel / width])).flatten()
        };
        list.pixels().par_iter().map(around).collect_into_vec(&mut self.found);
        &self.found
    }
}
