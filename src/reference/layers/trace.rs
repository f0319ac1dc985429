//! Tracing the light of all groups at the lit pixels of a reference, with one set of rays.

use super::packed::{Layer, LightLayers, PackedTiles, bits_of};
use crate::cells::GroupCells;
use crate::math::sequence::PointSeed;
use crate::reference::{ReferenceFrame, SmoothFilter, SmoothSamples};
use crate::trace::parallel::{Stop, tile_order, trace_pixels};
use crate::trace::{GroupSettings, NO_TRIANGLE, RayCounts, TraceSettings, Tracer};
use glam::Vec3;

/// A scene at full light, ready to be traced by groups of lights.
#[derive(Debug)]
pub(crate) struct GroupTracer {
    tracer: Tracer,
    cells: GroupCells,
}

/// Light of a group at a pixel: direct light, and the sums of the two halves of its paths.
type PixelLight = (Vec3, [Vec3; 2]);

impl GroupTracer {
    /// Prepares to trace a scene by groups.
    pub(crate) fn new(tracer: &Tracer, settings: &TraceSettings) -> Self {
        let tracer = tracer.by_groups();
        let groups = tracer.scene().light_groups.list.len();
        Self { cells: GroupCells::new(groups, settings), tracer }
    }

    /// True where this is of a scene, given by its hash at full light.
    pub(crate) fn is_of(&self, scene: &str) -> bool {
        self.tracer.scene().hash == scene
    }

    /// True where this is of a scene, given by its hash at full light, and holds cells for these
    /// settings.
    pub(crate) fn is_for(&self, scene: &str, settings: &TraceSettings) -> bool {
        self.is_of(scene) && self.cells.are_for(settings)
    }

    /// Traces the light of all groups at the pixels of a reference that were lit, with its samples.
    /// Returns `None` after a stop.
    pub(crate) fn trace(&self, frame: &ReferenceFrame, stop: Stop<'_>) -> Option<LightLayers> {
        let size = frame.view.size;
        let pixels: Vec<u32> = tile_order(size).into_iter().filter(|&pixel| frame.was_lit(pixel)).collect();
        let mut traced = Vec::new();
        let (_, is_complete) =
            trace_pixels(&pixels, &mut traced, stop, |pixel, rays| self.light_of(frame, pixel, rays));
        if !is_complete {
            return None;
        }
        // Leave out pixels whose surface was not found again.
        let found = pixels.into_iter().zip(traced).filter_map(|(pixel, light)| Some((pixel, light??)));
        let (pixels, lights): (Vec<u32>, Vec<Vec<PixelLight>>) = found.unzip();
        let has_smooth = frame.settings.bounces > 0;
        let is_filtered = has_smooth && !pixels.is_empty();
        let filter = is_filtered.then(|| SmoothFilter::new(frame, &self.tracer, &pixels));
        let groups = 0..self.tracer.scene().light_groups.list.len();
        let layer = |group: usize| {
            let samples = |light: &Vec<PixelLight>| SmoothSamples {
                sums: light[group].1,
                count: frame.settings.samples.max(1),
            };
            let smooth = filter.as_ref().map_or(Vec::new(), |filter| {
                filter.light(&pixels, &lights.iter().map(samples).collect::<Vec<_>>())
            });
            Layer {
                direct: PackedTiles::new(size, &pixels, lights.iter().map(|light| light[group].0)),
                smooth: PackedTiles::new(size, &pixels, smooth.iter().copied()),
            }
        };
        Some(LightLayers {
            scene: self.tracer.scene().hash.clone(),
            size,
            lit: bits_of(size, pixels.iter().copied()),
            layers: groups.map(layer).collect(),
            has_smooth,
        })
    }

    /// The light of each group at a pixel of a reference; `None` where its surface is not found.
    fn light_of(&self, frame: &ReferenceFrame, pixel: u32, rays: &mut RayCounts) -> Option<Vec<PixelLight>> {
        let (tracer, view) = (&self.tracer, &frame.view);
        let groups = tracer.scene().light_groups.list.len();
        let triangle = frame.triangle()[pixel as usize];
        if triangle == NO_TRIANGLE {
            return Some(vec![PixelLight::default(); groups]);
        }
        let ray = Tracer::primary_ray(view, pixel);
        let hit = tracer.hit_on_triangle(&ray, triangle)?;
        let trace = TraceSettings { samples: frame.settings.samples.max(1), ..frame.settings };
        let settings = GroupSettings {
            trace,
            cache: Some(&self.cells),
            footprint: view.footprint(ray.direction, hit.t),
            finds_near: false,
        };
        let seed = PointSeed::of_growing_pixel(trace.seed, pixel, view.size[0]);
        let point = tracer.surface(&ray, &hit).as_stored();
        let light = tracer.light_by_group(&point, &settings, seed, rays);
        let is_finite = light.direct.iter().chain(light.smooth.iter().flatten()).all(|l| l.is_finite());
        is_finite.then(|| (0..groups).map(|group| (light.direct[group], light.smooth[group])).collect())
    }
}
