//! How much the light that arrives at a point may differ between two states of a scene.

use super::elements::MAX_GROUPS;
use super::samples::{Difference, Doubt, DoubtSamples};
use super::sources::{SourceGroup, Sources};
use crate::math::{Ray, key::Key, sequence::Sequence};
use crate::scene::Scene;
use crate::trace::{PathStop, RayCounts, SurfacePoint, TraceSettings, Tracer};
use arrayvec::ArrayVec;
use glam::Vec3;
use std::f32::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Dimensions of the random numbers that choose a source at the stops of a path, and a point of it.
const SOURCE: u32 = 1 << 25;

/// Dimension of the shifts of the samples of lamps.
const LAMP: u32 = 7;

/// The share of a group's radius within which paths find it; farther away its points are sampled.
/// Samples of near points would have a large variance.
const NEAR: f32 = 0.5;

/// The light of the difference between two states of a scene.
#[derive(Debug)]
pub(super) struct DifferenceLight {
    /// The old scene, with the geometry of now.
    old: Tracer,
    new: Arc<Scene>,
    sources: Sources,
    bounces: u32,
}

/// Direct and smooth light of one sample.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    direct: Vec3,
    smooth: Vec3,
}

impl DifferenceLight {
    /// Finds the difference between an old state of a scene and the present one. Returns `None`
    /// where nothing can be said about it.
    pub(super) fn new(old: &Arc<Scene>, now: &Tracer, settings: &TraceSettings) -> Option<Self> {
        let sources = Sources::between(old, now, settings)?;
        let old = now.with_same_geometry(old.clone());
        Some(Self { old, new: now.scene().clone(), sources, bounces: settings.bounces })
    }

    /// True where smooth light may differ by what is not found here.
    pub(super) fn changes_mirrors(&self) -> bool {
        self.bounces > 0 && self.sources.changes_mirrors
    }

    /// The two states, where sun, point lights or sky differ and paths bring light: few paths find
    /// the sky, or what the sun shines on, so their smooth light is compared in another way.
    pub(super) fn states<'a>(&'a self, now: &'a Tracer) -> Option<[&'a Tracer; 2]> {
        let is_far = self.sources.skies.is_some() || !self.sources.lamps.is_empty();
        (is_far && self.bounces > 0).then_some([&self.old, now])
    }

    /// True where the two states have the same light.
    pub(super) fn is_dark(&self) -> bool {
        self.sources.is_empty() && !self.changes_mirrors()
    }

    /// The difference of the irradiance from lamps without a surface, as radiance of a white one.
    fn lamps(&self, point: &SurfacePoint, samples: u32, key: Key, rays: &mut RayCounts) -> Vec3 {
        let differences = self.sources.lamps.iter().zip(LAMP..).map(|(pair, dimension)| {
            let shift = key.with(dimension).pair();
            let mut light = |of: &Option<_>| {
                of.as_ref().map_or(Vec3::ZERO, |lamp| {
                    self.old.irradiance_of_light(lamp, point, samples, shift, rays)
                })
            };
            let [before, now] = [light(&pair[0]), light(&pair[1])];
            (now - before).abs()
        });
        differences.sum::<Vec3>() / PI
    }

    /// One path of the difference.
    fn sample(&self, point: &SurfacePoint, sequence: Sequence, sample: u32, rays: &mut RayCounts) -> Sample {
        let random = |stop: u32| {
            let first = SOURCE + 4 * stop;
            [sequence.pair(sample, first), sequence.pair(sample, first + 1)]
        };
        let mut shadow = RayCounts::default();
        let (emitted, reflected) = self.one_of_sources(point, random(0), &mut shadow);
        let reflected = if self.bounces > 0 { reflected } else { Vec3::ZERO };
        let mut found = Sample { direct: emitted, smooth: reflected };
        let scenes = [&**self.old.scene(), &*self.new];
        let mut stops = 0;
        let bounces = self.bounces;
        self.old.follow_path(point, (sequence, sample), (bounces, false, false), rays, |stop, share, _| {
            match stop {
                PathStop::Sky(direction) => {
                    let Some(skies) = &self.sources.skies else { return ControlFlow::Break(()) };
                    let [a, b] = [&skies[0], &skies[1]]
                        .map(|sky| sky.as_ref().map_or(Vec3::ZERO, |sky| sky.diffuse_radiance(*direction)));
                    let difference = share * (b - a).abs();
                    if bounces == 0 { found.direct += difference } else { found.smooth += difference }
                }
                PathStop::Lamp(_) => {}
                PathStop::Surface { point: next, length, was_reflected, .. } => {
                    stops += 1;
                    if let Some((radius, emission, reflection)) = self.sources.radiance_of(scenes, next)
                        && (*was_reflected || *length < NEAR * radius)
                    {
                        // A lamp in a mirror brings smooth light.
                        let is_lamp = stops == 1 && !was_reflected;
                        if is_lamp {
                            found.direct += share * emission
                        } else {
                            found.smooth += share * emission
                        }
                        found.smooth += share * reflection;
                    }
                    let (emitted, reflected) = self.one_of_sources(next, random(stops), &mut shadow);
                    let lamps = if self.sources.lamps.is_empty() {
                        Vec3::ZERO
                    } else {
                        self.lamps(next, 1, sequence.key(sample).with(stops), &mut shadow)
                    };
                    found.smooth += share * next.albedo(self.old.scene()) * (emitted + reflected + lamps);
                }
            }
            ControlFlow::Continue(())
        });
        *rays += shadow;
        found
    }

    /// One sample of the light that a surface point receives from a group of sources: what they
    /// emit, and what they reflect.
    fn one_of_sources(
        &self,
        point: &SurfacePoint,
        random: [[f32; 2]; 2],
        rays: &mut RayCounts,
    ) -> (Vec3, Vec3) {
        let none = (Vec3::ZERO, Vec3::ZERO);
        // Choose a group in proportion to its estimated light.
        let mut total = 0.0;
        let add = |source: &SourceGroup| {
            total += weight(source, point);
            total
        };
        let sums: ArrayVec<f32, MAX_GROUPS> = self.sources.groups.iter().map(add).take(MAX_GROUPS).collect();
        let chosen = sums.partition_point(|&sum| sum <= random[0][0] * total);
        let Some(source) = self.sources.groups.get(chosen) else { return none };
        let below = if chosen > 0 { sums[chosen - 1] } else { 0.0 };
        let probability = (sums[chosen] - below) / total;
        // Choose a point of it by area.
        let piece = source.group.piece(random[0][1]);
        let to = piece.point(random[1]) - point.position;
        let [from_point, from_piece] = [point.shading_normal.dot(to), -piece.normal.dot(to)];
        let distance2 = to.length_squared();
        let is_near = distance2 < (NEAR * source.group.radius).powi(2);
        if is_near || from_point <= 0.0 || from_piece <= 0.0 || point.geometric_normal.dot(to) <= 0.0 {
            return none;
        }
        let origin = point.origin_in_front();
        let ray = Ray::segment(origin, point.position + to);
        rays.shadow += 1;
        let passed = self.old.transmittance_along(&ray);
        let share = from_point * from_piece * source.group.area / (PI * distance2 * distance2 * probability);
        let light = passed * share;
        (light * source.emission, light * (source.radiance - source.emission))
    }
}

impl Difference for DifferenceLight {
    const SAMPLES: [u32; 2] = [4, 256];

    /// 0.4 seconds on two cores.
    const MAX_SAMPLES: u32 = 1 << 16;

    fn at(&self, point: &SurfacePoint, samples: u32, key: Key) -> DoubtSamples {
        let mut rays = RayCounts::default();
        let sequence = Sequence::of_key(key);
        let lamps = self.lamps(point, samples, key, &mut rays).max_element();
        let mut found = DoubtSamples::default();
        for sample in 0..samples {
            let one = self.sample(point, sequence, sample, &mut rays);
            found.direct += one.direct.max_element();
            found.add(one.smooth);
        }
        found.direct = lamps + found.direct / found.count.max(1.0);
        found
    }

    /// The own mean, or the mean around and its standard error on top, whichever is larger: few
    /// samples may miss a small source.
    fn doubt(own: &DoubtSamples, around: &DoubtSamples) -> Doubt {
        let (own, around) = (own.mean_plus(0.0), around.mean_plus(1.0));
        Doubt { direct: own.direct.max(around.direct), smooth: own.smooth.max(around.smooth) }
    }
}

/// Estimates the light of a group at a point, whatever is between.
fn weight(source: &SourceGroup, point: &SurfacePoint) -> f32 {
    let group = &source.group;
    let to = group.centre - point.position;
    let distance2 = to.length_squared().max(f32::MIN_POSITIVE);
    let cosine = (point.geometric_normal.dot(to) + group.radius) / distance2.sqrt();
    let cosines = cosine.clamp(0.0, 1.0) * group.cosine_towards(point.position);
    let near2 = (NEAR * group.radius).powi(2);
    source.radiance.max_element() * cosines * group.area / distance2.max(near2)
}
