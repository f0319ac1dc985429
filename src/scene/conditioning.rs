//! How hard a scene is on single precision and on truncated light, in numbers: found once, when the scene is complete.

use crate::scene::{Light, Material, MaterialKind, Scene};
use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;

/// The smallest feature of a building that must be right, metres.
pub const SMALLEST_FEATURE_M: f64 = 1e-3;

/// Height over longest edge below which a triangle is a needle: a ray at 30 degrees to it meets it with a condition
/// number below 1e-5, where a hit is lost or misplaced by a thousandth of an edge in some of 5000 rays.
pub const NEEDLE: f64 = 2e-5;

/// Steps of f32 that a feature must be large to keep its shape.
const STEPS_PER_FEATURE: f64 = 8.0;

/// What was changed so that the scene can be traced at all, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Repairs {
    /// Triangles dropped for a vertex that is missing, not finite or absurdly far away.
    pub triangles_not_finite: usize,
    /// Triangles dropped for having no area in f32.
    pub triangles_without_area: usize,
    /// Triangles no ray is told of, because an equal one, opaque and giving as much light, comes before them.
    pub duplicates_hidden: usize,
    /// Triangles equal to an earlier one that rays meet all the same: one of the two is glass, cut out or a lamp.
    pub duplicates_seen: usize,
    /// Materials scaled down because they reflected more than arrives.
    pub materials_scaled: usize,
    /// Numbers of materials, lights and textures that were negative, not finite or out of range.
    pub values_clamped: usize,
    /// True where centre and scale are those of the bulk of the vertices, because a few lie far outside.
    pub ignores_outliers: bool,
}

/// The numbers, with what was done about them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Conditioning {
    /// Largest coordinate over the smallest feature (1 mm), as the model has it: bits lost before the first ray.
    pub coordinate_ratio_in_file: f64,
    /// The same about the scene's own origin, which is what rays see; safe below 1e5.
    pub coordinate_ratio: f64,
    /// Features smaller than this, in metres, lose their shape where they are farthest from the scene's origin.
    pub smallest_feature_m: f64,
    /// The largest share of light that any material passes on, and so the ratio of the series of bounces.
    pub reflectance_max: f32,
    /// Of that material.
    pub reflectance_max_material: String,
    /// Brightest over dimmest emitted radiance; 1 where there is only one.
    pub light_ratio: f64,
    /// Triangles thinner than [`NEEDLE`].
    pub needles: usize,
    /// Least height over longest edge of any triangle.
    pub thinnest: f64,
    /// Triangles with the very corners of an earlier one: the first is seen.
    pub coplanar_duplicates: usize,
    /// What was changed.
    #[serde(rename = "mended")]
    pub repairs: Repairs,
}

impl Conditioning {
    /// What a complete scene shows, and what was mended on its way in.
    fn of(scene: &Scene, repairs: Repairs) -> Self {
        let [low, high] = scene.bounds_m;
        let farthest_m = low.abs().max(high.abs()).max_element();
        let farthest = scene.positions.par_iter().map(|p| p.abs().max_element()).reduce(|| 0.0, f32::max);
        let farthest_in_scene_m = f64::from(farthest) / scene.frame.units_per_metre;
        let (needles, thinnest) = needles(scene);
        let mut conditioning = Self {
            coordinate_ratio_in_file: farthest_m / SMALLEST_FEATURE_M,
            coordinate_ratio: farthest_in_scene_m / SMALLEST_FEATURE_M,
            smallest_feature_m: farthest_in_scene_m * f64::from(f32::EPSILON) * STEPS_PER_FEATURE,
            needles,
            thinnest,
            coplanar_duplicates: repairs.duplicates_hidden + repairs.duplicates_seen,
            repairs,
            ..Self::default()
        };
        conditioning.set_light(scene);
        conditioning
    }

    /// The same geometry under other materials or lights.
    pub(crate) fn set_light(&mut self, scene: &Scene) {
        let largest = scene.materials.iter().max_by(|a, b| passed_on(a).total_cmp(&passed_on(b)));
        self.reflectance_max = largest.map_or(0.0, passed_on);
        self.reflectance_max_material = largest.map_or_else(String::new, |m| m.name.clone());
        self.light_ratio = light_ratio(scene);
    }

    /// The share of light that lies beyond so many bounces, at most: the rest of the geometric series. `None` where
    /// it has no bound.
    pub fn rest_after(&self, bounces: u32) -> Option<f64> {
        let ratio = f64::from(self.reflectance_max);
        (ratio < 1.0).then(|| ratio.powi(bounces as i32 + 1))
    }

    /// The same in sentences for people, one a fact.
    pub fn sentences(&self) -> Vec<String> {
        let m = &self.repairs;
        let duplicates = m.duplicates_hidden;
        let mut said = vec![
            format!(
                "largest coordinate over 1 mm: {:.1e} in the file, {:.1e} after moving the origin; features above \
                 {:.1e} m keep their shape everywhere",
                self.coordinate_ratio_in_file, self.coordinate_ratio, self.smallest_feature_m
            ),
            format!(
                "{} passes on {:.3} of the light, the most of all materials; brightest over dimmest light {:.1e}",
                named(&self.reflectance_max_material),
                self.reflectance_max,
                self.light_ratio
            ),
            format!(
                "{} needles, the thinnest triangle {:.1e} of its length high; {} triangles lie on an equal one, of \
                 which the first is seen",
                self.needles, self.thinnest, self.coplanar_duplicates
            ),
        ];
        if *m != (Repairs { duplicates_seen: m.duplicates_seen, ..Repairs::default() }) {
            said.push(format!(
                "mended: {} triangles without finite corners and {} without area dropped, {duplicates} duplicates hidden, {} materials scaled down, \
                 {} values clamped{}",
                m.triangles_not_finite,
                m.triangles_without_area,
                m.materials_scaled,
                m.values_clamped,
                if m.ignores_outliers { "; a few far vertices were ignored for centre and scale" } else { "" }
            ));
        }
        said
    }
}

impl Scene {
    /// Finds the numbers of a scene that is complete but for them, and what they ask of the renderer.
    pub(crate) fn set_conditioning(&mut self, repairs: Repairs) {
        self.conditioning = Conditioning::of(self, repairs);
        self.features.needles = self.conditioning.needles > 0;
    }
}

fn named(material: &str) -> String {
    if material.is_empty() { "a material without a name".to_owned() } else { format!("'{material}'") }
}

fn passed_on(material: &Material) -> f32 {
    let specular = match material.kind {
        MaterialKind::Mirror { fresnel: true, .. } => Vec3::ONE - material.diffuse,
        _ => material.specular(),
    };
    (material.diffuse + specular).max_element()
}

fn light_ratio(scene: &Scene) -> f64 {
    let radiance_of = |light: &Light| match light {
        Light::Quad { radiance, .. } | Light::Triangles { radiance, .. } => Some(radiance.max_element()),
        Light::Sun { cos_angular_radius, irradiance, .. } => {
            let solid_angle = std::f32::consts::TAU * (1.0 - cos_angular_radius);
            Some(irradiance.max_element() / solid_angle)
        }
        Light::Sky => scene.sky.map(|sky| sky.zenith.max_element()),
        // A point has an intensity, which is no radiance.
        Light::Point { .. } => None,
    };
    let found = scene.lights.iter().filter_map(radiance_of).filter(|r| *r > 0.0 && r.is_finite());
    let [low, high] =
        found.map(f64::from).fold([f64::INFINITY, 0.0f64], |[low, high], r| [low.min(r), high.max(r)]);
    if high > 0.0 { high / low } else { 1.0 }
}

/// How many triangles are needles, and the least height over longest edge.
fn needles(scene: &Scene) -> (usize, f64) {
    let thinness = |t: u32| {
        let [a, b, c] = scene.corners(t).map(Vec3::as_dvec3);
        let longest2 = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        (b - a).cross(c - a).length() / longest2
    };
    (0..scene.triangles.len() as u32)
        .into_par_iter()
        .map(thinness)
        .fold(|| (0, f64::INFINITY), |(n, least), t| (n + usize::from(t < NEEDLE), least.min(t)))
        .reduce(|| (0, f64::INFINITY), |a, b| (a.0 + b.0, a.1.min(b.1)))
}
