//! The rays that are timed, gathered beforehand.

use super::settings::ThroughputSettings;
use crate::camera::View;
use crate::math::sampling::{cosine_hemisphere, frame_around};
use crate::math::{Ray, key::Key};
use crate::trace::{RayBundle, SurfacePoint, TraceSettings, Tracer, parallel::tile_order};
use rayon::prelude::*;

/// Maximum number of shadow rays. More would take memory without a change in the rates.
const MAX_RAYS: usize = 8_000_000;

/// Rays in scene space that were timed.
#[derive(Clone, Debug, Default)]
pub struct RayDump {
    /// Rays traced for the nearest hit: primary, then diffuse.
    pub closest: Vec<Ray>,
    /// Rays traced for any hit: shadow.
    pub any: Vec<Ray>,
}

/// Returns the rays that [`super::measure_throughput`] times, without timing them.
pub fn gather_rays(tracer: &Tracer, settings: &ThroughputSettings) -> RayDump {
    let (primary, points) = first_hits(tracer, settings);
    let diffuse = diffuse_rays(&points, settings.trace.seed);
    let bundles = shadow_bundles(tracer, &points, &settings.trace);
    RayDump { closest: primary.into_iter().chain(diffuse).collect(), any: rays_of(&bundles) }
}

/// Returns primary rays in tile order, and the surface points that they hit.
pub(super) fn first_hits(
    tracer: &Tracer,
    settings: &ThroughputSettings,
) -> (Vec<Ray>, Vec<(u32, SurfacePoint)>) {
    let view = View::new(&settings.camera, &tracer.scene().frame, settings.size);
    let order = tile_order(settings.size);
    let primary: Vec<Ray> = order.iter().map(|&p| Tracer::primary_ray(&view, p)).collect();
    let points = first_points(tracer, &order, &primary);
    (primary, points)
}

impl RayDump {
    /// Returns the triangles and rays in a binary format for other programs, little-endian:
    /// `RAYS0001`, the number of triangles as u64, their corners as f32; then twice (nearest hit,
    /// any hit) the number of rays as u64 and eight f32 per ray: origin, minimum t, direction,
    /// maximum t.
    pub fn to_bytes(&self, tracer: &Tracer) -> Vec<u8> {
        let scene = tracer.scene();
        let count = scene.triangles.len();
        let mut bytes = b"RAYS0001".to_vec();
        bytes.reserve(24 + count * 36 + (self.closest.len() + self.any.len()) * 32);
        bytes.extend_from_slice(&(count as u64).to_le_bytes());
        let corners = (0..count as u32).flat_map(|t| scene.corners(t)).flat_map(|c| c.to_array());
        bytes.extend(corners.flat_map(f32::to_le_bytes));
        for rays in [&self.closest, &self.any] {
            bytes.extend_from_slice(&(rays.len() as u64).to_le_bytes());
            for ray in rays {
                let (o, d) = (ray.origin, ray.direction);
                bytes.extend(
                    [o.x, o.y, o.z, 0.0, d.x, d.y, d.z, ray.t_max].into_iter().flat_map(f32::to_le_bytes),
                );
            }
        }
        bytes
    }
}

/// Returns the surface points that primary rays hit, with their pixels.
fn first_points(tracer: &Tracer, order: &[u32], primary: &[Ray]) -> Vec<(u32, SurfacePoint)> {
    let point =
        |(&pixel, ray): (&u32, &Ray)| tracer.closest(ray).map(|hit| (pixel, tracer.surface(ray, &hit)));
    order.par_iter().zip(primary).filter_map(point).collect()
}

pub(super) fn diffuse_rays(points: &[(u32, SurfacePoint)], seed: u64) -> Vec<Ray> {
    let ray = |(pixel, point): &(u32, SurfacePoint)| {
        let direction = cosine_hemisphere(Key::of_pixel(seed, *pixel).with(u32::MAX).pair());
        Ray::new(point.origin_in_front(), frame_around(point.geometric_normal) * direction)
    };
    points.iter().map(ray).collect()
}

/// Returns the shadow rays that shading the points traces; if they exceed [`MAX_RAYS`], those of
/// evenly spread points.
pub(super) fn shadow_bundles(
    tracer: &Tracer,
    points: &[(u32, SurfacePoint)],
    trace: &TraceSettings,
) -> Vec<RayBundle> {
    let of_every = |step: usize| {
        let mut bundles = Vec::new();
        for (pixel, point) in points.iter().step_by(step) {
            tracer.shadow_bundles(point, trace.samples, Key::of_pixel(trace.seed, *pixel), &mut bundles);
        }
        bundles
    };
    /// Every n-th point is probed to estimate the number of rays.
    const PROBE_STEP: usize = 997;
    let rays: usize = of_every(PROBE_STEP).iter().map(RayBundle::len).sum();
    of_every((rays * PROBE_STEP).div_ceil(MAX_RAYS).max(1))
}

pub(super) fn rays_of(bundles: &[RayBundle]) -> Vec<Ray> {
    bundles.iter().flat_map(RayBundle::rays).collect()
}
