//! How much smooth light differs between two states of a scene whose surfaces differ.
//!
//! With the light `L = E + R T L` of one state and `L' = E' + R' T' L'` of the other, what arrives
//! at a surface that is in both differs by
//!
//! ```text
//! T' L' - T L
//! ```
//!
//! It is sampled along directions that both states share, with the random numbers of one: where a
//! ray meets the same surface in the same light in both, nothing is left of the difference, noise
//! included. The light at the ends of rays is that of cells (`cells/`), whose random numbers follow
//! from their place, so they too are equal where their light is. Rays that may meet what moved
//! matter most and are rare: they are chosen apart, in the cones around it.

use super::doubt::DifferenceLight;
use super::samples::{Difference, Doubt, DoubtSamples};
use super::shaft::Bounds;
use crate::cells::SurfaceCells;
use crate::math::sampling::{cosine_hemisphere, frame_around, uniform_cone};
use crate::math::{key::Key, sequence::Sequence};
use crate::trace::{CachedLight, RayCounts, SmoothSettings, SurfacePoint, TraceSettings, Tracer};
use arrayvec::ArrayVec;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

/// Dimensions of the random numbers that choose a direction, and a cone.
const DIRECTION: u32 = 11 << 24;

/// Footprint of the rays that read cells, scene units: the smallest cells are sixteen times as
/// large, a thousandth to a five-hundredth of the scene's diagonal.
const FOOTPRINT: f32 = 1.0 / 16.0;

/// Samples of direct light at most: it has little noise.
const DIRECT_SAMPLES: u32 = 16;

/// Boxes at most around what moved.
pub(super) const MAX_BOXES: usize = 16;

/// Two states of a scene whose surfaces differ within some boxes.
pub(super) struct TransportDifference<'a> {
    states: [&'a Tracer; 2],
    cells: [SurfaceCells; 2],
    bounces: u32,
    /// Centre and radius of the spheres around the boxes.
    spheres: Vec<(Vec3, f32)>,
    /// The difference of direct light, where it is not known otherwise.
    direct: Option<&'a DifferenceLight>,
}

/// Directions towards a sphere: its axis, one minus the cosine of its half-angle, and that cosine.
struct Cone {
    axis: Vec3,
    width: f32,
    cosine: f32,
}

impl<'a> TransportDifference<'a> {
    /// The difference between two states that is due to what moved within some boxes.
    pub(super) fn new(states: [&'a Tracer; 2], boxes: &[Bounds], settings: &TraceSettings) -> Self {
        let cells = states.map(|state| SurfaceCells::new(state.scene(), settings));
        let sphere = |&[low, high]: &Bounds| ((low + high) / 2.0, low.distance(high) / 2.0);
        let spheres = boxes.iter().map(sphere).collect();
        Self { states, cells, bounces: settings.bounces, spheres, direct: None }
    }

    /// The same with the difference of direct light.
    pub(super) fn with_direct(self, direct: &'a DifferenceLight) -> Self {
        Self { direct: Some(direct), ..self }
    }

    /// The directions in which what moved may be seen from a point; `None` within one of its
    /// spheres, where these are all directions.
    fn cones(&self, point: &SurfacePoint) -> Option<ArrayVec<Cone, MAX_BOXES>> {
        let mut cones = ArrayVec::new();
        for &(centre, radius) in &self.spheres {
            let to = centre - point.position;
            let distance2 = to.length_squared();
            let sine2 = radius * radius / distance2;
            if sine2.is_nan() || sine2 >= 1.0 {
                return None;
            }
            if point.geometric_normal.dot(to) > -radius && !cones.is_full() {
                let cosine = (1.0 - sine2).sqrt();
                cones.push(Cone { axis: to / distance2.sqrt(), width: sine2 / (1.0 + cosine), cosine });
            }
        }
        Some(cones)
    }

    /// The light that arrives from a direction now, less that of before, by one sample. Directions
    /// below the surface bring none.
    fn along(
        &self,
        point: &SurfacePoint,
        direction: Vec3,
        (sequence, sample): (Sequence, u32),
        rays: &mut RayCounts,
    ) -> Vec3 {
        if point.geometric_normal.dot(direction) <= 0.0 || point.shading_normal.dot(direction) <= 0.0 {
            return Vec3::ZERO;
        }
        let mut light = |state: usize| {
            let cache = (self.bounces > 0).then_some(&self.cells[state] as &dyn CachedLight);
            let settings = SmoothSettings {
                bounces: self.bounces,
                cache,
                footprint: FOOTPRINT,
                samples: 1,
                finds_near: false,
            };
            self.states[state].smooth_light_along((point, direction), (sequence, sample), settings, rays)
        };
        let [before, now] = [light(0), light(1)];
        now - before
    }
}

impl Difference for TransportDifference<'_> {
    const SAMPLES: [u32; 2] = [8, 64];

    /// 0.6 seconds on two cores in a room, cells included.
    const MAX_SAMPLES: u32 = 1 << 16;

    fn at(&self, point: &SurfacePoint, samples: u32, key: Key) -> DoubtSamples {
        let (mut found, mut rays) = (DoubtSamples::default(), RayCounts::default());
        let cones = self.cones(point);
        let cones: &[Cone] = cones.as_deref().unwrap_or(&[]);
        let total: f32 = cones.iter().map(|cone| cone.width).sum();
        let (sequence, of_cones) = (Sequence::of_key(key), Sequence::of_key(key.with(DIRECTION)));
        let sees = |cone: &Cone, direction: Vec3| cone.axis.dot(direction) >= cone.cosine;
        for sample in 0..samples {
            let u = sequence.pair(sample, DIRECTION);
            let direction = frame_around(point.shading_normal) * cosine_hemisphere(u);
            // Directions in a cone are the part of the cones.
            let is_apart = cones.iter().any(|cone| sees(cone, direction));
            let mut difference = match is_apart {
                true => Vec3::ZERO,
                false => self.along(point, direction, (sequence, sample), &mut rays),
            };
            // Choose a cone by its solid angle, and a direction in it. Its density counts all cones
            // that contain it.
            let mut chosen = of_cones.pair(sample, DIRECTION)[0] * total;
            let cone = cones.iter().find(|cone| {
                chosen -= cone.width;
                chosen < 0.0
            });
            if let Some(cone) = cone.or(cones.last()) {
                let u = of_cones.pair(sample, DIRECTION + 1);
                let direction = frame_around(cone.axis) * uniform_cone(u, 1.0 - cone.width);
                let containing = cones.iter().filter(|cone| sees(cone, direction)).count().max(1);
                let share = FRAC_1_PI * point.shading_normal.dot(direction) * TAU * total / containing as f32;
                difference += share * self.along(point, direction, (of_cones, sample), &mut rays);
            }
            if difference.is_finite() {
                found.add(difference);
            }
        }
        let of_direct = |light: &DifferenceLight| light.at(point, samples.min(DIRECT_SAMPLES), key).direct;
        found.direct = self.direct.map_or(0.0, of_direct);
        found
    }

    /// The difference has a sign, and samples cancel. Few of them tell only of a large one.
    fn doubt(own: &DoubtSamples, around: &DoubtSamples) -> Doubt {
        let (own, around) = (own.mean_plus(-2.0), around.mean_plus(1.0));
        Doubt { direct: own.direct.max(around.direct), smooth: own.smooth.max(around.smooth) }
    }
}
