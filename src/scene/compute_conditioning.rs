//! Computes the numbers in [`Conditioning`] from a scene.

use super::{Conditioning, Light, Material, MaterialKind, PictureSky, Repairs, Scene, Sky};
use glam::Vec3;
use rayon::prelude::*;

/// Smallest feature of a building that must be right, in metres.
const SMALLEST_FEATURE_M: f64 = 1e-3;

/// Ratio of height to longest edge below which a triangle is a needle. A ray at 30 degrees to such
/// a triangle has a condition number below 1e-5, and a hit is lost or misplaced by a thousandth of
/// an edge for some of 5000 rays.
const NEEDLE: f64 = 2e-5;

/// Size, in units in the last place of f32, that a feature needs to keep its shape.
const STEPS_PER_FEATURE: f64 = 8.0;

impl Conditioning {
    /// Computes the numbers of the geometry. [`Scene::update_light_numbers`] computes the others.
    pub(super) fn of(scene: &Scene, repairs: Repairs) -> Self {
        let [low, high] = scene.bounds_m;
        let farthest_m = low.abs().max(high.abs()).max_element();
        let farthest = scene.positions.par_iter().map(|p| p.abs().max_element()).reduce(|| 0.0, f32::max);
        let farthest_in_scene_m = f64::from(farthest) / scene.frame.units_per_metre;
        let (needles, thinnest) = needles(scene);
        Self {
            coordinate_ratio_in_file: farthest_m / SMALLEST_FEATURE_M,
            coordinate_ratio: farthest_in_scene_m / SMALLEST_FEATURE_M,
            smallest_feature_m: farthest_in_scene_m * f64::from(f32::EPSILON) * STEPS_PER_FEATURE,
            needles,
            thinnest,
            coplanar_duplicates: repairs.duplicates_hidden + repairs.duplicates_seen,
            repairs,
            ..Self::default()
        }
    }
}

impl Scene {
    /// Updates the condition numbers that depend on materials and lights.
    pub(super) fn update_light_numbers(&mut self) {
        let most = self.materials.iter().max_by(|a, b| max_albedo(a).total_cmp(&max_albedo(b)));
        let (share, name) = most.map_or((0.0, String::new()), |m| (max_albedo(m), m.name.clone()));
        let light_ratio = light_ratio(self);
        let numbers = &mut self.conditioning;
        (numbers.reflectance_max, numbers.reflectance_max_material) = (share, name);
        numbers.light_ratio = light_ratio;
    }
}

/// Returns the largest share of light, over colours and angles, that a material reflects or
/// transmits.
fn max_albedo(material: &Material) -> f32 {
    let specular = match material.kind {
        MaterialKind::Mirror { fresnel: true, .. } | MaterialKind::Glossy { .. } => {
            Vec3::ONE - material.diffuse
        }
        // Each place transmits one part of its light and scatters the other.
        _ if material.detail.transmission_texture.is_some() => Vec3::ONE - material.diffuse,
        _ => material.specular(),
    };
    (material.diffuse + specular).max_element()
}

/// Returns the ratio of the brightest to the dimmest radiance emitted by lights with an area.
fn light_ratio(scene: &Scene) -> f64 {
    let radiance_of = |light: &Light| match light {
        Light::Quad { radiance, .. } | Light::Triangles { radiance, .. } => Some(radiance.max_element()),
        Light::Sun { cos_angular_radius, irradiance, .. } => {
            let solid_angle = std::f32::consts::TAU * (1.0 - cos_angular_radius);
            Some(irradiance.max_element() / solid_angle)
        }
        Light::SkySuns => scene.sky.as_ref().and_then(Sky::with_suns).map(PictureSky::max_radiance),
        Light::Sky => scene.sky.as_ref().map(|sky| sky.zenith().max_element()),
        // A point light has an intensity, not a radiance.
        Light::Point { .. } => None,
    };
    let found = scene.lights.iter().filter_map(radiance_of).filter(|r| *r > 0.0 && r.is_finite());
    let [low, high] =
        found.map(f64::from).fold([f64::INFINITY, 0.0f64], |[low, high], r| [low.min(r), high.max(r)]);
    if high > 0.0 { high / low } else { 1.0 }
}

/// Returns the number of needles, and the smallest ratio of height to longest edge.
fn needles(scene: &Scene) -> (usize, f64) {
    let thinness = |t: u32| {
        let [a, b, c] = scene.corners(t).map(Vec3::as_dvec3);
        let longest2 = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        (b - a).cross(c - a).length() / longest2
    };
    scene
        .triangle_indices()
        .into_par_iter()
        .map(thinness)
        .fold(|| (0, f64::INFINITY), |(n, least), t| (n + usize::from(t < NEEDLE), least.min(t)))
        .reduce(|| (0, f64::INFINITY), |a, b| (a.0 + b.0, a.1.min(b.1)))
}
