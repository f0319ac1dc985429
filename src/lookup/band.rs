//! Fills a band of eight rows of a frame: every pixel shows the surface that its primary ray meets,
//! in light looked up in the references.
//!
//! The hits of the whole picture are found together, which costs a small part of a ray for each, so
//! nothing about visibility is guessed; the references save the shading. Where the look-up is a
//! guess, mode `exact` traces a few rays to check it, and mode `fast` shows it as it is.

use super::point_cache::Probe;
use super::policy::{HYSTERESIS, OTHER_SIDE, is_bad_guess};
use super::{
    LookupQuality, LookupSet, PointCache, SurfaceKey, TileLight, TileSurfaces, ViewLookup, pixels_of_tile,
};
use crate::camera::View;
use crate::math::Ray;
use crate::raster::pixel_types::{NO_SUPPLIER, PixelType};
use crate::trace::{NO_TRIANGLE, TILE_RAYS, TILE_SIDE, TraceSettings, Tracer, VisibilityBuffer};
use arrayvec::ArrayVec;
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
    /// Pixels whose guess is settled by light that an earlier frame traced, and that light, as the
    /// radiance of a white surface.
    pub(crate) settled: Vec<(u32, Vec3)>,
}

/// What is kept of the light of a band besides its colours.
#[derive(Debug)]
pub(crate) struct BandLight<'a> {
    /// Receives the emission and the reflected smooth light of pixels whose direct light is a
    /// guess.
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
        self.settled.clear();
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
            let cap = surfaces.cap(tracer, view, ray);
            rows.disparity[pixel - first] = cap.map_or(surfaces.points.disparity[ray], |cap| 1.0 / cap.t);
        }
    }
}

/// Light that earlier frames traced at single points, by which guesses are checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TracedPoints<'a> {
    pub(crate) points: &'a PointCache,
    /// How light is traced in this frame.
    pub(crate) trace: TraceSettings,
}

/// What traced points say about a guess.
struct Settled {
    /// The traced light, as the radiance of a white surface.
    traced: Vec3,
    /// True where it is shown instead of the guess.
    replaces_guess: bool,
}

/// Looks up the bands of one view.
#[derive(Debug)]
pub(crate) struct BandLookup<'a> {
    tracer: &'a Tracer,
    view: &'a View,
    visible: &'a VisibilityBuffer,
    lookup: ViewLookup<'a>,
    traced: TracedPoints<'a>,
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
        traced: TracedPoints<'a>,
    ) -> Self {
        let lookup = ViewLookup::new(set, view, quality.max_averaged);
        // A check finds direct light of the other side of an edge, and with it smooth light.
        let leaves_out_hidden = !quality.checks_guesses && set.holds_smooth();
        let checks_guesses = quality.checks_guesses;
        Self { tracer, view, visible, lookup, traced, checks_guesses, leaves_out_hidden }
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
            let tilted = surfaces.tilted & light.known;
            let guesses = if self.checks_guesses { light.guesses() & !tilted } else { 0 };
            let guesses = guesses & !self.settle_guesses(&surfaces, &mut light, guesses, &mut open.settled);
            for (ray, pixel) in pixels_of_tile([x0, y0], self.view.size) {
                // What is known is the light of another normal.
                let is_guess = (guesses | tilted) >> ray & 1 == 1;
                let kind = self.write_pixel(&surfaces, (&light, is_guess), ray, pixel - first, &mut rows);
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

    /// Settles guesses, one bit each, by light that earlier frames traced, and lists them with that
    /// light. Returns those that are settled; the others need rays.
    fn settle_guesses(
        &self,
        surfaces: &TileSurfaces,
        light: &mut TileLight,
        guesses: u64,
        settled: &mut Vec<(u32, Vec3)>,
    ) -> u64 {
        let [x0, y0] = surfaces.points.corner;
        let mut known = 0;
        let rays = (0..TILE_RAYS).filter(|ray| guesses >> ray & 1 == 1);
        // Where light may be held is looked up for all of them first.
        let probes: ArrayVec<_, TILE_RAYS> = rays.filter_map(|ray| self.probe(surfaces, ray)).collect();
        for (ray, key, probe) in &probes {
            let Some(found) = self.settle_guess(light, *ray, key, probe) else { continue };
            let (x, y) = (x0 + (ray % TILE_SIDE) as u32, y0 + (ray / TILE_SIDE) as u32);
            settled.push((y * self.view.size[0] + x, found.traced));
            known |= 1 << ray;
            if found.replaces_guess {
                light.set(*ray, found.traced, light.smooth_at(*ray));
                light.slot[*ray] = NO_SUPPLIER;
            }
        }
        known
    }

    /// The surface point of a pixel, and where its traced light may be held.
    fn probe(&self, surfaces: &TileSurfaces, ray: usize) -> Option<(usize, SurfaceKey, Probe)> {
        let key = self.lookup.key(&surfaces.points, ray);
        let key = SurfaceKey { footprint: key.footprint * surfaces.direction(ray).length(), ..key };
        Some((ray, key, self.traced.points.probe(&key.around())?))
    }

    /// Settles a guess by light that earlier frames traced, as `PixelResolver::check_guess` does,
    /// while the tile is at hand: light traced nearby may confirm it where no shadow's edge is
    /// near, light traced at the same point may replace it. `None` where rays are
    /// needed.
    fn settle_guess(
        &self,
        light: &TileLight,
        ray: usize,
        key: &SurfaceKey,
        probe: &Probe,
    ) -> Option<Settled> {
        let TracedPoints { points, trace } = self.traced;
        let (guess, smooth, samples) = (light.at(ray), light.smooth_at(ray), trace.samples_for(1.0));
        let is_bad = |traced: Vec3, most| is_bad_guess(guess + smooth, traced + smooth, most, trace.noise());
        let near = points.find_in(probe, &key.around(), samples)?;
        let most = if near.replaced_guess { 1.0 / HYSTERESIS } else { 1.0 };
        if !near.is_at_edge && !is_bad(near.light, most) {
            return Some(Settled { traced: near.light, replaces_guess: false });
        }
        let same = points.find(&key.exact(), samples)?;
        let most = if same.replaced_guess { 1.0 / HYSTERESIS } else { HYSTERESIS };
        let replaces_guess = is_bad(same.light, most);
        // Smooth light from the other side of an edge has to be traced again.
        let is_elsewhere = trace.bounces > 0 && same.light.max_element() < OTHER_SIDE * guess.max_element();
        (!replaces_guess || !is_elsewhere).then_some(Settled { traced: same.light, replaces_guess })
    }

    /// The emission and the reflected smooth light of a known pixel.
    fn certain_light(&self, surfaces: &TileSurfaces, light: &TileLight, ray: usize) -> Vec3 {
        let hit = surfaces.hit(ray);
        let albedo = self.tracer.albedo(&hit, surfaces.direction(ray));
        self.tracer.emission(&hit, surfaces.direction(ray)) + albedo * light.smooth_at(ray)
    }

    /// Writes what is known of a pixel. Returns its type, which says what is left to do.
    #[inline(always)]
    fn write_pixel(
        &self,
        surfaces: &TileSurfaces,
        (light, is_guess): (&TileLight, bool),
        ray: usize,
        at: usize,
        rows: &mut FrameRows<'_>,
    ) -> PixelType {
        let triangle = surfaces.hits.triangle[ray];
        (rows.triangle[at], rows.disparity[at], rows.supplier[at]) =
            (triangle, surfaces.points.disparity[ray], NO_SUPPLIER);
        let kind = if triangle == NO_TRIANGLE {
            let ray = Ray::new(self.view.eye, surfaces.direction(ray));
            (rows.radiance[at], rows.disparity[at]) = self.tracer.beyond_surfaces(&ray);
            PixelType::Reused
        } else {
            let material = &self.tracer.scene().materials[surfaces.material[ray].0 as usize];
            rows.radiance[at] = if material.has_dark_back() || self.tracer.shows_light() {
                self.tracer.emission(&surfaces.hit(ray), surfaces.direction(ray))
            } else {
                material.emission_at(&self.tracer.scene().textures, || self.tracer.uv(&surfaces.hit(ray)))
            };
            let is_wanted = surfaces.points.wanted >> ray & 1 == 1;
            let is_known = light.known >> ray & 1 == 1;
            if is_known {
                let albedo = self.tracer.albedo(&surfaces.hit(ray), surfaces.direction(ray));
                rows.radiance[at] += albedo * (light.at(ray) + light.smooth_at(ray));
                rows.supplier[at] = light.slot[ray];
            }
            if is_wanted && !is_known {
                PixelType::Unseen
            } else if is_guess {
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
