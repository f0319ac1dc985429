//! Microfacets: the distribution of normals on a rough surface, and what of it is visible.
//!
//! Sources: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007,
//! for the distribution (GGX) and for refraction; Heitz, "Understanding the Masking-Shadowing
//! Function in Microfacet-Based BRDFs", JCGT 3(2), 2014, for the heights that shadow each other;
//! Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018, for what is sampled,
//! and Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023, for how.
//!
//! All directions are local: the surface's normal is +Z.

use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A distribution of the normals of microfacets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ggx {
    /// Slope of the microfacets: the square of the roughness.
    alpha: f32,
}

impl Ggx {
    /// The distribution of a roughness, 0..1, as files give it.
    pub(super) fn new(roughness: f32) -> Self {
        Self { alpha: roughness * roughness }
    }

    /// Density of microfacets by solid angle of their normal and area of the surface.
    pub(super) fn density(self, normal: Vec3) -> f32 {
        // From the sine, because near +Z the cosine has lost it.
        let slope2 = normal.truncate().length_squared() / (self.alpha * self.alpha);
        let sum = slope2 + normal.z * normal.z;
        1.0 / (PI * self.alpha * self.alpha * sum * sum)
    }

    /// Smith's Lambda: the area of hidden microfacets over that of visible ones.
    fn hidden(self, direction: Vec3) -> f32 {
        let tan2 = direction.truncate().length_squared() / (direction.z * direction.z);
        ((1.0 + self.alpha * self.alpha * tan2).sqrt() - 1.0) / 2.0
    }

    /// Share (0..1) of microfacets that are visible from a direction.
    pub(super) fn visible(self, direction: Vec3) -> f32 {
        1.0 / (1.0 + self.hidden(direction))
    }

    /// Share (0..1) of microfacets that are visible from two directions on one side: high ones are
    /// visible from both.
    pub(super) fn visible_from_both(self, a: Vec3, b: Vec3) -> f32 {
        1.0 / (1.0 + self.hidden(a) + self.hidden(b))
    }

    /// Density of [`Self::sample`] by solid angle of the normal.
    pub(super) fn visible_density(self, outgoing: Vec3, normal: Vec3) -> f32 {
        self.visible(outgoing) * self.density(normal) * outgoing.dot(normal).max(0.0) / outgoing.z
    }

    /// Returns a normal that is visible from `outgoing`, in proportion to its visible area.
    pub(super) fn sample(self, outgoing: Vec3, random: [f32; 2]) -> Vec3 {
        let stretched = |v: Vec3| Vec3::from(((v.truncate() * self.alpha), v.z)).normalize_or(Vec3::Z);
        let seen_from = stretched(outgoing);
        let z = (1.0 - random[1]) * (1.0 + seen_from.z) - seen_from.z;
        let around = Vec2::from_angle(TAU * random[0]) * (1.0 - z * z).max(0.0).sqrt();
        stretched(around.extend(z) + seen_from)
    }
}
