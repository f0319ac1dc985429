//! What passes along shadow rays.

use crate::math::Ray;
use crate::scene::{MaterialKind, SolidSide};
use crate::trace::Tracer;
use crate::trace::bvh::{BUNDLE_RAYS, Hit, MIN_RAYS, Occluder, RayBundle};
use glam::Vec3;

impl Tracer {
    /// The share of light that passes along each ray of a bundle, per channel: what [`Self::transmittance`] tells of it, behind several
    /// sheets of glass to the last bit.
    pub fn transmittances(&self, bundle: &RayBundle, passed: &mut [Vec3; BUNDLE_RAYS]) {
        if bundle.len() < MIN_RAYS {
            let mut occluder = Occluder::default();
            for (passed, ray) in passed.iter_mut().zip(bundle.rays()) {
                *passed = self.transmittance(&ray, &mut occluder);
            }
            return;
        }
        passed.fill(Vec3::ONE);
        let blocked = if self.is_any_hit_a_block() {
            self.bvh().any_at_all_in_bundle(bundle)
        } else {
            self.bvh().any_in_bundle(bundle, |ray, hit| self.blocks(&bundle.ray(ray), hit, &mut passed[ray]))
        };
        for (ray, passed) in passed.iter_mut().enumerate().take(bundle.len()) {
            *passed = if blocked >> ray & 1 == 1 { Vec3::ZERO } else { *passed };
        }
    }

    /// The share of light that passes along a shadow ray, per channel.
    ///
    /// Glass does not block: it dims by what each of its surfaces lets through, without bending the ray. Caustics are
    /// left out and windows light their room. `occluder` is shared by rays towards one light from one point; with three
    /// sheets of glass in a row it may decide in which order they are multiplied.
    pub fn transmittance(&self, ray: &Ray, occluder: &mut Occluder) -> Vec3 {
        if self.is_any_hit_a_block() {
            return if self.bvh().any_near(ray, occluder, |_| true) { Vec3::ZERO } else { Vec3::ONE };
        }
        let mut passed = Vec3::ONE;
        let blocked = self.bvh().any_near(ray, occluder, |hit| self.blocks(ray, hit, &mut passed));
        if blocked { Vec3::ZERO } else { passed }
    }

    fn is_any_hit_a_block(&self) -> bool {
        let features = self.scene().features;
        !features.checks_hits() && !features.glass
    }

    /// True where a surface lets nothing through; else `passed` is dimmed by what it keeps.
    #[inline(always)]
    fn blocks(&self, ray: &Ray, hit: &Hit, passed: &mut Vec3) -> bool {
        match self.scene().material_of(hit.triangle).kind {
            MaterialKind::Glass { eta, transmittance } => {
                *passed *= transmittance * self.straight_passage(ray, hit, eta);
                false
            }
            _ => self.stands(ray, hit),
        }
    }

    /// The share of light that Fresnel's equations let through one surface of glass.
    fn straight_passage(&self, ray: &Ray, hit: &Hit, eta: f32) -> f32 {
        let [a, b, c] = self.scene().corners(hit.triangle);
        let n = (b - a).cross(c - a);
        let cos = (n.dot(ray.direction).abs() / (n.length() * ray.direction.length())).min(1.0);
        let mirrored = crate::trace::specular::fresnel_dielectric(cos, 1.0 / eta);
        match self.scene().solids[hit.triangle as usize] {
            SolidSide::Thin => 1.0 - crate::trace::specular::thin_reflectance(mirrored),
            _ => 1.0 - mirrored,
        }
    }
}
