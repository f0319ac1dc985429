//! Fills a band of eight rows of a frame: every pixel shows the surface that its primary ray meets,
//! in light looked up in the references.
//!
//! The hits of the whole picture are found together, which costs a small part of a ray for each, so
//! nothing about visibility is guessed; the references save the shading. Where the look-up is a
//! guess, mode `exact` traces a few rays to check it, and mode `fast` shows it as it is.

use super::{LookupQuality, LookupSet, TileLight, TileSurfaces, ViewLookup, pixels_of_tile};
use crate::camera::View;
use crate::raster::pixel_types::{NO_SUPPLIER, PixelType};
use crate::trace::{NO_TRIANGLE, TILE_SIDE, Tracer, VisibilityBuffer};
use glam::Vec3;

/// Some rows of a frame, to be written. Row-major.
#[derive(Debug)]
pub(crate) struct FrameRows<'a> {
    pub(crate) radiance: &'a mut [Vec3],
    pub(crate) disparity: &'a mut [f32],
    pub(crate) triangle: &'a mut [u32],
    pub(crate) types: &'a mut [PixelType],
    pub(crate) supplier: &'a mut [u8],
}

/// Pixels that still have to be traced, by type.
#[derive(Debug, Default)]
pub(crate) struct OpenPixels {
    pub(crate) secondary: Vec<u32>,
    pub(crate) unseen: Vec<u32>,
    pub(crate) uncertain: Vec<u32>,
}

/// What is kept of the light of a band besides its colours.
#[derive(Debug)]
pub(crate) struct BandLight<'a> {
    /// Receives the emission and the reflected smooth light of pixels whose direct light is a guess.
    pub(crate) certain: &'a mut [Vec3],
    /// Receives the light of each pixel that is known, as the radiance of a white surface; empty
    /// where that is not wanted.
    pub(crate) known: &'a mut [Vec3],
}

impl OpenPixels {
    pub(crate) fn clear(&mut self) {
        for list in [&mut self.secondary, &mut self.unseen, &mut self.uncertain] {
            list.clear();
        }
    }

    pub(crate) fn push(&mut self, kind: PixelType, pixel: u32) {
        match kind {
            PixelType::Secondary => self.secondary.push(pixel),
            PixelType::Unseen => self.unseen.push(pixel),
            PixelType::Uncertain => self.uncertain.push(pixel),
            PixelType::Reused => {}
        }
    }
}

/// Writes the surfaces of the band that begins at row `y0`, and nothing else.
pub(crate) fn write_surfaces(
    tracer: &Tracer,
    visible: &VisibilityBuffer,
    view: &View,
    y0: u32,
    rows: FrameRows<'_>,
) {
    let (mut surfaces, first) = (TileSurfaces::new(view), y0 as usize * view.size[0] as usize);
    for x0 in (0..view.size[0]).step_by(TILE_SIDE) {
        surfaces.settle(tracer, visible, view, [x0, y0]);
        for (ray, pixel) in pixels_of_tile([x0, y0], view.size) {
            rows.triangle[pixel - first] = surfaces.hits.triangle[ray];
            rows.disparity[pixel - first] = surfaces.points.disparity[ray];
        }
    }
}

/// Looks up the bands of one view.
#[derive(Debug)]
pub(crate) struct BandLookup<'a> {
    tracer: &'a Tracer,
    view: &'a View,
    visible: &'a VisibilityBuffer,
    lookup: ViewLookup<'a>,
    checks_guesses: bool,
    leaves_out_hidden: bool,
}

impl<'a> BandLookup<'a> {
    pub(crate) fn new(
        tracer: &'a Tracer,
        view: &'a View,
        visible: &'a VisibilityBuffer,
        set: &'a LookupSet<'a>,
        quality: LookupQuality,
    ) -> Self {
        let lookup = ViewLookup::new(set, view, quality.max_averaged);
        // A check finds direct light of the other side of an edge, and with it smooth light.
        let leaves_out_hidden = !quality.checks_guesses && set.holds_smooth();
        Self { tracer, view, visible, lookup, checks_guesses: quality.checks_guesses, leaves_out_hidden }
    }

    /// Fills the band that begins at row `y0`, and lists the pixels that it leaves open.
    pub(crate) fn fill(&self, y0: u32, mut rows: FrameRows<'_>, kept: BandLight<'_>, open: &mut OpenPixels) {
        open.clear();
        let first = y0 as usize * self.view.size[0] as usize;
        let (mut surfaces, mut light) = (TileSurfaces::new(self.view), TileLight::NONE);
        for x0 in (0..self.view.size[0]).step_by(TILE_SIDE) {
            surfaces.settle(self.tracer, self.visible, self.view, [x0, y0]);
            self.lookup.gather(&surfaces.points, &mut light);
            if self.leaves_out_hidden {
                self.lookup.leave_out_hidden(self.tracer, &surfaces.points, &mut light);
            }
            for (ray, pixel) in pixels_of_tile([x0, y0], self.view.size) {
                let kind = self.write_pixel(&surfaces, &light, ray, pixel - first, &mut rows);
                if kind == PixelType::Uncertain {
                    kept.certain[pixel - first] = self.certain_light(&surfaces, &light, ray);
                }
                if light.known >> ray & 1 == 1
                    && let Some(known) = kept.known.get_mut(pixel - first)
                {
                    *known = light.at(ray) + light.smooth_at(ray);
                }
                open.push(kind, pixel as u32);
            }
        }
    }

    /// The emission and the reflected smooth light of a known pixel.
    fn certain_light(&self, surfaces: &TileSurfaces, light: &TileLight, ray: usize) -> Vec3 {
        let material = &self.tracer.scene().materials[surfaces.material[ray].0 as usize];
        material.emission + self.tracer.albedo(&surfaces.hit(ray)) * light.smooth_at(ray)
    }

    /// Writes what is known of a pixel. Returns its type, which says what is left to do.
    #[inline(always)]
    fn write_pixel(
        &self,
        surfaces: &TileSurfaces,
        light: &TileLight,
        ray: usize,
        at: usize,
        rows: &mut FrameRows<'_>,
    ) -> PixelType {
        let triangle = surfaces.hits.triangle[ray];
        (rows.triangle[at], rows.disparity[at], rows.supplier[at]) =
            (triangle, surfaces.points.disparity[ray], NO_SUPPLIER);
        let kind = if triangle == NO_TRIANGLE {
            rows.radiance[at] = self.tracer.sky(surfaces.direction(ray));
            PixelType::Reused
        } else {
            let material = &self.tracer.scene().materials[surfaces.material[ray].0 as usize];
            rows.radiance[at] = material.emission;
            let is_wanted = surfaces.points.wanted >> ray & 1 == 1;
            let is_known = light.known >> ray & 1 == 1;
            if is_known {
                let albedo = self.tracer.albedo(&surfaces.hit(ray));
                rows.radiance[at] += albedo * (light.at(ray) + light.smooth_at(ray));
                rows.supplier[at] = light.slot[ray];
            }
            if is_wanted && !is_known {
                PixelType::Unseen
            } else if is_known && self.checks_guesses && light.is_guess(ray) {
                PixelType::Uncertain
            } else if material.is_view_dependent() {
                PixelType::Secondary
            } else {
                PixelType::Reused
            }
        };
        rows.types[at] = kind;
        kind
    }
}
