//! The diffuse radiance of a surface: the part that does not depend on the viewer, so that a
//! reference image can provide it to other views.

use crate::bsdf::Diffuse;
use crate::math::key::Key;
use crate::trace::{RayCounts, SurfacePoint, TraceSettings, Tracer};
use glam::Vec3;

impl Tracer {
    /// Returns the emitted plus diffusely reflected radiance of a surface point, on the viewer's
    /// side.
    ///
    /// `share` (0..1) is how much of the pixel the point covers: shadow rays are spent in
    /// proportion, at least one per light.
    pub fn diffuse_radiance(
        &self,
        point: &SurfacePoint,
        share: f32,
        settings: &TraceSettings,
        key: Key,
        rays: &mut RayCounts,
    ) -> Vec3 {
        self.diffuse_radiance_and_light(point, share, settings, key, rays)[0]
    }

    /// Returns [`Self::diffuse_radiance`] and the arriving light as the radiance of a white
    /// surface, which references store. For a black surface no ray is traced, and its light is
    /// zero.
    pub(crate) fn diffuse_radiance_and_light(
        &self,
        point: &SurfacePoint,
        share: f32,
        settings: &TraceSettings,
        key: Key,
        rays: &mut RayCounts,
    ) -> [Vec3; 2] {
        let emission = self.material(point).emission;
        let albedo = point.albedo(self.scene());
        if albedo == Vec3::ZERO {
            return [emission, Vec3::ZERO];
        }
        let samples = settings.samples_for(share);
        let mut irradiance = self.irradiance(point, samples, key, rays);
        if settings.bounces > 0 {
            irradiance += self.indirect_irradiance(point, samples, settings.bounces, key, rays);
        }
        [emission + Diffuse { albedo }.radiance(irradiance), Diffuse::WHITE.radiance(irradiance)]
    }
}
