//! Light that reaches a rough lobe straight from the lights, and how its parts are shared out.
//!
//! A lamp is found both by points on it and by rays of the lobe. Each way counts in proportion to
//! its density there (the balance heuristic of Veach and Guibas, "Optimally Combining Sampling
//! Techniques for Monte Carlo Rendering", SIGGRAPH 1995), so points bring highlights of rough lobes
//! and rays those of smooth ones. Suns and point lights are found by points alone, the sky by rays
//! alone.
//!
//! Of all points on all lights, a few get a shadow ray, in proportion to the light that they would
//! bring (Talbot, Cline and Egbert, "Importance Resampling for Global Illumination", EGSR 2005): a
//! highlight costs the same with one lamp and with many. We differ: one random number places all of
//! them at equal distances along the sum of that light, so where nothing is hidden nothing is left
//! to chance.

use super::quad::Points;
use super::sample::{add_samples, is_behind, sample_count};
use super::share::{LightTurn, SHARING};
use crate::bsdf::{Facing, Lobe};
use crate::math::Ray;
use crate::scene::{Light, Material};
use crate::trace::{BUNDLE_RAYS, RayBundle, RayCounts, SurfacePoint, Tracer};
use glam::Vec3;

/// Dimension of the random number that chooses shadow rays, in addition to those of the lights.
const CHOICE: u32 = SHARING - 1;

/// Number of candidates for each sample, where lamps are chosen.
const CANDIDATES: u32 = 32;

/// A rough lobe at a point, seen along a unit direction.
#[derive(Clone, Copy)]
pub(in crate::trace) struct LitLobe<'a> {
    pub(in crate::trace) material: &'a Material,
    pub(in crate::trace) facing: &'a Facing,
    pub(in crate::trace) incident: Vec3,
    /// Number of rays of the lobe.
    pub(in crate::trace) lobe_rays: u32,
    /// Number of points on each light.
    pub(in crate::trace) samples: u32,
    /// Number of shadow rays in all.
    pub(in crate::trace) shadow_rays: u32,
}

/// How a ray left the last rough surface, by which a lamp that it meets counts.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct LobeRay {
    /// Position of the surface.
    pub(in crate::trace) position: Vec3,
    /// Rays per solid angle in this direction; zero where points on lamps bring all of their light.
    pub(in crate::trace) density: f32,
    /// Number of points on each light there.
    pub(in crate::trace) samples: u32,
}

/// A point on a light that may get a shadow ray.
struct Candidate {
    ray: Ray,
    light: u32,
    /// What the lobe scatters towards the viewer where nothing hides the light.
    radiance: Vec3,
    /// Factor (0..1) of its importance, by how much of the light is visible from around.
    visible: f32,
}

impl Tracer {
    /// Finds the radiance that a rough lobe scatters straight from the lights in front of `point`,
    /// and passes it to `add` with the light's index. `shift` returns the random shift of the
    /// samples of a light, by its index.
    pub(in crate::trace) fn light_of_lobe(
        &self,
        point: &SurfacePoint,
        lobe: &LitLobe<'_>,
        shift: impl Fn(u32) -> [f32; 2],
        rays: &mut RayCounts,
        mut add: impl FnMut(u32, Vec3),
    ) {
        let candidates = self.candidates(point, lobe, &shift, rays);
        let weight = |candidate: &Candidate| candidate.radiance.max_element() * candidate.visible;
        let total: f32 = candidates.iter().map(weight).sum();
        // Of less, the steps below would be zero.
        if !total.is_normal() {
            return;
        }
        // Choose at equal distances along the sum.
        let count = lobe.shadow_rays.clamp(1, BUNDLE_RAYS as u32);
        let (step, mut next) = (total / count as f32, shift(CHOICE)[0] * total / count as f32);
        let mut bundle = RayBundle::new(point.origin_in_front());
        let (mut chosen, mut before) = (Vec::with_capacity(count as usize), 0.0);
        for candidate in &candidates {
            before += weight(candidate);
            let mut turns = 0.0;
            while next < before {
                (turns, next) = (turns + 1.0, next + step);
            }
            if turns > 0.0 && bundle.len() < BUNDLE_RAYS {
                bundle.push(candidate.ray.direction, candidate.ray.t_max);
                chosen.push((candidate.light, candidate.radiance / weight(candidate) * (turns * step)));
            }
        }
        rays.shadow += bundle.len() as u64;
        let mut passed = [Vec3::ZERO; BUNDLE_RAYS];
        self.transmittances(&bundle, &mut passed);
        for ((light, radiance), passed) in chosen.into_iter().zip(passed) {
            if passed != Vec3::ZERO {
                add(light, radiance * passed);
            }
        }
    }

    /// Points on the lights in front of a point, from which the lobe scatters light to the viewer.
    fn candidates(
        &self,
        point: &SurfacePoint,
        lobe: &LitLobe<'_>,
        shift: &impl Fn(u32) -> [f32; 2],
        rays: &mut RayCounts,
    ) -> Vec<Candidate> {
        let (origin, mut candidates) = (point.origin_in_front(), Vec::new());
        let cell = self.lights_at(point.position);
        let count = CANDIDATES.saturating_mul(lobe.samples);
        let chosen = match cell.is_shared() {
            true => cell.chosen_turns(self.light_grid().tree(), point, count, shift(SHARING)[0]),
            false => Vec::new(),
        };
        for LightTurn { index, samples, weight, visible } in cell.own_turns(lobe.samples).chain(chosen) {
            let light = &self.scene().lights[index as usize];
            if matches!(light, Light::Sky) || is_behind(light, point) {
                continue;
            }
            let (count, shift) = (sample_count(light, samples), shift(index));
            for first in (0..count).step_by(BUNDLE_RAYS) {
                let mut bundle = RayBundle::new(origin);
                let mut unblocked = [Vec3::ZERO; BUNDLE_RAYS];
                let range = first..count.min(first + BUNDLE_RAYS as u32);
                let points = Points { range, count, shift };
                rays.clamped += add_samples(
                    self.scene(),
                    light,
                    point,
                    points,
                    f32::INFINITY,
                    &mut bundle,
                    &mut unblocked,
                );
                for (ray, irradiance) in bundle.rays().zip(unblocked) {
                    let share = weight / count as f32 * lobe.share_of_points(point, light, &ray, irradiance);
                    let value = lobe.material.evaluate(
                        lobe.facing,
                        lobe.incident,
                        ray.direction.normalize_or(Vec3::Y),
                    );
                    let radiance = irradiance * value * share;
                    if radiance.max_element() > 0.0 {
                        candidates.push(Candidate { ray, light: index, radiance, visible });
                    }
                }
            }
        }
        candidates
    }

    /// Share (0..1) of a lamp's emission that counts where a ray of a rough lobe meets it.
    pub(in crate::trace) fn lamp_share(&self, from: &LobeRay, lamp: &SurfacePoint) -> f32 {
        let scene = self.scene();
        let Some(light) = scene.lamp_of_triangle(lamp.triangle) else { return 1.0 };
        if !self.lights_at(from.position).contains(self.light_grid().tree(), light) {
            return 1.0;
        }
        let d = lamp.position - from.position;
        let distance2 = d.length_squared();
        let of_area = |area: f32| distance2 * distance2.sqrt() / (lamp.geometric_normal.dot(d).abs() * area);
        let density = match &scene.lights[light as usize] {
            Light::Quad { edge_u, edge_v, .. } => of_area(edge_u.cross(*edge_v).length()),
            Light::Triangles { area, picture: Some(_), .. } => nominal_density(*area, distance2),
            Light::Triangles { area, .. } => of_area(*area),
            _ => return 1.0,
        };
        balance(from.density, density * from.samples as f32)
    }
}

impl LitLobe<'_> {
    /// Share (0..1) of a light that counts for points on it rather than for rays of the lobe.
    fn share_of_points(&self, point: &SurfacePoint, light: &Light, ray: &Ray, irradiance: Vec3) -> f32 {
        let direction = ray.direction.normalize_or(Vec3::Y);
        let cos = point.shading_normal.dot(direction);
        let density = match light {
            Light::Triangles { area, picture: Some(_), .. } => {
                nominal_density(*area, ray.direction.length_squared())
            }
            Light::Quad { radiance, .. } | Light::Triangles { radiance, .. } => {
                cos * radiance.max_element() / irradiance.max_element()
            }
            _ => return 1.0,
        };
        let of_lobe = self.material.pdf(self.facing, self.incident, direction);
        balance(density * self.samples as f32, of_lobe * self.lobe_rays as f32)
    }
}

/// Points per solid angle on a lamp that shows a picture, as if it faced the surface and emitted
/// evenly. The true density follows the picture; any other serves as well, because the shares of
/// points and of rays still add up to one in each direction.
fn nominal_density(area: f32, distance2: f32) -> f32 {
    distance2 / area
}

/// The balance heuristic: the share of a density among two.
fn balance(own: f32, other: f32) -> f32 {
    if own.is_finite() { own / (own + other).max(f32::MIN_POSITIVE) } else { 1.0 }
}
