//! How surfaces scatter light: the only code that samples or evaluates a lobe.
//!
//! A material scatters light by a diffuse lobe ([`Diffuse`]), whose radiance does not depend on the
//! viewer and which references therefore store, and by at most one lobe that depends on the viewer,
//! which [`MaterialKind`] names. As a [`Lobe`], a [`Material`] is that second lobe.
//!
//! Paths are followed from the eye. `incident` is the unit direction of travel towards the surface,
//! `scattered` the unit direction in which the path continues, both in scene space. Values are per
//! steradian and do not include the cosine; densities are per steradian.
//!
//! `docs/how_to_add/bsdf.md` in the repository lists the steps for a new lobe.

mod dielectric;
mod diffuse;
mod energy;
mod frosted;
mod ggx;
mod glossy;
mod lobe;
mod local;
mod mirror;
mod scatter;

pub use dielectric::fresnel_dielectric;
pub use diffuse::{Diffuse, albedo};
pub use lobe::{Facing, Lobe};
pub use scatter::{Scatter, ScatterSet};

use crate::scene::{Material, MaterialKind, SolidSide};
use glam::Vec3;
use {
    dielectric::Dielectric, dielectric::of_sheet, frosted::Frosted, glossy::Glossy, lobe::NoLobe,
    mirror::Mirror,
};

/// Evaluates an expression with the lobe that a material's kind names. A new lobe is one line here.
macro_rules! with_lobe {
    ($material:expr, $lobe:ident => $result:expr) => {
        match $material.kind {
            MaterialKind::Diffuse => with_lobe!($lobe = NoLobe => $result),
            MaterialKind::Mirror { reflectance, fresnel } => with_lobe!($lobe = Mirror { reflectance, fresnel } => $result),
            MaterialKind::Glass { eta, transmittance } => with_lobe!($lobe = Dielectric { eta, transmittance } => $result),
            MaterialKind::Glossy { reflectance, roughness } => with_lobe!($lobe = Glossy { reflectance, roughness } => $result),
            MaterialKind::Frosted { eta, transmittance, roughness } => {
                with_lobe!($lobe = Frosted { clear: Dielectric { eta, transmittance }, roughness } => $result)
            }
        }
    };
    ($lobe:ident = $value:expr => $result:expr) => {{
        let $lobe = $value;
        $result
    }};
}

impl Lobe for Material {
    #[inline]
    fn sample(&self, facing: &Facing, incident: Vec3, random: [f32; 2]) -> ScatterSet {
        with_lobe!(self, lobe => lobe.sample(facing, incident, random))
    }

    fn evaluate(&self, facing: &Facing, incident: Vec3, scattered: Vec3) -> Vec3 {
        with_lobe!(self, lobe => lobe.evaluate(facing, incident, scattered))
    }

    fn pdf(&self, facing: &Facing, incident: Vec3, scattered: Vec3) -> f32 {
        with_lobe!(self, lobe => lobe.pdf(facing, incident, scattered))
    }

    fn is_specular(&self) -> bool {
        with_lobe!(self, lobe => lobe.is_specular())
    }

    fn width(&self) -> f32 {
        with_lobe!(self, lobe => lobe.width())
    }

    fn total(&self, facing: &Facing, incident: Vec3) -> f32 {
        with_lobe!(self, lobe => lobe.total(facing, incident))
    }

    #[inline(always)]
    fn straight_transmittance(&self, passage: impl FnOnce() -> (f32, SolidSide)) -> Option<Vec3> {
        with_lobe!(self, lobe => lobe.straight_transmittance(passage))
    }

    #[inline(always)]
    fn straight_transmittances(&self, passage: impl FnOnce() -> ([f32; 8], SolidSide)) -> Option<[Vec3; 8]> {
        with_lobe!(self, lobe => lobe.straight_transmittances(passage))
    }
}

/// Returns the share (0..1) of its light that the diffuse part of a material sends to a viewer, who
/// sees the shading normal at a cosine (0..1): all of it, but for what a clear coat reflects, or an
/// open sheet of glass that transmits in places only.
pub fn base_share(material: &Material, cos: f32) -> f32 {
    match material.kind {
        MaterialKind::Glossy { reflectance, roughness } => glossy::base_share(reflectance, roughness, cos),
        MaterialKind::Glass { eta, .. } => 1.0 - of_sheet(fresnel_dielectric(cos, 1.0 / eta)),
        MaterialKind::Frosted { eta, transmittance, roughness } => {
            Frosted { clear: Dielectric { eta, transmittance }, roughness }.base_share(cos)
        }
        MaterialKind::Diffuse | MaterialKind::Mirror { .. } => 1.0,
    }
}

/// Returns the cosine (0..1) at which a viewer sees the specular part of a material: to the shading
/// normal, or to the triangle's where a lobe is computed about that.
pub fn lobe_cosine(material: &Material, facing: &Facing, incident: Vec3) -> f32 {
    if material.is_specular() { facing.cosine(incident) } else { local::cosine(facing, incident) }
}
