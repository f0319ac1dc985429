//! The light of a point by groups of lights: light is linear in what the lights emit, so one set of
//! rays brings the light of every group.

use super::bounces::{PathStop, kinds_at_vertex};
use super::cached_light::Reader;
use super::diffuse::kinds_of;
use super::dimension::LIGHT;
use crate::bsdf::Diffuse;
use crate::math::sequence::{PointSeed, Sequence};
use crate::scene::{LightGroupKind, MAX_LIGHT_GROUPS};
use crate::trace::lights::GroupLight;
use crate::trace::{RayCounts, SurfacePoint, TraceSettings, Tracer};
use glam::Vec3;
use std::ops::ControlFlow;

/// Light by groups that is known at the surfaces which bounce rays meet.
pub(crate) trait CachedGroups: Sync {
    /// Returns all light of each group that arrives at a point, as the radiance of a white surface;
    /// `None` where the path must be traced on.
    fn groups_at(&self, tracer: &Tracer, point: &SurfacePoint, reader: &Reader) -> Option<GroupLight>;
}

/// How light is traced by groups.
#[derive(Clone, Copy)]
pub(crate) struct GroupSettings<'a> {
    /// Samples and bounces.
    pub(crate) trace: TraceSettings,
    /// Where paths may end; `None` traces them on.
    pub(crate) cache: Option<&'a dyn CachedGroups>,
    /// Size of the pixel on the surface, scene units.
    pub(crate) footprint: f32,
    /// True where shadow rays at the point leave near lamps to the paths.
    pub(crate) finds_near: bool,
}

/// Light of each group at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GroupSamples {
    /// Light straight from the lights, as the radiance of a white surface.
    pub(crate) direct: GroupLight,
    /// Sums of the paths with even and with odd numbers, as radiance of a white surface.
    pub(crate) smooth: [[Vec3; 2]; MAX_LIGHT_GROUPS],
    /// Number of paths.
    pub(crate) paths: u32,
}

impl Tracer {
    /// Returns the light of each group at a point, by the rays of
    /// [`light_of_samples`](Self::light_of_samples): their sum is its light, but for cells and
    /// rounding. At a black surface it is zero.
    pub(crate) fn light_by_group(
        &self,
        point: &SurfacePoint,
        settings: &GroupSettings<'_>,
        seed: PointSeed,
        rays: &mut RayCounts,
    ) -> GroupSamples {
        let mut light = GroupSamples::default();
        if point.is_black(self.scene()) {
            return light;
        }
        let (trace, shift) = (&settings.trace, |light| seed.key.with(light).pair());
        let to = (&mut *rays, &mut light.direct);
        self.add_irradiance_by_group(kinds_of(trace), point, trace.samples, shift, to);
        light.direct = light.direct.map(|irradiance| Diffuse::WHITE.radiance(irradiance));
        if trace.bounces > 0 {
            light.paths = trace.samples;
            for sample in 0..trace.samples {
                let path = self.path_by_group(point, (seed.sequence, sample), settings, rays);
                for (sums, radiance) in light.smooth.iter_mut().zip(path) {
                    sums[(sample & 1) as usize] += radiance;
                }
            }
        }
        light
    }

    /// Returns the smooth light that one path of a point brings from each group, as radiance of a
    /// white surface.
    pub(crate) fn path_by_group(
        &self,
        start: &SurfacePoint,
        (sequence, sample): (Sequence, u32),
        settings: &GroupSettings<'_>,
        rays: &mut RayCounts,
    ) -> GroupLight {
        let groups = &self.scene().light_groups;
        let mut radiance = GroupLight::default();
        let mut add = |group: Option<usize>, light: Vec3| {
            if let Some(sum) = group.and_then(|group| radiance.get_mut(group)) {
                *sum += light;
            }
        };
        let (sky, mut bounce) = (groups.of_kind(LightGroupKind::Sky), 0);
        let of = (sequence, sample);
        let bounces = settings.trace.bounces;
        self.follow_path(start, of, (bounces, true, settings.finds_near), rays, |stop, share, rays| {
            let (point, length, emission_share) = match *stop {
                PathStop::Surface { point, length, emission_share, .. } => (point, length, emission_share),
                PathStop::Lamp(light) => {
                    let group = groups.of_light.get(light as usize);
                    add(group.map(|&group| usize::from(group)), share);
                    return ControlFlow::Continue(());
                }
                PathStop::Sky(direction) => {
                    add(sky, share * self.diffuse_sky(direction));
                    return ControlFlow::Break(());
                }
            };
            // No shadow ray finds a light by way of a mirror, so its emission counts here.
            if emission_share > 0.0 {
                let group = groups.of_material.get(point.material.0 as usize);
                let emission = point.emission(self.scene()) * emission_share;
                add(group.map(|&group| usize::from(group)), share * emission);
            }
            let share = share * point.albedo(self.scene());
            if share.max_element() <= 0.0 {
                return ControlFlow::Break(());
            }
            // End in light that is known there, or add what arrives there straight from the lights.
            if bounce == 0
                && let Some(cache) = settings.cache
                && let Some(light) = cache.groups_at(self, &point, &settings.reader(length))
            {
                (0..).zip(light).for_each(|(group, light)| add(Some(group), share * light));
                return ControlFlow::Break(());
            }
            let first = LIGHT + (bounce << 16);
            let shift = |light| sequence.pair(sample, first.wrapping_add(light));
            let mut irradiance = GroupLight::default();
            let kinds = kinds_at_vertex(bounce, bounces);
            self.add_irradiance_by_group(kinds, &point, 1, shift, (rays, &mut irradiance));
            for (group, irradiance) in (0..).zip(irradiance) {
                add(Some(group), Diffuse { albedo: share }.radiance(irradiance));
            }
            bounce += 1;
            ControlFlow::Continue(())
        });
        radiance
    }
}

impl GroupSettings<'_> {
    fn reader(&self, length: f32) -> Reader {
        Reader { length, footprint: self.footprint, samples: self.trace.samples }
    }
}
