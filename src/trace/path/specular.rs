//! The radiance that a surface reflects or lets through: it depends on the viewer and must be
//! traced.
//!
//! All branches are followed, as in Whitted, "An Improved Illumination Model for Shaded Display",
//! Communications of the ACM 23(6), 1980. We differ: a loop over a small stack takes the place of
//! recursion, and a branch ends once it carries less than [`CUTOFF`].

use super::dimension::{LOBE, SPECULAR};
use crate::bsdf::{Lobe, ScatterSet};
use crate::math::{Ray, key::Key};
use crate::trace::{SurfacePoint, Tracer};
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

/// A branch that waits to be followed.
#[derive(Clone, Copy)]
struct Branch {
    ray: Ray,
    throughput: Vec3,
    bounces: u32,
    /// Length of the path from the first surface to the ray's origin, scene units.
    length: f32,
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
    /// sums what `shade` returns for the surfaces, and the sky, that the branches meet.
    ///
    /// Returns the radiance and the number of bounces of the longest branch; adds the number of
    /// rays to `secondary`.
    pub fn follow_specular(
        &self,
        point: &SurfacePoint,
        direction: Vec3,
        key: Key,
        secondary: &mut u64,
        mut shade: impl FnMut(&SurfacePoint, PathVertex) -> Vec3,
    ) -> (Vec3, u32) {
        let mut pending = ArrayVec::<Branch, STACK>::new();
        let first =
            Branch { ray: Ray::new(Vec3::ZERO, direction), throughput: Vec3::ONE, bounces: 0, length: 0.0 };
        self.push_branches(&mut pending, point, &first, key);
        let (mut radiance, mut longest, mut visited) = (Vec3::ZERO, 1, 0);
        while let Some(mut branch) = pending.pop() {
            // Trace the branch to its next surface.
            *secondary += 1;
            longest = longest.max(branch.bounces);
            let Some(hit) = self.closest(&branch.ray) else {
                radiance += branch.throughput * self.sky(branch.ray.direction);
                continue;
            };
            let next = self.surface(&branch.ray, &hit);
            visited += 1;
            // Scattered directions are of unit length, so `t` is a distance.
            branch.length += hit.t;
            // Add the diffuse radiance of the surface.
            let share = branch.throughput.max_element().min(1.0);
            let vertex = PathVertex { share, key: key.with(SPECULAR + visited), length: branch.length };
            radiance += branch.throughput * shade(&next, vertex);
            // Continue from a surface that is itself viewer-dependent.
            if self.is_view_dependent(&next) && branch.bounces < MAX_BOUNCES {
                self.push_branches(&mut pending, &next, &branch, vertex.key);
            }
        }
        (radiance, longest)
    }

    /// Pushes the branches at `point` that are worth following, the weaker one on top, so that the
    /// stack stays low.
    fn push_branches(
        &self,
        pending: &mut ArrayVec<Branch, STACK>,
        point: &SurfacePoint,
        arriving: &Branch,
        key: Key,
    ) {
        for scatter in self.scatter(point, arriving.ray.direction, key).heaviest_first() {
            let throughput = arriving.throughput * scatter.weight;
            if throughput.max_element() >= CUTOFF && !pending.is_full() {
                let ray = point.scattered_ray(&scatter);
                pending.push(Branch { ray, throughput, bounces: arriving.bounces + 1, ..*arriving });
            }
        }
    }

    /// Samples the viewer-dependent lobe of a point seen along `direction` (any length).
    pub(super) fn scatter(&self, point: &SurfacePoint, direction: Vec3, key: Key) -> ScatterSet {
        let (facing, incident) = (point.facing(self.scene()), direction.normalize_or(Vec3::Y));
        let material = self.material(point);
        match material.gap_at(&self.scene().textures, || point.uv) {
            None => material.sample(&facing, incident, key.with(LOBE).pair()),
            Some(gap) => ScatterSet::split((gap > 0.0).then_some((incident, Vec3::splat(gap))), None),
        }
    }
}
