//! One light as a surface point sees it: where its sample points are and what each would bring.

use super::quad::{Points, Quad, sample_quad};
use crate::math::Ray;
use crate::math::sampling::{cosine_hemisphere, frame_around, lattice, uniform_cone};
use crate::scene::{Light, Scene, point_on_mesh};
use crate::trace::bvh::{BUNDLE_RAYS, MIN_RAYS, RayBundle};
use crate::trace::surface::SurfacePoint;
use glam::Vec3;
use std::f32::consts::PI;

/// A shadow ray and the irradiance it brings where nothing is in the way.
pub(crate) struct LightSample {
    pub(crate) shadow_ray: Ray,
    pub(crate) irradiance: Vec3,
    /// True where the light is so near that its irradiance was bounded.
    pub(crate) is_clamped: bool,
}

/// Samples a light needs: a point is seen or not, everything else has an extent.
pub(crate) fn sample_count(light: &Light, samples: u32) -> u32 {
    if matches!(light, Light::Point { .. }) { 1 } else { samples }
}

/// True where the light lies wholly behind the surface, so that it need not be sampled.
pub(crate) fn is_behind(light: &Light, point: &SurfacePoint) -> bool {
    let n = point.geometric_normal;
    let above = |p: Vec3| n.dot(p - point.position) > 0.0;
    match light {
        Light::Quad { corner, edge_u, edge_v, .. } => {
            let far = *corner + *edge_u + *edge_v;
            ![*corner, *corner + *edge_u, *corner + *edge_v, far].into_iter().any(above)
        }
        Light::Triangles { corners, .. } => !corners.iter().flatten().any(|&p| above(p)),
        Light::Point { position, .. } => !above(*position),
        // The disk's rim may still be above a horizon its centre is below.
        Light::Sun { direction, cos_angular_radius, .. } => {
            let sin = (1.0 - cos_angular_radius * cos_angular_radius).max(0.0).sqrt();
            n.dot(*direction) <= -sin
        }
        Light::Sky => false,
    }
}

// Inlined into the loop over a light's samples, so that what is the same for all of them is computed once: a fifth of
// the time of a frame.
/// The sample of a light that belongs to the point `u` of the unit square; `None` where it brings nothing.
#[inline(always)]
pub(crate) fn sample(
    scene: &Scene,
    light: &Light,
    point: &SurfacePoint,
    origin: Vec3,
    u: [f32; 2],
) -> Option<LightSample> {
    match light {
        Light::Quad { corner, edge_u, edge_v, radiance } => {
            let on_light = *corner + *edge_u * u[0] + *edge_v * u[1];
            area_sample(point, origin, on_light, edge_u.cross(*edge_v), *radiance)
        }
        Light::Triangles { corners, cumulative_area, area, radiance } => {
            let (on_light, chosen) = point_on_mesh(corners, cumulative_area, u);
            let [a, b, c] = corners[chosen];
            let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
            area_sample(point, origin, on_light, normal * *area, *radiance)
        }
        Light::Point { position, intensity } => {
            let d = *position - point.position;
            let cos = cosine(point, d)?;
            // Nearer than a millionth of the scene's diagonal a point would outshine every number there is.
            const NEAREST: f32 = 1.0 / 1024.0 / 1024.0;
            let distance2 = d.length_squared();
            Some(LightSample {
                shadow_ray: Ray { t_max: 1.0, ..Ray::new(origin, *position - origin) },
                irradiance: *intensity * (cos / distance2.max(NEAREST)),
                is_clamped: distance2 < NEAREST,
            })
        }
        Light::Sun { direction, cos_angular_radius, irradiance } => {
            let d = frame_around(*direction) * uniform_cone(u, *cos_angular_radius);
            let cos = cosine(point, d)?;
            let irradiance = *irradiance * cos;
            Some(LightSample { shadow_ray: Ray::new(origin, d), irradiance, is_clamped: false })
        }
        Light::Sky => {
            let d = frame_around(point.shading_normal) * cosine_hemisphere(u);
            cosine(point, d)?;
            let radiance = scene.sky.as_ref().map_or(Vec3::ZERO, |s| s.radiance(d));
            let irradiance = radiance * PI;
            Some(LightSample { shadow_ray: Ray::new(origin, d), irradiance, is_clamped: false })
        }
    }
}

/// A point nearer than a thousandth of the light's size would make the estimate unbounded. This is that distance, squared.
fn nearest2(area_normal: Vec3) -> f32 {
    const NEAREST: f32 = 1.0 / 1024.0 / 1024.0;
    (area_normal.length() * NEAREST).max(f32::MIN_POSITIVE)
}

/// Adds the shadow rays of some samples that bring light to an empty bundle, and writes what each brings where nothing is in the way. Returns how many of them
/// were bounded.
#[inline(always)]
pub(crate) fn add_samples(
    scene: &Scene,
    light: &Light,
    point: &SurfacePoint,
    points: Points,
    bundle: &mut RayBundle,
    unblocked: &mut [Vec3; BUNDLE_RAYS],
) -> u64 {
    if let Light::Quad { corner, edge_u, edge_v, radiance } = *light
        && points.range.len() >= MIN_RAYS
    {
        let quad = Quad { corner, edge_u, edge_v, nearest2: nearest2(edge_u.cross(edge_v)) };
        let mut factors = [0.0; BUNDLE_RAYS];
        if sample_quad(&quad, point, &points, bundle, &mut factors) {
            for (unblocked, factor) in unblocked.iter_mut().zip(factors) {
                *unblocked = radiance * factor;
            }
            return 0;
        }
    }
    let mut clamped = 0;
    for i in points.range {
        let u = lattice(i, points.count, points.shift);
        let Some(s) = sample(scene, light, point, bundle.origin(), u) else { continue };
        unblocked[bundle.len()] = s.irradiance;
        clamped += u64::from(s.is_clamped);
        bundle.push(s.shadow_ray.direction, s.shadow_ray.t_max);
    }
    clamped
}

/// A sample of an area light that stands for the area `|area_normal|`.
#[inline(always)]
fn area_sample(
    point: &SurfacePoint,
    origin: Vec3,
    on_light: Vec3,
    area_normal: Vec3,
    radiance: Vec3,
) -> Option<LightSample> {
    let d = on_light - point.position;
    if point.geometric_normal.dot(d) <= 0.0 {
        return None;
    }
    let along_normal = point.shading_normal.dot(d);
    if along_normal <= 0.0 {
        return None;
    }
    let (nearest2, distance2) = (nearest2(area_normal), d.length_squared());
    let is_clamped = distance2 < nearest2;
    let along_light = area_normal.dot(d).abs();
    let factor = if is_clamped {
        along_normal / distance2.sqrt() * (along_light / nearest2.sqrt()) / nearest2
    } else {
        // Both cosines have a length in them, so that two quotients by the square do and no root is needed.
        let inverse = 1.0 / distance2;
        (along_normal * inverse) * (along_light * inverse)
    };
    Some(LightSample {
        shadow_ray: Ray::segment(origin, on_light),
        irradiance: radiance * factor,
        is_clamped,
    })
}

/// Cosine at the surface, by the shading normal; `None` where either normal faces away.
fn cosine(point: &SurfacePoint, direction: Vec3) -> Option<f32> {
    if point.geometric_normal.dot(direction) <= 0.0 {
        return None;
    }
    let cos = point.shading_normal.dot(direction) / direction.length();
    (cos > 0.0).then_some(cos)
}
