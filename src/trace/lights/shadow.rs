//! The share of light that passes along shadow rays.

use crate::bsdf::Lobe;
use crate::math::Ray;
use crate::trace::Tracer;
use crate::trace::bvh::{BUNDLE_RAYS, Bits, Hit, Judge, LANES, MIN_RAYS, Occluder, RayBundle};
use glam::Vec3;

/// What passes along the rays of a bundle.
struct Passage<'a> {
    tracer: &'a Tracer,
    bundle: &'a RayBundle,
    /// The share of light, 0..1 per channel, that the glass met so far lets through.
    passed: &'a mut [Vec3; BUNDLE_RAYS],
}

impl Judge for Passage<'_> {
    #[inline(always)]
    fn accepts(&mut self, ray: usize, hit: &Hit) -> bool {
        self.tracer.blocks(&self.bundle.ray(ray), hit, &mut self.passed[ray])
    }

    /// Glass multiplies its shares into those of all rays at once, with the bits of
    /// [`Tracer::blocks`]: in a glass case a sixth of all time went into single ones.
    #[inline(always)]
    fn lets_pass(&mut self, triangle: u32, first: usize, met: u32) -> bool {
        let scene = self.tracer.scene();
        let passage = || {
            let [a, b, c] = scene.corners(triangle);
            let n = (b - a).cross(c - a);
            (cosines(n, self.bundle.directions(), first), scene.solids[triangle as usize])
        };
        let material = scene.material_of(triangle);
        // What such surfaces let through differs from ray to ray.
        if material.coverage_texture.is_some() || material.detail.transmission_texture.is_some() {
            return false;
        }
        let Some(shares) = material.straight_transmittances(passage) else { return false };
        for ray in Bits(met) {
            self.passed[first + ray] *= shares[ray];
        }
        true
    }
}

/// The cosines, 0..1, between a normal and eight directions from index `first` on; neither has unit
/// length.
#[inline(always)]
fn cosines(n: Vec3, [dx, dy, dz]: &[[f32; BUNDLE_RAYS]; 3], first: usize) -> [f32; LANES] {
    let (length, mut cosines) = (n.length(), [0.0; LANES]);
    let [dx, dy, dz] = [&dx[first..][..LANES], &dy[first..][..LANES], &dz[first..][..LANES]];
    for ray in 0..LANES {
        let (x, y, z) = (dx[ray], dy[ray], dz[ray]);
        let along = n.x * x + n.y * y + n.z * z;
        let cos = along.abs() / (length * (x * x + y * y + z * z).sqrt());
        cosines[ray] = cos.min(1.0);
    }
    cosines
}

impl Tracer {
    /// Writes the share of light (0..1 per channel) that passes along each ray of a bundle.
    ///
    /// It equals [`Self::transmittance`] of each ray; behind several sheets of glass the last bit
    /// may differ.
    pub fn transmittances(&self, bundle: &RayBundle, passed: &mut [Vec3; BUNDLE_RAYS]) {
        // Trace a few rays one at a time.
        if bundle.len() < MIN_RAYS {
            let mut occluder = Occluder::default();
            for (passed, ray) in passed.iter_mut().zip(bundle.rays()) {
                *passed = self.transmittance(&ray, &mut occluder);
            }
            return;
        }
        // Trace all rays at once; glass multiplies its share into `passed` on the way.
        passed.fill(Vec3::ONE);
        let blocked = if self.is_any_hit_a_block() {
            self.bvh().any_at_all_in_bundle(bundle)
        } else {
            self.bvh().any_in_bundle(bundle, Passage { tracer: self, bundle, passed })
        };
        // Nothing passes along a blocked ray.
        for (ray, passed) in passed.iter_mut().enumerate().take(bundle.len()) {
            *passed = if blocked >> ray & 1 == 1 { Vec3::ZERO } else { *passed };
        }
    }

    /// Returns the share of light (0..1 per channel) that passes along a shadow ray.
    ///
    /// Glass does not block: each of its surfaces multiplies by the share that it lets through, and
    /// does not bend the ray. So windows light their room, and caustics are left out. Rays towards
    /// one light from one point share `occluder`; with three sheets of glass in a row it may decide
    /// the order in which their shares are multiplied.
    pub fn transmittance(&self, ray: &Ray, occluder: &mut Occluder) -> Vec3 {
        if self.is_any_hit_a_block() {
            return if self.bvh().any_near(ray, occluder, |_| true) { Vec3::ZERO } else { Vec3::ONE };
        }
        let mut passed = Vec3::ONE;
        let blocked = self.bvh().any_near(ray, occluder, |hit| self.blocks(ray, hit, &mut passed));
        if blocked { Vec3::ZERO } else { passed }
    }

    /// Returns the share of light (0..1 per channel) that passes along a single shadow ray.
    pub(crate) fn transmittance_along(&self, ray: &Ray) -> Vec3 {
        self.transmittance(ray, &mut Occluder::default())
    }

    /// True where two points, each with the normal of its surface, see each other from above their
    /// surfaces by the share `lift` of the distance between them. Glass does not hide.
    pub fn see_each_other(&self, a: (Vec3, Vec3), b: (Vec3, Vec3), lift: f32) -> bool {
        let height = lift * a.0.distance(b.0);
        if height == 0.0 {
            return true;
        }
        let [from, to] = [a, b].map(|(position, normal)| position + normal * height);
        let ray = Ray { t_max: 1.0, ..Ray::new(from, to - from) };
        self.transmittance(&ray, &mut Occluder::default()) != Vec3::ZERO
    }

    /// True where every surface that a ray meets blocks it.
    fn is_any_hit_a_block(&self) -> bool {
        let features = self.scene().features;
        !features.alpha && !features.needles && !features.glass
    }

    /// True where a surface lets nothing through; otherwise multiplies `passed` by its share.
    #[inline(always)]
    fn blocks(&self, ray: &Ray, hit: &Hit, passed: &mut Vec3) -> bool {
        let scene = self.scene();
        let passage = || {
            let [a, b, c] = scene.corners(hit.triangle);
            let n = (b - a).cross(c - a);
            let cos = (n.dot(ray.direction).abs() / (n.length() * ray.direction.length())).min(1.0);
            (cos, scene.solids[hit.triangle as usize])
        };
        let material = scene.material_of(hit.triangle);
        if let Some(gap) = material.gap_at(&scene.textures, || self.uv(hit)) {
            *passed *= gap;
            return false;
        }
        let found = match material.detail.transmission_texture {
            None => material.straight_transmittance(passage),
            Some(_) => material.at(&scene.textures, || self.uv(hit)).straight_transmittance(passage),
        };
        match found {
            Some(share) => {
                *passed *= share;
                false
            }
            None => self.blocks_light(ray, hit),
        }
    }
}
