//! Sixteen samples of a parallelogram light at once, with the bits of `sample`.
//!
//! Most area lights are parallelograms. Sampling them one point at a time took a quarter of the
//! time of a picture once shadow rays were traced in bundles.

use crate::math::{Ray, simd};
use crate::trace::bvh::{BUNDLE_RAYS, RayBundle};
use crate::trace::surface::SurfacePoint;
use fearless_simd::{Simd, SimdBase, SimdMask, dispatch, f32x8, prelude::*, u32x8};
use glam::Vec3;
use std::ops::Range;

const LANES: usize = 8;

/// A parallelogram light, scene space.
#[derive(Clone, Copy)]
pub(super) struct Quad {
    pub(super) corner: Vec3,
    pub(super) edge_u: Vec3,
    pub(super) edge_v: Vec3,
    /// Squared distance below which the irradiance of a sample is bounded.
    pub(super) nearest2: f32,
    /// True where it emits only from the side to which `edge_u` cross `edge_v` points.
    pub(super) has_one_side: bool,
}

/// Some points of a lattice of `count` points in the unit square, moved by `shift`.
#[derive(Clone)]
pub(super) struct Points {
    pub(super) range: Range<u32>,
    pub(super) count: u32,
    pub(super) shift: [f32; 2],
}

/// Adds the shadow rays of samples that bring light to an empty bundle, and writes for each the
/// factor from the light's radiance to the unshadowed irradiance.
///
/// The points must fit into one bundle. Returns false, with nothing done, where a sample is so near
/// that its irradiance must be bounded.
pub(super) fn sample_quad(
    quad: &Quad,
    point: &SurfacePoint,
    points: &Points,
    bundle: &mut RayBundle,
    factors: &mut [f32; BUNDLE_RAYS],
) -> bool {
    dispatch!(simd::level(), simd => sample_with(simd, quad, point, points, bundle, factors))
}

/// [`sample_quad`] for one SIMD level.
#[inline(always)]
fn sample_with<S: Simd>(
    simd: S,
    quad: &Quad,
    point: &SurfacePoint,
    points: &Points,
    bundle: &mut RayBundle,
    factors: &mut [f32; BUNDLE_RAYS],
) -> bool {
    // Compute eight samples at a time.
    let mut samples = [Samples::new(simd); 2];
    for (half, samples) in samples.iter_mut().enumerate() {
        let first = points.range.start + (half * LANES) as u32;
        if first < points.range.end && !samples.fill(simd, quad, point, points, first) {
            return false;
        }
    }
    // Add the rays of those that bring light.
    for samples in &samples {
        let [x, y, z] = [0, 1, 2].map(|axis| samples.on_light[axis].to_array());
        let factor = samples.factor.to_array();
        for lane in (0..LANES).filter(|lane| samples.brings_light >> lane & 1 == 1) {
            factors[bundle.len()] = factor[lane];
            let segment = Ray::segment(bundle.origin(), Vec3::new(x[lane], y[lane], z[lane]));
            bundle.push(segment.direction, segment.t_max);
        }
    }
    true
}

/// Eight samples of a light.
#[derive(Clone, Copy)]
struct Samples<S: Simd> {
    /// Points on the light, scene space.
    on_light: [f32x8<S>; 3],
    /// Factors from radiance to unshadowed irradiance.
    factor: f32x8<S>,
    /// Bit per sample that brings light.
    brings_light: u32,
}

impl<S: Simd> Samples<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        Self { on_light: [zero; 3], factor: zero, brings_light: 0 }
    }

    /// Computes the samples from point `first` on. Returns false where one must be bounded.
    #[inline(always)]
    fn fill(&mut self, simd: S, quad: &Quad, point: &SurfacePoint, points: &Points, first: u32) -> bool {
        let [u, v] = lattice(simd, first, points.count, points.shift);
        let Quad { corner, edge_u, edge_v, nearest2, has_one_side } = *quad;
        self.on_light = [
            u * edge_u.x + corner.x + v * edge_v.x,
            u * edge_u.y + corner.y + v * edge_v.y,
            u * edge_u.z + corner.z + v * edge_v.z,
        ];
        // Drop samples behind the surface.
        let [x, y, z] = self.on_light;
        let d = [x - point.position.x, y - point.position.y, z - point.position.z];
        let zero = f32x8::splat(simd, 0.0);
        let along_normal = along(&d, point.shading_normal);
        let mut brings = along(&d, point.geometric_normal).simd_gt(zero) & along_normal.simd_gt(zero);
        let along_front = along(&d, edge_u.cross(edge_v));
        if has_one_side {
            brings &= along_front.simd_lt(zero);
        }
        let is_there = (1u32 << (points.range.end - first).min(LANES as u32)) - 1;
        self.brings_light = brings.to_bitmask() as u32 & is_there;
        // Give up where a sample is too near.
        let distance2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let is_bounded = distance2.simd_lt(f32x8::splat(simd, nearest2));
        if is_bounded.to_bitmask() as u32 & self.brings_light != 0 {
            return false;
        }
        // Both cosines contain a length, so two quotients by the square need no root.
        let inverse = f32x8::splat(simd, 1.0) / distance2;
        self.factor = (along_normal * inverse) * (along_front.abs() * inverse);
        true
    }
}

/// Dot products with one vector.
#[inline(always)]
fn along<S: Simd>(d: &[f32x8<S>; 3], v: Vec3) -> f32x8<S> {
    d[0] * v.x + d[1] * v.y + d[2] * v.z
}

/// Computes [`crate::math::sampling::lattice`] for eight consecutive indices.
#[inline(always)]
fn lattice<S: Simd>(simd: S, first: u32, count: u32, shift: [f32; 2]) -> [f32x8<S>; 2] {
    use crate::math::sampling::{BELOW_ONE, GOLDEN};
    let index = u32x8::splat(simd, first) + u32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, 7]);
    let along = (index.to_float::<f32x8<S>>() + shift[0]) / count as f32;
    let hashed = (index * u32x8::splat(simd, GOLDEN)) >> 8;
    let across = hashed.to_float::<f32x8<S>>() * (1.0 / 16_777_216.0) + shift[1];
    let one = f32x8::splat(simd, 1.0);
    let across = across.simd_ge(one).select(across - one, across);
    let most = f32x8::splat(simd, BELOW_ONE);
    [along.min(most), across.min(most)]
}

#[cfg(test)]
mod tests {
    use super::{super::sample::sample, *};
    use crate::camera::View;
    use crate::math::key::Key;
    use crate::scene::{Light, builtin};
    use crate::trace::Tracer;
    use std::sync::Arc;

    #[test]
    fn samples_are_those_of_single_points_to_the_bit() {
        let tracer = Tracer::new(Arc::new(builtin::build("gallery-bench").unwrap()));
        let scene = tracer.scene();
        let view = View::new(scene.start(), &scene.frame, [24, 14]);
        let [mut compared, mut left_out] = [0; 2];
        for (pixel, has_one_side) in (0..24 * 14).flat_map(|pixel| [(pixel, false), (pixel, true)]) {
            let ray = Tracer::primary_ray(&view, pixel);
            let Some(hit) = tracer.closest(&ray) else { continue };
            let point = tracer.surface(&ray, &hit);
            for light in &scene.lights {
                let Light::Quad { corner, edge_u, edge_v, radiance, .. } = *light else { continue };
                let light = &Light::Quad { corner, edge_u, edge_v, radiance, has_one_side };
                let quad = Quad { corner, edge_u, edge_v, nearest2: f32::MIN_POSITIVE, has_one_side };
                for (range, count) in [(0..16, 16), (16..27, 27), (0..3, 3)] {
                    let shift = Key::of_pixel(1, pixel).pair();
                    let points = Points { range: range.clone(), count, shift };
                    let mut bundle = RayBundle::new(point.origin_in_front());
                    let mut factors = [0.0; BUNDLE_RAYS];
                    assert!(sample_quad(&quad, &point, &points, &mut bundle, &mut factors));
                    let mut at = 0;
                    for i in range {
                        let u = crate::math::sampling::lattice(i, count, shift);
                        let Some(one) = sample(scene, light, &point, bundle.origin(), u) else {
                            left_out += 1;
                            continue;
                        };
                        assert_eq!(bundle.ray(at), one.shadow_ray);
                        assert_eq!(radiance * factors[at], one.irradiance);
                        at += 1;
                        compared += 1;
                    }
                    assert_eq!(at, bundle.len());
                }
            }
        }
        assert!(compared > 10_000 && left_out > 100, "{compared}, {left_out}");
    }
}
