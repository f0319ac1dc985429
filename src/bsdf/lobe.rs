//! What every lobe provides, and the geometry that it is given.

use super::scatter::ScatterSet;
use crate::scene::SolidSide;
use glam::Vec3;

/// The side of a surface on which a path arrives.
#[derive(Clone, Copy, Debug)]
pub struct Facing {
    /// Unit normal of the triangle, on the viewer's side.
    pub geometric_normal: Vec3,
    /// Unit interpolated normal, on the viewer's side of the triangle.
    pub shading_normal: Vec3,
    /// `None` for an open sheet; else whether light that passes from the viewer's side enters the
    /// solid.
    pub enters_solid: Option<bool>,
}

impl Facing {
    /// Cosine between the shading normal and the reversed incident direction, 0..1.
    #[inline]
    pub(super) fn cosine(&self, incident: Vec3) -> f32 {
        self.shading_normal.dot(-incident).clamp(0.0, 1.0)
    }

    /// Mirrors a direction about the shading normal, or about the triangle's normal where the
    /// shading normal would send it into the surface.
    #[inline]
    pub(super) fn reflect(&self, incident: Vec3) -> Vec3 {
        let about = |n: Vec3| incident - n * (2.0 * incident.dot(n));
        let reflected = about(self.shading_normal);
        if reflected.dot(self.geometric_normal) > 0.0 { reflected } else { about(self.geometric_normal) }
    }
}

/// One way in which a surface scatters light. The defaults are those of an opaque specular lobe.
pub trait Lobe {
    /// Returns the directions in which a path continues; `random` is a point of the unit square.
    ///
    /// The weight of a sample is value times cosine over density. A specular lobe returns all its
    /// directions, each with the share of light that it carries.
    fn sample(&self, facing: &Facing, incident: Vec3, random: [f32; 2]) -> ScatterSet;

    /// Returns the value of the lobe, per steradian, without the cosine.
    fn evaluate(&self, _facing: &Facing, _incident: Vec3, _scattered: Vec3) -> Vec3 {
        Vec3::ZERO
    }

    /// Returns the density with which [`Self::sample`] chooses a direction, per steradian.
    fn pdf(&self, _facing: &Facing, _incident: Vec3, _scattered: Vec3) -> f32 {
        0.0
    }

    /// True where the lobe scatters into single directions only (a Dirac delta).
    fn is_specular(&self) -> bool {
        true
    }

    /// Returns how wide the lobe is: the slope of its microfacets, 0..1; 0 for single directions.
    fn width(&self) -> f32 {
        0.0
    }

    /// Returns the share (0..1) of light that the lobe scatters towards the viewer, of the channel
    /// of which it is most.
    fn total(&self, _facing: &Facing, _incident: Vec3) -> f32 {
        1.0
    }

    /// Returns the share of light, per channel, that passes straight through the surface along a
    /// shadow ray; `None` for an opaque surface.
    ///
    /// `passage` returns the cosine (0..1) between the ray and the triangle's normal, and how the
    /// triangle bounds a solid; it is called for transmissive lobes only.
    #[inline(always)]
    fn straight_transmittance(&self, _passage: impl FnOnce() -> (f32, SolidSide)) -> Option<Vec3> {
        None
    }

    /// [`Self::straight_transmittance`] of eight shadow rays through one triangle, with the same
    /// bits; `passage` returns their cosines.
    #[inline(always)]
    fn straight_transmittances(&self, _passage: impl FnOnce() -> ([f32; 8], SolidSide)) -> Option<[Vec3; 8]> {
        None
    }
}

/// The lobe of a material whose radiance does not depend on the viewer.
pub(super) struct NoLobe;

impl Lobe for NoLobe {
    #[inline]
    fn sample(&self, _facing: &Facing, _incident: Vec3, _random: [f32; 2]) -> ScatterSet {
        ScatterSet::EMPTY
    }

    fn is_specular(&self) -> bool {
        false
    }
}
