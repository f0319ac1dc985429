//! Samples of one light at a surface point: the points on the light, and the irradiance of each.

use super::quad::{Points, Quad, sample_quad};
use crate::math::Ray;
use crate::math::sampling::{cosine_hemisphere, frame_around, lattice, uniform_cone};
use crate::scene::{Light, Scene, point_on_mesh};
use crate::trace::bvh::{BUNDLE_RAYS, MIN_RAYS, RayBundle};
use crate::trace::surface::SurfacePoint;
use glam::Vec3;
use std::f32::consts::PI;

/// A shadow ray, and the irradiance that arrives along it where nothing is in the way.
pub(super) struct LightSample {
    pub(super) shadow_ray: Ray,
    pub(super) irradiance: Vec3,
    /// Irradiance over radiance of a lamp of even radiance; zero for other lights.
    pub(super) factor: f32,
    /// True where the light is so near that the irradiance was bounded.
    pub(super) is_clamped: bool,
}

/// Returns the number of samples for a light: one for a point, `samples` for a light with an
/// extent.
pub(super) fn sample_count(light: &Light, samples: u32) -> u32 {
    if matches!(light, Light::Point { .. }) { 1 } else { samples }
}

/// True where the light lies wholly behind the surface.
pub(super) fn is_behind(light: &Light, point: &SurfacePoint) -> bool {
    let n = point.geometric_normal;
    let above = |p: Vec3| n.dot(p - point.position) > 0.0;
    match light {
        Light::Quad { corner, edge_u, edge_v, .. } => {
            let far = *corner + *edge_u + *edge_v;
            ![*corner, *corner + *edge_u, *corner + *edge_v, far].into_iter().any(above)
        }
        Light::Triangles { corners, picture, .. } => {
            !Light::outline(corners, picture).iter().flatten().any(|&p| above(p))
        }
        Light::Point { position, .. } => !above(*position),
        // The rim of the disk may be above the horizon while its centre is below.
        Light::Sun { direction, cos_angular_radius, .. } => {
            let sin = (1.0 - cos_angular_radius * cos_angular_radius).max(0.0).sqrt();
            n.dot(*direction) <= -sin
        }
        Light::Sky | Light::SkySuns => false,
    }
}

/// Returns the sample of a light for the point `u` of the unit square; `None` where it brings no
/// light.
///
/// Inlined into the loop over the samples of a light, so that their common terms are computed once:
/// this saves a fifth of the time of a frame.
#[inline(always)]
pub(super) fn sample(
    scene: &Scene,
    light: &Light,
    point: &SurfacePoint,
    origin: Vec3,
    u: [f32; 2],
) -> Option<LightSample> {
    let distant = |d: Vec3, irradiance: Vec3| {
        Some(LightSample { shadow_ray: Ray::new(origin, d), irradiance, factor: 0.0, is_clamped: false })
    };
    match light {
        Light::Quad { corner, edge_u, edge_v, radiance, has_one_side } => {
            let on_light = *corner + *edge_u * u[0] + *edge_v * u[1];
            let side = (edge_u.cross(*edge_v), *has_one_side);
            area_sample(point, origin, on_light, side, *radiance)
        }
        Light::Triangles { corners, cumulative_area, area, radiance, picture, has_one_side } => {
            let (on_light, chosen, place) = point_on_mesh(corners, cumulative_area, u);
            let [a, b, c] = corners[chosen];
            let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
            let Some(picture) = picture else {
                return area_sample(point, origin, on_light, (normal * *area, *has_one_side), *radiance);
            };
            let (area, relative) = picture.sample((&scene.materials, &scene.textures), chosen, place);
            let side = (normal * area, *has_one_side);
            let sample = area_sample(point, origin, on_light, side, *radiance * relative)?;
            Some(LightSample { factor: 0.0, ..sample })
        }
        Light::Point { position, intensity, beam, profile } => {
            let d = *position - point.position;
            let cos = cosine(point, d)?;
            let mut intensity = match beam {
                None => *intensity,
                Some(beam) => *intensity * beam.share(-d),
            };
            if let Some(profile) = profile {
                intensity *= profile.share(-d);
            }
            if intensity == Vec3::ZERO {
                return None;
            }
            // Bound the irradiance nearer than 2^-10 scene units, a millionth of the scene's
            // diagonal.
            const NEAREST: f32 = 1.0 / 1024.0 / 1024.0;
            let distance2 = d.length_squared();
            Some(LightSample {
                shadow_ray: Ray { t_max: 1.0, ..Ray::new(origin, *position - origin) },
                irradiance: intensity * (cos / distance2.max(NEAREST)),
                factor: 0.0,
                is_clamped: distance2 < NEAREST,
            })
        }
        Light::Sun { direction, cos_angular_radius, irradiance } => {
            let d = frame_around(*direction) * uniform_cone(u, *cos_angular_radius);
            let cos = cosine(point, d)?;
            distant(d, *irradiance * cos)
        }
        Light::SkySuns => {
            let s = scene.sky.as_ref()?.sample_suns(u)?;
            let cos = cosine(point, s.direction)?;
            distant(s.direction, s.radiance * (cos / s.pdf))
        }
        Light::Sky => {
            let d = frame_around(point.shading_normal) * cosine_hemisphere(u);
            cosine(point, d)?;
            distant(d, scene.sky.as_ref().map_or(Vec3::ZERO, |s| s.diffuse_radiance(d)) * PI)
        }
    }
}

/// Returns the squared distance to an area light below which the irradiance of a sample is bounded:
/// a thousandth of the light's size. Without it the estimate is unbounded.
fn nearest2(area_normal: Vec3) -> f32 {
    const NEAREST: f32 = 1.0 / 1024.0 / 1024.0;
    (area_normal.length() * NEAREST).max(f32::MIN_POSITIVE)
}

/// Adds the shadow rays of samples that bring light to an empty bundle, and writes the unshadowed
/// irradiance of each. Leaves out those of lamps of even radiance whose irradiance is above `most`
/// times the radiance. Returns the number of samples whose irradiance was bounded.
#[inline(always)]
pub(super) fn add_samples(
    scene: &Scene,
    light: &Light,
    point: &SurfacePoint,
    points: Points,
    most: f32,
    bundle: &mut RayBundle,
    unblocked: &mut [Vec3; BUNDLE_RAYS],
) -> u64 {
    // Sample a parallelogram sixteen points at a time.
    if let Light::Quad { corner, edge_u, edge_v, radiance, has_one_side } = *light
        && points.range.len() >= MIN_RAYS
        && most == f32::INFINITY
    {
        let nearest2 = nearest2(edge_u.cross(edge_v));
        let quad = Quad { corner, edge_u, edge_v, nearest2, has_one_side };
        let mut factors = [0.0; BUNDLE_RAYS];
        if sample_quad(&quad, point, &points, bundle, &mut factors) {
            for (unblocked, factor) in unblocked.iter_mut().zip(factors) {
                *unblocked = radiance * factor;
            }
            return 0;
        }
    }
    // Sample other lights, and those that are too near, one point at a time.
    let mut clamped = 0;
    for i in points.range {
        let u = lattice(i, points.count, points.shift);
        let Some(s) = sample(scene, light, point, bundle.origin(), u) else { continue };
        if s.factor > most {
            continue;
        }
        unblocked[bundle.len()] = s.irradiance;
        clamped += u64::from(s.is_clamped);
        bundle.push(s.shadow_ray.direction, s.shadow_ray.t_max);
    }
    clamped
}

/// Returns a sample of an area light that represents the area `|area_normal|`, on the side to which
/// this points or on both.
#[inline(always)]
fn area_sample(
    point: &SurfacePoint,
    origin: Vec3,
    on_light: Vec3,
    (area_normal, has_one_side): (Vec3, bool),
    radiance: Vec3,
) -> Option<LightSample> {
    let d = on_light - point.position;
    if has_one_side && area_normal.dot(d) >= 0.0 {
        return None;
    }
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
        // Both cosines contain a length, so two quotients by the square need no root.
        let inverse = 1.0 / distance2;
        (along_normal * inverse) * (along_light * inverse)
    };
    Some(LightSample {
        shadow_ray: Ray::segment(origin, on_light),
        irradiance: radiance * factor,
        factor,
        is_clamped,
    })
}

/// Returns the cosine at the surface, by the shading normal; `None` where either normal faces away.
fn cosine(point: &SurfacePoint, direction: Vec3) -> Option<f32> {
    if point.geometric_normal.dot(direction) <= 0.0 {
        return None;
    }
    let cos = point.shading_normal.dot(direction) / direction.length();
    (cos > 0.0).then_some(cos)
}

/// Returns a random point of a light; `None` for lights at infinity, which are never culled.
pub(super) fn point_on(light: &Light, random: [f32; 2]) -> Option<Vec3> {
    let u = lattice(0, 1, random);
    match light {
        Light::Quad { corner, edge_u, edge_v, .. } => Some(*corner + *edge_u * u[0] + *edge_v * u[1]),
        Light::Triangles { corners, cumulative_area, .. } => {
            Some(point_on_mesh(corners, cumulative_area, u).0)
        }
        Light::Point { position, .. } => Some(*position),
        Light::Sun { .. } | Light::Sky | Light::SkySuns => None,
    }
}
