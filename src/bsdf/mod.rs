//! How surfaces scatter light: the only code that samples or evaluates a lobe.
//!
//! A material scatters light by a diffuse lobe ([`Diffuse`]), whose radiance does not depend on the
//! viewer and which references therefore store, and by at most one lobe that depends on the viewer,
//! which [`MaterialKind`] names. [`Bsdf`] is that second lobe at one surface point.
//!
//! Paths are followed from the eye. `incident` is the unit direction of travel towards the surface,
//! `scattered` the unit direction in which the path continues, both in scene space. Values are per
//! steradian and do not include the cosine; densities are per steradian.
//!
//! `docs/how_to_add_bsdf.md` in the repository lists the steps for a new lobe.

mod dielectric;
mod diffuse;
mod lobe;
mod mirror;
mod scatter;
#[cfg(test)]
mod tests;

pub use dielectric::fresnel_dielectric;
pub use diffuse::{Diffuse, albedo};
pub use lobe::{Facing, Lobe};
pub use scatter::{Scatter, ScatterSet};

use crate::scene::{Material, MaterialKind, SolidSide};
use dielectric::Dielectric;
use glam::Vec3;
use lobe::NoLobe;
use mirror::Mirror;

/// The viewer-dependent lobe of a material at one surface point.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf<'a> {
    /// The material, of which only the kind is used.
    pub material: &'a Material,
    /// The side of the surface that the path arrives on.
    pub facing: Facing,
}

/// Evaluates an expression with the lobe that a material's kind names. A new lobe is one line here.
macro_rules! with_lobe {
    ($material:expr, $lobe:ident => $result:expr) => {
        match $material.kind {
            MaterialKind::Diffuse => {
                let $lobe = NoLobe;
                $result
            }
            MaterialKind::Mirror { reflectance, fresnel } => {
                let $lobe = Mirror { reflectance, fresnel };
                $result
            }
            MaterialKind::Glass { eta, transmittance } => {
                let $lobe = Dielectric { eta, transmittance };
                $result
            }
        }
    };
}

impl Bsdf<'_> {
    /// Returns the directions in which a path continues; `random` is a point of the unit square.
    ///
    /// A specular lobe returns all its directions and ignores `random`; another returns one sample.
    #[inline]
    pub fn sample(&self, incident: Vec3, random: [f32; 2]) -> ScatterSet {
        with_lobe!(self.material, lobe => lobe.sample(&self.facing, incident, random))
    }

    /// Returns the value of the lobe, per steradian; zero for a specular lobe.
    pub fn evaluate(&self, incident: Vec3, scattered: Vec3) -> Vec3 {
        with_lobe!(self.material, lobe => lobe.evaluate(&self.facing, incident, scattered))
    }

    /// Returns the density with which [`Self::sample`] chooses a direction, per steradian; zero for
    /// a specular lobe.
    pub fn pdf(&self, incident: Vec3, scattered: Vec3) -> f32 {
        with_lobe!(self.material, lobe => lobe.pdf(&self.facing, incident, scattered))
    }

    /// True where the lobe scatters into single directions only (a Dirac delta).
    pub fn is_specular(&self) -> bool {
        with_lobe!(self.material, lobe => lobe.is_specular())
    }
}

/// Returns the share of light, per channel, that passes straight through a surface on its way to a
/// light; `None` for an opaque material.
///
/// `passage` returns the cosine (0..1) between the ray and the triangle's normal, and how the
/// triangle bounds a solid; it is called for transmissive materials only.
#[inline(always)]
pub fn straight_transmittance(
    material: &Material,
    passage: impl FnOnce() -> (f32, SolidSide),
) -> Option<Vec3> {
    with_lobe!(material, lobe => lobe.straight_transmittance(passage))
}
