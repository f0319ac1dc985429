//! The radiance that a surface reflects or lets through: it depends on the viewer and must be
//! traced.
//!
//! All branches are followed, as in Whitted, "An Improved Illumination Model for Shaded Display",
//! Communications of the ACM 23(6), 1980. We differ: a loop over a small stack takes the place of
//! recursion, and a branch ends once it carries less than [`CUTOFF`]. A rough surface sends a fan
//! of rays, as many as its share of the pixel and the width of its lobe ask for, one after the
//! other.

use super::dimension::{LOBE, LOBE_LIGHT, LOBE_RAY, SPECULAR};
use super::rough_link::at_least_as_rough;
use crate::bsdf::{Lobe, Scatter, ScatterSet};
use crate::math::{Ray, key::Key, sampling::lattice, sequence::PointSeed};
use crate::scene::Material;
use crate::trace::lights::{LitLobe, LobeRay};
use crate::trace::{RayCounts, SurfacePoint, Tracer};
use arrayvec::ArrayVec;
use glam::Vec3;

/// Smallest share of the pixel (0..1) that a branch must carry to be followed.
const CUTOFF: f32 = 1.0 / 512.0;

/// Number of bounces after which a path ends even where its surfaces absorb nothing.
pub const MAX_BOUNCES: u32 = 1024;

/// Largest number of pending branches. With a loss of 1/512 a deeper stack never occurs unless
/// surfaces absorb nothing.
const STACK: usize = 24;

/// Returns a bound on the radiance that ending branches early can leave out.
///
/// The bound is for a chain of mirrors of reflectance `r` that sees radiance of at most `brightest`
/// at every bounce: the rest of the geometric series; infinite for `r` of one or more.
pub fn truncation_bound(r: f32, brightest: f32) -> f32 {
    if r < 1.0 { CUTOFF / (1.0 - r) * brightest } else { f32::INFINITY }
}

/// Number of rough surfaces whose rays wait for others.
const FANS: usize = 8;

/// Slope of the microfacets from which on a rough lobe takes all the rays that its share of the
/// pixel allows; a narrower one takes fewer, in proportion.
const WIDE_LOBE: f32 = 0.25;

/// Points on each light, and rays of a rough lobe, for each shadow ray.
const PER_SHADOW_RAY: u32 = 4;

/// A branch that waits to be followed.
#[derive(Clone, Copy)]
struct Branch {
    ray: Ray,
    throughput: Vec3,
    /// Share (0..1) of the throughput that this branch stands for, where rays of a rough lobe share
    /// it.
    split: f32,
    bounces: u32,
    /// Length of the path from the first surface to the ray's origin, scene units.
    length: f32,
    /// Largest roughness of the surfaces that the branch has left.
    roughness: f32,
    /// How the branch left the last rough surface; `None` where a mirror has reflected it since, or
    /// there was none.
    lobe: Option<LobeRay>,
}

/// Rays of a rough lobe that wait to be traced.
struct Fan {
    point: SurfacePoint,
    arriving: Branch,
    seed: PointSeed,
    next: u32,
    count: u32,
    /// Number of points on each light; zero where none are sampled.
    samples: u32,
}

/// The branches and the rays of rough lobes of one pixel that have not been traced yet.
struct Open {
    pending: ArrayVec<Branch, STACK>,
    fans: ArrayVec<Fan, FANS>,
    /// Samples of the pixel.
    samples: u32,
}

/// How a path by way of mirrors and glass reached a surface.
#[derive(Clone, Copy, Debug)]
pub struct PathVertex {
    /// Share of the pixel that the surface contributes, 0..1.
    pub share: f32,
    /// Key of the random numbers of the surface.
    pub key: Key,
    /// Length of the path from the first surface, scene units.
    pub length: f32,
}

impl Tracer {
    /// Follows every branch of the viewer-dependent light of `point`, seen along `direction`, and
    /// sums what `shade` returns for the surfaces, and the sky, that the branches meet, and what
    /// rough surfaces scatter straight from the lights.
    ///
    /// `samples` is the number of samples of the pixel, which bounds the rays of a rough lobe; with
    /// zero it takes one, and no lights are sampled. Returns the radiance and the number of bounces
    /// of the longest branch; adds the rays to `rays`.
    pub fn follow_specular(
        &self,
        point: &SurfacePoint,
        direction: Vec3,
        (seed, samples): (PointSeed, u32),
        rays: &mut RayCounts,
        mut shade: impl FnMut(&SurfacePoint, PathVertex) -> Vec3,
    ) -> (Vec3, u32) {
        let mut open = Open { pending: ArrayVec::new(), fans: ArrayVec::new(), samples };
        let first = Branch {
            ray: Ray::new(Vec3::ZERO, direction),
            throughput: Vec3::ONE,
            split: 1.0,
            bounces: 0,
            length: 0.0,
            roughness: 0.0,
            lobe: None,
        };
        let mut radiance = self.leave(&mut open, point, &first, seed, rays);
        let (mut longest, mut visited) = (1, 0);
        while let Some(mut branch) = self.next_branch(&mut open) {
            // Trace the branch to its next surface.
            rays.secondary += 1;
            longest = longest.max(branch.bounces);
            let share = branch.throughput * branch.split;
            let Some(hit) = self.closest_from_seen(&branch.ray) else {
                radiance += share * self.sky_along(&branch);
                continue;
            };
            let next = self.surface(&branch.ray, &hit);
            visited += 1;
            // Scattered directions are of unit length, so `t` is a distance.
            branch.length += hit.t;
            // Add the diffuse radiance of the surface.
            let vertex = PathVertex {
                share: share.max_element().min(1.0),
                key: seed.key.with(SPECULAR + visited),
                length: branch.length,
            };
            radiance += share * self.counted(&next, branch.lobe, shade(&next, vertex));
            // Continue from a surface that is itself viewer-dependent.
            if self.is_view_dependent(&next) && branch.bounces < MAX_BOUNCES {
                radiance += self.leave(&mut open, &next, &branch, vertex.key.into(), rays);
            }
        }
        (radiance, longest)
    }

    /// The sky at the end of a branch. Shadow rays bring its suns to rough surfaces.
    fn sky_along(&self, branch: &Branch) -> Vec3 {
        match branch.lobe {
            None => self.sky(branch.ray.direction),
            Some(_) => self.diffuse_sky(branch.ray.direction),
        }
    }

    /// The part of a surface's radiance that counts where a branch meets it: of a lamp, what points
    /// on it do not bring to the rough surface that the branch left.
    fn counted(&self, surface: &SurfacePoint, lobe: Option<LobeRay>, radiance: Vec3) -> Vec3 {
        let Some(lobe) = lobe else { return radiance };
        let emission = surface.emission(self.scene());
        if emission == Vec3::ZERO {
            return radiance;
        }
        emission * self.lamp_share(&lobe, surface) + (radiance - emission).max(Vec3::ZERO)
    }

    /// Pushes the branches that leave `point` and are worth following. Returns what a rough surface
    /// scatters straight from the lights, as a part of the pixel.
    fn leave(
        &self,
        open: &mut Open,
        point: &SurfacePoint,
        arriving: &Branch,
        seed: PointSeed,
        rays: &mut RayCounts,
    ) -> Vec3 {
        let material = &*at_least_as_rough(self.material(point), arriving.roughness);
        if material.is_specular() {
            self.push_branches(open, point, arriving, seed.key);
            return Vec3::ZERO;
        }
        let (facing, incident) = (point.facing(self.scene()), arriving.ray.direction.normalize_or(Vec3::Y));
        let share = (arriving.throughput * arriving.split).max_element().min(1.0);
        // A narrow lobe sees little of the scene, and a weak one adds little to the pixel.
        let of_lobe = share * material.total(&facing, incident) * (material.width() / WIDE_LOBE).min(1.0);
        let samples_for = |share: f32| (open.samples as f32 * share).ceil().max(1.0) as u32;
        // From inside a solid, lamps are found by rays alone: shadow rays would leave it straight.
        let is_lit = open.samples > 0 && facing.enters_solid != Some(false);
        let count = if open.fans.is_full() { 1 } else { samples_for(of_lobe) };
        let samples = if is_lit { samples_for(share) } else { 0 };
        let fan = Fan { point: *point, arriving: *arriving, seed, next: 0, count, samples };
        if count == 1 {
            self.push_of_fan(open, &fan);
        } else {
            open.fans.push(fan);
        }
        if !is_lit {
            return Vec3::ZERO;
        }
        let shadow_rays = count.max(samples / PER_SHADOW_RAY);
        let lobe = LitLobe { material, facing: &facing, incident, lobe_rays: count, samples, shadow_rays };
        let lit = self.lit_lobe(point, &lobe, arriving.lobe.is_none(), seed.key, rays);
        arriving.throughput * arriving.split * lit
    }

    /// What a rough surface scatters straight from the lights in front of it and, through a sheet
    /// of frosted glass, from those behind it.
    fn lit_lobe(
        &self,
        point: &SurfacePoint,
        lobe: &LitLobe<'_>,
        sees_behind: bool,
        key: Key,
        rays: &mut RayCounts,
    ) -> Vec3 {
        let mut radiance = Vec3::ZERO;
        let mut add = |_, light| radiance += light;
        let key = key.with(LOBE_LIGHT);
        self.light_of_lobe(point, lobe, |light| key.with(light).pair(), rays, &mut add);
        let is_sheet = lobe.material.is_frosted() && lobe.facing.enters_solid.is_none();
        if is_sheet && sees_behind {
            let behind = key.with(LOBE_LIGHT);
            self.light_of_lobe(&point.far_side(), lobe, |light| behind.with(light).pair(), rays, add);
        }
        radiance
    }

    /// The next branch to follow.
    fn next_branch(&self, open: &mut Open) -> Option<Branch> {
        loop {
            if let Some(branch) = open.pending.pop() {
                return Some(branch);
            }
            let mut fan = open.fans.pop()?;
            self.push_of_fan(open, &fan);
            fan.next += 1;
            if fan.next < fan.count {
                open.fans.push(fan);
            }
        }
    }

    /// Pushes the branches of one ray of a rough lobe.
    fn push_of_fan(&self, open: &mut Open, fan: &Fan) {
        let Fan { point, arriving, seed, next, count, samples } = fan;
        let random = if arriving.bounces == 0 {
            seed.sequence.pair(*next, LOBE_RAY)
        } else {
            lattice(*next, *count, seed.key.with(LOBE).pair())
        };
        let (facing, incident) = (point.facing(self.scene()), arriving.ray.direction.normalize_or(Vec3::Y));
        let material = at_least_as_rough(self.material(point), arriving.roughness);
        let roughness = arriving.roughness.max(material.width().sqrt());
        for scatter in material.sample(&facing, incident, random).heaviest_first() {
            let density = material.pdf(&facing, incident, scatter.direction) * *count as f32;
            let own =
                (*samples > 0).then_some(LobeRay { position: point.position, density, samples: *samples });
            let lobe = match (scatter.is_transmitted, facing.enters_solid, arriving.lobe) {
                (false, ..) | (true, None, None) => own,
                // As through clear glass: shadow rays of the last rough surface pass straight.
                (true, _, last) => last,
            };
            let of_ray = Branch { split: arriving.split / *count as f32, lobe, roughness, ..*arriving };
            push(open, point, &of_ray, scatter);
        }
    }

    /// Pushes the branches at `point` that are worth following, the weaker one on top, so that the
    /// stack stays low.
    fn push_branches(&self, open: &mut Open, point: &SurfacePoint, arriving: &Branch, key: Key) {
        for scatter in self.scatter(point, arriving.ray.direction, key).heaviest_first() {
            let lobe = arriving.lobe.filter(|_| scatter.is_transmitted);
            push(open, point, &Branch { lobe, ..*arriving }, scatter);
        }
    }

    /// Samples the viewer-dependent lobe of a point seen along `direction` (any length).
    pub(super) fn scatter(&self, point: &SurfacePoint, direction: Vec3, key: Key) -> ScatterSet {
        self.scatter_of(&self.material(point), point, direction, key)
    }

    /// [`Self::scatter`] with another material.
    pub(super) fn scatter_of(
        &self,
        material: &Material,
        point: &SurfacePoint,
        direction: Vec3,
        key: Key,
    ) -> ScatterSet {
        let (facing, incident) = (point.facing(self.scene()), direction.normalize_or(Vec3::Y));
        match material.gap_at(&self.scene().textures, || point.uv) {
            None => material.sample(&facing, incident, key.with(LOBE).pair()),
            Some(gap) => ScatterSet::split((gap > 0.0).then_some((incident, Vec3::splat(gap))), None),
        }
    }
}

/// Pushes a branch that continues where another one arrived, if it is worth following.
fn push(open: &mut Open, point: &SurfacePoint, arriving: &Branch, scatter: Scatter) {
    let throughput = arriving.throughput * scatter.weight;
    if throughput.max_element() >= CUTOFF && !open.pending.is_full() {
        let ray = point.scattered_ray(&scatter);
        open.pending.push(Branch { ray, throughput, bounces: arriving.bounces + 1, ..*arriving });
    }
}
