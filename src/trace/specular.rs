//! The light a surface mirrors or lets through: it depends on the viewer and must be traced.
//!
//! Both branches of Fresnel's equations are followed, as Whitted did, but in a loop over a small stack instead of by
//! recursion, until a branch carries less than [`CUTOFF`].

use super::{SurfacePoint, Tracer};
use crate::math::Ray;
use crate::scene::MaterialKind;
use glam::Vec3;

/// A branch that carries a smaller share of the pixel is not followed.
pub const CUTOFF: f32 = 1.0 / 512.0;

/// Bounces after which a chain ends even where nothing is lost on the way.
pub const MAX_BOUNCES: u32 = 1024;

/// Branches that wait. With a loss of 1/512 a deeper stack never occurs unless surfaces lose nothing.
const STACK: usize = 24;

/// The radiance that [`CUTOFF`] can leave out of a chain of mirrors of reflectance `r` that sees radiance of at most
/// `brightest` at every bounce: the rest of the geometric series.
pub fn truncation_bound(r: f32, brightest: f32) -> f32 {
    if r < 1.0 { CUTOFF / (1.0 - r) * brightest } else { f32::INFINITY }
}

#[derive(Clone, Copy)]
struct Branch {
    ray: Ray,
    throughput: Vec3,
    bounces: u32,
    /// From the first surface to the ray's origin.
    length: f32,
}

/// How a surface was met by way of mirrors and glass.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// The share of the pixel that the surface is, 0..1.
    pub share: f32,
    /// A running number from one on; names the random numbers of its shading.
    pub number: u32,
    /// Length of the way from the first surface, scene units.
    pub length: f32,
}

/// The two continuations of light at a surface, each with the share it carries.
type Branches = [Option<(Ray, Vec3)>; 2];

impl Tracer {
    /// Follows every specular branch from `point`, seen along `direction`, and sums what `shade` returns for the
    /// surfaces and the sky they meet.
    ///
    /// Returns the radiance and the number of bounces of the longest branch; counts its rays in `secondary`.
    pub fn follow_specular(
        &self,
        point: &SurfacePoint,
        direction: Vec3,
        secondary: &mut u64,
        mut shade: impl FnMut(&SurfacePoint, Link) -> Vec3,
    ) -> (Vec3, u32) {
        let mut stack = BranchStack::new();
        stack.push_all(self.branches(point, direction), Vec3::ONE, 1, 0.0);
        let (mut radiance, mut longest, mut visited) = (Vec3::ZERO, 1, 0);
        while let Some(branch) = stack.pop() {
            *secondary += 1;
            longest = longest.max(branch.bounces);
            let Some(hit) = self.closest(&branch.ray) else {
                radiance += branch.throughput * self.sky(branch.ray.direction);
                continue;
            };
            let next = self.surface(&branch.ray, &hit);
            visited += 1;
            // Specular branches have directions of length one.
            let length = branch.length + hit.t;
            let link = Link { share: branch.throughput.max_element().min(1.0), number: visited, length };
            radiance += branch.throughput * shade(&next, link);
            let goes_on = self.scene().materials[next.material.0 as usize].is_specular();
            if goes_on && branch.bounces < MAX_BOUNCES {
                let onward = self.branches(&next, branch.ray.direction);
                stack.push_all(onward, branch.throughput, branch.bounces + 1, length);
            }
        }
        (radiance, longest)
    }

    /// One continuation, chosen with probability proportional to what it carries; `random` in [0, 1).
    pub(super) fn choose_branch(
        &self,
        point: &SurfacePoint,
        direction: Vec3,
        random: f32,
    ) -> Option<(Ray, Vec3)> {
        match self.branches(point, direction) {
            [Some(a), Some(b)] => {
                let (wa, wb) = (a.1.max_element(), b.1.max_element());
                let first = wa / (wa + wb);
                Some(if random < first { (a.0, a.1 / first) } else { (b.0, b.1 / (1.0 - first)) })
            }
            [a, b] => a.or(b),
        }
    }

    /// What all specular branches of a point carry together, at most about one.
    pub(super) fn specular_weight(&self, point: &SurfacePoint, direction: Vec3) -> f32 {
        self.branches(point, direction).iter().flatten().map(|(_, share)| share.max_element()).sum()
    }

    fn branches(&self, point: &SurfacePoint, direction: Vec3) -> Branches {
        let d = direction.normalize_or(Vec3::Y);
        match self.scene().materials[point.material.0 as usize].kind {
            MaterialKind::Diffuse => [None, None],
            MaterialKind::Mirror { reflectance, fresnel } => {
                let cos = point.shading_normal.dot(-d).clamp(0.0, 1.0);
                let rise = if fresnel { (1.0 - cos).powi(5) } else { 0.0 };
                let share = reflectance + (Vec3::ONE - reflectance) * rise;
                [Some((Ray::new(point.origin_in_front(), reflected(point, d)), share)), None]
            }
            MaterialKind::Glass { eta, transmittance } => match point.enters_solid(self.scene()) {
                None => thin_branches(point, d, eta, transmittance),
                Some(enters) => solid_branches(point, d, if enters { 1.0 / eta } else { eta }, transmittance),
            },
        }
    }
}

/// A sheet: light passes straight through, and the mirrored share includes what bounces between its two faces.
fn thin_branches(point: &SurfacePoint, d: Vec3, eta: f32, transmittance: Vec3) -> Branches {
    let single = fresnel_dielectric(point.shading_normal.dot(-d).clamp(0.0, 1.0), 1.0 / eta);
    let mirrored = thin_reflectance(single);
    [
        Some((Ray::new(point.origin_behind(), d), transmittance * (1.0 - mirrored))),
        (mirrored > 0.0)
            .then(|| (Ray::new(point.origin_in_front(), reflected(point, d)), Vec3::splat(mirrored))),
    ]
}

/// The share that a sheet mirrors, from the share that each of its faces does: the series of what bounces between them.
pub(super) fn thin_reflectance(single: f32) -> f32 {
    2.0 * single / (1.0 + single)
}

/// The face of a solid; `eta` is the index on the viewer's side over that on the other.
fn solid_branches(point: &SurfacePoint, d: Vec3, eta: f32, transmittance: Vec3) -> Branches {
    let mirrored = fresnel_dielectric(point.shading_normal.dot(-d).clamp(0.0, 1.0), eta);
    let through = (mirrored < 1.0)
        .then(|| refracted(point, d, eta))
        .map(|t| (Ray::new(point.origin_behind(), t), transmittance * (1.0 - mirrored)));
    let back = (mirrored > 0.0)
        .then(|| (Ray::new(point.origin_in_front(), reflected(point, d)), Vec3::splat(mirrored)));
    [through, back]
}

/// The mirrored direction. Where the interpolated normal would send it into the surface, the triangle's is used.
fn reflected(point: &SurfacePoint, d: Vec3) -> Vec3 {
    let about = |n: Vec3| d - n * (2.0 * d.dot(n));
    let r = about(point.shading_normal);
    if r.dot(point.geometric_normal) > 0.0 { r } else { about(point.geometric_normal) }
}

/// The refracted direction by Snell's law, the triangle's normal standing in where the interpolated one fails.
fn refracted(point: &SurfacePoint, d: Vec3, eta: f32) -> Vec3 {
    let about = |n: Vec3| {
        let cos = n.dot(-d);
        let sin2 = eta * eta * (1.0 - cos * cos).max(0.0);
        d * eta + n * (eta * cos - (1.0 - sin2).max(0.0).sqrt())
    };
    let t = about(point.shading_normal);
    if t.dot(point.geometric_normal) < 0.0 { t } else { about(point.geometric_normal) }
}

/// The share of unpolarised light mirrored by a dielectric; `eta` is the index on the side the light comes from over
/// that on the other side. One under total internal reflection.
pub fn fresnel_dielectric(cos: f32, eta: f32) -> f32 {
    // In f64: near the critical angle the difference loses what an f32 holds.
    let (cos_wide, eta_wide) = (f64::from(cos), f64::from(eta));
    let cos2_through = 1.0 - eta_wide * eta_wide * (1.0 - cos_wide * cos_wide).max(0.0);
    if cos2_through <= 0.0 {
        return 1.0;
    }
    let cos_through = cos2_through.sqrt() as f32;
    let parallel = (cos - eta * cos_through) / (cos + eta * cos_through);
    let perpendicular = (eta * cos - cos_through) / (eta * cos + cos_through);
    ((parallel * parallel + perpendicular * perpendicular) / 2.0).clamp(0.0, 1.0)
}

struct BranchStack {
    branches: [Branch; STACK],
    height: usize,
}

impl BranchStack {
    fn new() -> Self {
        let none =
            Branch { ray: Ray::new(Vec3::ZERO, Vec3::ZERO), throughput: Vec3::ZERO, bounces: 0, length: 0.0 };
        Self { branches: [none; STACK], height: 0 }
    }

    fn pop(&mut self) -> Option<Branch> {
        self.height = self.height.checked_sub(1)?;
        Some(self.branches[self.height])
    }

    /// Stacks what is worth following, the weaker branch on top, so that the stack stays low.
    fn push_all(&mut self, mut branches: Branches, throughput: Vec3, bounces: u32, length: f32) {
        let weight = |b: &Option<(Ray, Vec3)>| b.map_or(0.0, |(_, share)| share.max_element());
        if weight(&branches[0]) < weight(&branches[1]) {
            branches.swap(0, 1);
        }
        for (ray, share) in branches.into_iter().flatten() {
            let throughput = throughput * share;
            if throughput.max_element() >= CUTOFF && self.height < STACK {
                self.branches[self.height] = Branch { ray, throughput, bounces, length };
                self.height += 1;
            }
        }
    }
}
