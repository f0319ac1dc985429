//! The sources of the difference between the light of two states of a scene.
//!
//! Light obeys one linear equation (Kajiya 1986): `L = E + R T L`, with the emission `E`, the
//! reflection `R` of the surfaces, and the transport `T` between them. For two states of one
//! geometry, the difference `D = L' - L` of their light obeys it as well:
//!
//! ```text
//! D = (E' - E) + (R' - R) T L' + R T D
//! ```
//!
//! So it is the light of the old scene with other lamps: what surfaces emit more or less, and what
//! they reflect more or less of the light that arrives at them now. With the absolute values of the
//! sources the solution bounds the absolute value of `D`, channel by channel, because reflection
//! and transport are never negative; where all sources have one sign, it is `D` itself.

use super::elements::{Group, groups_of};
use crate::bsdf::albedo;
use crate::math::sequence::PointSeed;
use crate::math::{key::Key, sequence::Sequence};
use crate::scene::content::materials_of_both;
use crate::scene::{Light, Material, Scene, Sky};
use crate::trace::{RayCounts, SmoothSettings, SurfacePoint, TraceSettings, Tracer};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Points at which the arriving light is sampled: of a group at least and at most, and of all
/// groups together between these bounds.
const POINTS: [u32; 3] = [4, 32, 512];

/// Samples of the light that arrives at each of these points.
const SAMPLES: u32 = 4;

/// Triangles that a thread looks at together.
const CHUNK: usize = 1 << 14;

/// A group of pieces of surface that sends other light than before.
#[derive(Debug)]
pub(super) struct SourceGroup {
    pub(super) group: Group,
    /// Largest channel of the mean change of the radiance that leaves it.
    pub(super) radiance: Vec3,
    /// Mean light that arrives at it now, as radiance of a white surface.
    pub(super) light: Vec3,
    /// Change of its emission.
    pub(super) emission: Vec3,
}

/// All that sends other light than before.
#[derive(Debug, Default)]
pub(super) struct Sources {
    pub(super) groups: Vec<SourceGroup>,
    /// Group of each triangle that is one of them, by side; ascending by triangle.
    pub(super) by_triangle: Vec<(u32, Vec3, u32)>,
    /// Sun and point lights, before and now.
    pub(super) lamps: Vec<[Option<Light>; 2]>,
    /// True where a mirror changes. What it reflects of lamps is concentrated, and is not found
    /// here.
    pub(super) changes_mirrors: bool,
    /// The skies before and now, where they differ.
    pub(super) skies: Option<[Option<Sky>; 2]>,
}

/// The materials of a triangle in two states of a scene.
fn materials_of(old: &Scene, new: &Scene, triangle: u32) -> [u32; 2] {
    [old, new].map(|scene| scene.triangle_materials[triangle as usize].0)
}

/// The pairs of materials that triangles have in two states of a scene, ascending.
fn material_pairs(old: &Scene, new: &Scene) -> Vec<[u32; 2]> {
    let pairs = |chunk: usize| {
        let triangles = chunk * CHUNK..((chunk + 1) * CHUNK).min(new.triangles.len());
        let mut pairs: Vec<[u32; 2]> = triangles.map(|t| materials_of(old, new, t as u32)).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    };
    let chunks = 0..new.triangles.len().div_ceil(CHUNK);
    let mut all: Vec<[u32; 2]> = chunks.into_par_iter().flat_map_iter(pairs).collect();
    all.sort_unstable();
    all.dedup();
    all
}

impl Sources {
    /// Finds the sources of the difference between the light of two scenes of the same geometry.
    /// Returns `None` where shadow rays pass surfaces differently, or where the suns of a sky
    /// picture change, about which this says nothing.
    pub(super) fn between(old: &Scene, new: &Tracer, settings: &TraceSettings) -> Option<Self> {
        let scene = new.scene();
        let used = material_pairs(old, scene);
        let materials = materials_of_both([old, scene]);
        let pairs = || used.iter().map(|&[a, b]| [materials[0][a as usize], materials[1][b as usize]]);
        if pairs().any(|[a, b]| a.transmission != b.transmission) {
            return None;
        }
        let suns = |scene: &Scene| scene.sky.as_ref().is_some_and(|sky| sky.with_suns().is_some());
        if old.sky != scene.sky && (suns(old) || suns(scene)) {
            return None;
        }
        // Normal maps change what is reflected as mirrors do.
        let is_special = |m: &Material| m.is_mirror() || m.detail.normal.is_some();
        let mirror = |m: &Material| is_special(m).then_some((m.kind, m.detail));
        let changes_mirrors = used
            .iter()
            .any(|&[a, b]| mirror(&old.materials[a as usize]) != mirror(&scene.materials[b as usize]));
        let changed: Vec<[u32; 2]> = used
            .iter()
            .zip(pairs())
            .filter(|(_, [a, b])| (a.reflection, a.emission) != (b.reflection, b.emission))
            .map(|(pair, _)| *pair)
            .collect();
        let is_changed = |&t: &u32| changed.binary_search(&materials_of(old, scene, t)).is_ok();
        let triangles: Vec<u32> =
            (0..scene.triangles.len() as u32).into_par_iter().filter(is_changed).collect();
        let groups = groups_of(scene, &triangles);
        let points = (POINTS[2] / groups.len().max(1) as u32).clamp(POINTS[0], POINTS[1]);
        let groups: Vec<SourceGroup> = groups
            .into_par_iter()
            .enumerate()
            .map(|(number, group)| SourceGroup::new(group, (number as u32, points), old, new, settings))
            .filter(|group| group.radiance != Vec3::ZERO)
            .collect();
        let mut by_triangle: Vec<(u32, Vec3, u32)> = (0..)
            .zip(&groups)
            .flat_map(|(number, g)| g.group.pieces.iter().map(move |p| (p.triangle, p.normal, number)))
            .collect();
        by_triangle.sort_by_key(|entry| entry.0);
        by_triangle.dedup_by_key(|entry| (entry.0, entry.1.to_array().map(f32::to_bits)));
        let skies = (old.sky != scene.sky).then(|| [old.sky.clone(), scene.sky.clone()]);
        Some(Self { groups, by_triangle, lamps: changed_lamps(old, scene), changes_mirrors, skies })
    }

    /// True where nothing sends other light than before.
    pub(super) fn is_empty(&self) -> bool {
        self.groups.is_empty() && self.lamps.is_empty() && self.skies.is_none()
    }

    /// Where a surface point is one of the sources on the side that is seen: the radius of its
    /// group, and the change of the radiance that it emits and that it reflects.
    pub(super) fn radiance_of(&self, scenes: [&Scene; 2], point: &SurfacePoint) -> Option<(f32, Vec3, Vec3)> {
        let first = self.by_triangle.partition_point(|entry| entry.0 < point.triangle);
        let entries = self.by_triangle[first..].iter().take_while(|entry| entry.0 == point.triangle);
        let number = entries.filter(|entry| entry.1.dot(point.geometric_normal) > 0.0).map(|e| e.2).next()?;
        let source = &self.groups[number as usize];
        let change = change_of_albedo(scenes, point.triangle, point.uv);
        Some((source.group.radius, source.emission, change * source.light))
    }
}

impl SourceGroup {
    /// Samples the light that arrives at a number of points of a group.
    fn new(
        group: Group,
        (number, points): (u32, u32),
        old: &Scene,
        new: &Tracer,
        settings: &TraceSettings,
    ) -> Self {
        let (mut light, mut radiance, mut emission) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
        for k in 0..points {
            let key = Key::of_pixel(settings.seed, number).with(k);
            let [choice, _] = key.with(1).pair();
            let piece = group.piece((k as f32 + choice) / points as f32);
            let at = piece.point(key.pair());
            let point = SurfacePoint::from_position(new.scene(), piece.triangle, at, -piece.normal);
            let arriving = light_at(new, &point, settings, key);
            let scenes = [old, &**new.scene()];
            let [before, now] =
                scenes.map(|s| s.material_of(piece.triangle).emission_at(&s.textures, || point.uv));
            emission += (now - before).abs();
            radiance += change_of_albedo(scenes, point.triangle, point.uv) * arriving;
            light += arriving;
        }
        let [light, radiance, emission] = [light, radiance, emission].map(|sum| sum / points as f32);
        Self { group, radiance: radiance + emission, light, emission }
    }
}

/// All light that arrives at a point, as radiance of a white surface, also where the surface is
/// black now.
fn light_at(tracer: &Tracer, point: &SurfacePoint, settings: &TraceSettings, key: Key) -> Vec3 {
    let (mut rays, seed) = (RayCounts::default(), PointSeed::from(key));
    let direct = tracer.direct_irradiance(point, SAMPLES, settings, seed, &mut rays) / std::f32::consts::PI;
    if settings.bounces == 0 {
        return direct;
    }
    let smooth = SmoothSettings {
        bounces: settings.bounces,
        cache: None,
        footprint: 0.0,
        samples: SAMPLES,
        finds_near: false,
    };
    let sums = tracer.smooth_light(point, 0..SAMPLES, Sequence::of_key(key), smooth, &mut rays);
    direct + (sums[0] + sums[1]) / SAMPLES as f32
}

/// The absolute change of the share of light that a surface reflects, diffusely or as a mirror.
fn change_of_albedo([old, new]: [&Scene; 2], triangle: u32, uv: Vec2) -> Vec3 {
    let reflected = |scene: &Scene| {
        let material = scene.material_of(triangle);
        let diffuse = albedo(material, &scene.textures, || uv);
        if material.is_glass() {
            return diffuse;
        }
        diffuse + material.at(&scene.textures, || uv).specular()
    };
    (reflected(new) - reflected(old)).abs()
}

/// Lamps without a surface that are in one of two scenes only. A sun that moved is a pair.
fn changed_lamps(old: &Scene, new: &Scene) -> Vec<[Option<Light>; 2]> {
    let mut lamps = Vec::new();
    if old.sun != new.sun {
        lamps.push([old.sun.map(Light::from), new.sun.map(Light::from)]);
    }
    let points = |scene: &Scene| -> Vec<Light> {
        scene.lights.iter().filter(|light| matches!(light, Light::Point { .. })).cloned().collect()
    };
    let [before, now] = [points(old), points(new)];
    lamps.extend(before.iter().filter(|light| !now.contains(light)).map(|light| [Some(light.clone()), None]));
    lamps.extend(now.iter().filter(|light| !before.contains(light)).map(|light| [None, Some(light.clone())]));
    lamps
}
