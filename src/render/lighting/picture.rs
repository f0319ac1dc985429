//! The light that arrives at the surfaces of a view, without their colours.

use super::surfaces::SeenSurfaces;
use crate::camera::Camera;
use crate::raster::color::luminance;
use crate::reference::ReferenceFrame;
use crate::scene::Scene;
use crate::trace::{NO_TRIANGLE, TraceSettings, Tracer, parallel::Stop};
use glam::Vec3;
use std::f32::consts::PI;
use std::sync::Arc;

/// The light that arrives at what each pixel of a view sees.
#[derive(Clone, Debug)]
pub struct SurfaceLight {
    /// Radiance of a white surface there, row-major, linear Rec. 709; NaN where a pixel sees the
    /// sky, or a surface without a diffuse part, such as a mirror.
    pub light: Vec<Vec3>,
    /// The reference that holds the light.
    pub reference: Arc<ReferenceFrame>,
}

impl SurfaceLight {
    /// Traces the light of a view. Smooth light is shared between neighbours, as in a reference.
    /// `None` after a stop.
    pub fn trace(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        trace: &TraceSettings,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let reference = ReferenceFrame::trace_filtered(tracer, camera, size, trace, stop)?;
        let has_base =
            |triangle: u32| triangle != NO_TRIANGLE && tracer.scene().material_of(triangle).has_base();
        let of_pixel = |pixel: u32| {
            let is_known = reference.has_light(pixel) && has_base(reference.triangle()[pixel as usize]);
            if is_known { reference.light(pixel) } else { Vec3::NAN }
        };
        let light = (0..size[0] * size[1]).map(of_pixel).collect();
        Some(Self { light, reference: Arc::new(reference) })
    }

    /// The surfaces of the pixels.
    pub fn surfaces<'a>(&'a self, scene: &'a Scene) -> SeenSurfaces<'a> {
        let reference = &self.reference;
        SeenSurfaces {
            scene,
            view: &reference.view,
            triangle: reference.triangle(),
            disparity: reference.disparity(),
        }
    }

    /// Returns the illuminance of each pixel's surface in lux; NaN where there is none.
    /// `nits_per_unit` is [`Scene::nits_per_unit`](crate::Scene::nits_per_unit).
    pub fn lux(&self, nits_per_unit: f32) -> Vec<f32> {
        self.light.iter().map(|light| luminance(*light) * PI * nits_per_unit).collect()
    }
}
