//! Panoramas of the modes that look light up.

use super::patches::{Patch, bands, patches};
use super::picture::{Panorama, PanoramaBand};
use super::projection::Equirectangular;
use super::resample::PatchPicture;
use crate::camera::{Camera, View};
use crate::lookup::LookupSet;
use crate::reference::{ReferenceCache, ReferenceFrame, ReferenceId, settings_of_reference};
use crate::render::accumulate::offset_of_pass;
use crate::render::{renderer::Renderer, request::FrameRequest, settings::RenderSettings};
use crate::trace::parallel::Stop;
use crate::trace::{RayCounts, TraceSettings};
use glam::Vec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::Range;
use std::sync::Arc;

/// References are as dense as a panorama, but at most as one of this width, in pixels: smooth light
/// needs no more, and shadow edges between their pixels are traced where they are seen. Six of them
/// have 2.6 million pixels.
const MAX_REFERENCE_WIDTH: f64 = 2048.0;

/// Pixels of a reference beyond its face of the cube, on each side: light next to the edge is
/// interpolated.
const REFERENCE_MARGIN: f64 = 2.0;

/// A panorama whose light is known, so that its rows can be rendered.
#[derive(Debug)]
pub struct LitPanorama<'a> {
    panorama: Panorama<'a>,
    cache: ReferenceCache,
    renderer: Renderer,
    /// Rays that the references took.
    rays: RayCounts,
    /// Time that the references took, seconds.
    secs: f64,
}

impl<'a> LitPanorama<'a> {
    /// Lights the references of a panorama. `None` after a stop. `report` is called with the
    /// finished part, 0..1.
    pub fn light(panorama: Panorama<'a>, stop: Stop<'_>, report: &dyn Fn(f64)) -> Option<Self> {
        let (tracer, trace) = (panorama.tracer, &panorama.settings.trace);
        let mut cache = ReferenceCache::new(tracer.scene(), usize::MAX);
        cache.prepare_cells(tracer.scene(), trace);
        let (mut rays, mut secs) = (RayCounts::default(), 0.0);
        let faces = faces(panorama.camera, panorama.size[0]);
        let count = faces.len();
        for (number, (camera, size)) in (1..).zip(faces) {
            let settings = settings_of_reference(trace, number);
            // Where two faces overlap, the second finds the light of the first.
            let known = LookupSet::new(&cache, tracer.epoch());
            let reference = ReferenceFrame::trace_sparse(tracer, &camera, size, &settings, &known, stop)?;
            rays += reference.rays;
            secs += reference.secs;
            cache.insert(Arc::new(reference));
            report(number as f64 / count as f64);
        }
        Some(Self { panorama, cache, renderer: Renderer::default(), rays, secs })
    }

    /// Rays that the references took.
    pub fn reference_rays(&self) -> RayCounts {
        self.rays
    }

    /// Time that the references took, seconds.
    pub fn reference_secs(&self) -> f64 {
        self.secs
    }

    /// The rows of each band, from the top.
    pub fn bands(&self) -> Vec<Range<u32>> {
        bands(&self.panorama.projection())
    }

    /// Renders a band. Bands must be rendered in order for the same bits: light that one traces at
    /// single points is known to the next. Returns `None` after a stop. `report` is called with the
    /// number of pixels that are finished since its last call.
    pub fn render(&mut self, rows: Range<u32>, stop: Stop<'_>, report: &dyn Fn(u64)) -> Option<PanoramaBand> {
        let (width, projection) = (self.panorama.size[0] as usize, self.panorama.projection());
        let mut radiance = vec![Vec3::ZERO; rows.len() * width];
        let mut rays = RayCounts::default();
        for patch in patches(&projection, self.panorama.camera.eye, &rows) {
            let picture = self.picture(&patch, stop, &mut rays)?;
            let view = View::new(&patch.camera, &self.panorama.tracer.scene().frame, patch.size);
            let shown = PatchPicture::new(&view, &picture);
            fill(&mut radiance, (&projection, &rows), &patch.columns, &shown);
            report(rows.len() as u64 * patch.columns.len() as u64);
        }
        Some(PanoramaBand { rows, radiance, rays })
    }

    /// The mean of looked-up pictures of a patch through different points of its pixels. They share
    /// the samples of the settings, and each has a seed of its own. `None` after a stop.
    fn picture(&mut self, patch: &Patch, stop: Stop<'_>, rays: &mut RayCounts) -> Option<Vec<Vec3>> {
        let count = self.panorama.points.max(1);
        let (mut sums, mut own): (Vec<Vec3>, _) = (Vec::new(), None);
        for number in 0..count {
            let settings = self.settings_of(number);
            let request = FrameRequest::new(self.panorama.tracer, &patch.camera, patch.size, &settings);
            let request = request.shifted(offset_of_pass(number, count)).with_stop(stop);
            let frame = self.renderer.render(&request.reusing(&self.cache));
            if !frame.stats.is_complete {
                return None;
            }
            *rays += frame.stats.rays;
            if number == 0 && frame.stats.types.unseen > 0 {
                own = Some(self.share_light(&settings));
            }
            sums.resize(patch.size.map(|side| side as usize).iter().product(), Vec3::ZERO);
            let shown = &self.renderer.frame().radiance;
            sums.par_iter_mut().zip(shown).for_each(|(sum, radiance)| *sum += *radiance);
        }
        if let Some(own) = own {
            self.cache.remove(own);
        }
        sums.par_iter_mut().for_each(|sum| *sum /= count as f32);
        Some(sums)
    }

    /// The settings of a patch's picture by its number. The first has all samples: where it shades
    /// surfaces that no reference knows, the others look their light up.
    fn settings_of(&self, number: u32) -> RenderSettings {
        let Panorama { settings: RenderSettings { mode, trace }, points, .. } = self.panorama;
        let seed = trace.seed.wrapping_add(u64::from(number) << 48);
        let samples = if number == 0 { trace.samples } else { trace.samples.div_ceil(points.max(1)) };
        RenderSettings { mode: *mode, trace: TraceSettings { samples, seed, ..*trace } }
    }

    /// Makes a reference of the surfaces that the last picture shaded itself, and shows them with
    /// the light that neighbours share.
    fn share_light(&mut self, settings: &RenderSettings) -> ReferenceId {
        let tracer = self.panorama.tracer;
        let own = self.renderer.shaded_reference(tracer, settings);
        self.renderer.show_shared_light(tracer, &own);
        self.cache.insert(Arc::new(own))
    }
}

/// The references of a panorama: camera and size of each face of a cube, with a margin.
fn faces(camera: &Camera, width: u32) -> Vec<(Camera, [u32; 2])> {
    let edge = (f64::from(width).min(MAX_REFERENCE_WIDTH) / PI).max(8.0).ceil();
    let side = edge + 2.0 * REFERENCE_MARGIN;
    let fov_y = 2.0 * (side / edge).atan();
    let face = |quarter: f64, pitch: f64| {
        let yaw = camera.yaw + quarter * FRAC_PI_2;
        (Camera { yaw, pitch, fov_y, roll: 0.0, ..*camera }, [side as u32; 2])
    };
    let around = (0..4).map(|quarter| face(f64::from(quarter), 0.0));
    around.chain([face(0.0, FRAC_PI_2), face(0.0, -FRAC_PI_2)]).collect()
}

/// Writes the part of a band that a patch shows.
fn fill(
    radiance: &mut [Vec3],
    (projection, rows): (&Equirectangular, &Range<u32>),
    columns: &Range<u32>,
    shown: &PatchPicture<'_>,
) {
    let width = projection.size()[0] as usize;
    radiance.par_chunks_mut(width).zip(rows.clone().into_par_iter()).for_each(|(row, y)| {
        for x in columns.clone() {
            let point = [x, y].map(|at| f64::from(at) + 0.5);
            row[x as usize] = shown.at(projection.direction(point));
        }
    });
}
