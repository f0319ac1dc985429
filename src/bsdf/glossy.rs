//! Rough metal, and a rough clear coat over a diffuse base: one lobe of microfacets, whose
//! reflectance rises towards grazing angles (Schlick 1994).
//!
//! The base gets and sends what the coat does not reflect towards the viewer ([`base_share`]), as
//! in the material of glTF and in OpenPBR's albedo scaling: coat and base together never gain
//! energy, and the light that arrives at the base does not depend on the viewer.

use super::energy::{RELATIVE_ERROR, compensation, reflected, scattered_once, schlick};
use super::ggx::Ggx;
use super::lobe::{Facing, Lobe};
use super::local::LocalFrame;
use super::scatter::ScatterSet;
use crate::scene::SMOOTH;
use glam::Vec3;

/// The lobe; see [`crate::scene::MaterialKind::Glossy`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Glossy {
    pub(super) reflectance: Vec3,
    pub(super) roughness: f32,
}

impl Lobe for Glossy {
    fn sample(&self, facing: &Facing, incident: Vec3, random: [f32; 2]) -> ScatterSet {
        if self.is_specular() {
            let share = schlick(self.reflectance, facing.cosine(incident));
            return ScatterSet::reflected(facing.reflect(incident), share);
        }
        self.sample_rough(facing, incident, random).unwrap_or(ScatterSet::EMPTY)
    }

    fn evaluate(&self, facing: &Facing, incident: Vec3, scattered: Vec3) -> Vec3 {
        let value = |(frame, ratio, normal): (LocalFrame, f32, Vec3)| {
            let (ggx, incoming) = (self.ggx(), frame.local(scattered));
            let visible = ggx.visible_from_both(frame.outgoing, incoming);
            let value = ggx.density(normal) * visible / (4.0 * frame.outgoing.z * incoming.z);
            self.share(&frame, incoming, normal) * (value * ratio)
        };
        self.microfacet(facing, incident, scattered).map_or(Vec3::ZERO, value)
    }

    fn pdf(&self, facing: &Facing, incident: Vec3, scattered: Vec3) -> f32 {
        let density = |(frame, _, normal): (LocalFrame, f32, Vec3)| {
            let ggx = self.ggx();
            ggx.visible(frame.outgoing) * ggx.density(normal) / (4.0 * frame.outgoing.z)
        };
        self.microfacet(facing, incident, scattered).map_or(0.0, density)
    }

    fn is_specular(&self) -> bool {
        self.roughness < SMOOTH
    }

    fn width(&self) -> f32 {
        self.roughness * self.roughness
    }

    fn total(&self, facing: &Facing, incident: Vec3) -> f32 {
        reflected(self.reflectance, facing.cosine(incident), self.roughness).max_element()
    }
}

impl Glossy {
    fn ggx(&self) -> Ggx {
        Ggx::new(self.roughness)
    }

    fn sample_rough(&self, facing: &Facing, incident: Vec3, random: [f32; 2]) -> Option<ScatterSet> {
        let frame = LocalFrame::new(facing, incident)?;
        let (ggx, outgoing) = (self.ggx(), frame.outgoing);
        let normal = ggx.sample(outgoing, random);
        let incoming = normal * (2.0 * outgoing.dot(normal)) - outgoing;
        let scattered = frame.scene(incoming);
        frame.cosine_ratio(facing, scattered)?;
        if incoming.z <= 0.0 || scattered.dot(facing.geometric_normal) <= 0.0 {
            return None;
        }
        let share = ggx.visible_from_both(outgoing, incoming) / ggx.visible(outgoing);
        Some(ScatterSet::reflected(scattered, self.share(&frame, incoming, normal) * share))
    }

    /// The frame, its ratio of cosines and the normal of the microfacets that mirror one direction
    /// into the other; `None` where nothing is reflected.
    fn microfacet(
        &self,
        facing: &Facing,
        incident: Vec3,
        scattered: Vec3,
    ) -> Option<(LocalFrame, f32, Vec3)> {
        if self.is_specular() || scattered.dot(facing.geometric_normal) <= 0.0 {
            return None;
        }
        let frame = LocalFrame::new(facing, incident)?;
        let ratio = frame.cosine_ratio(facing, scattered)?;
        let normal = (frame.outgoing + frame.local(scattered)).normalize_or(Vec3::Z);
        Some((frame, ratio, normal))
    }

    /// The share of light that the microfacets reflect, and those that it meets afterwards.
    fn share(&self, frame: &LocalFrame, incoming: Vec3, normal: Vec3) -> Vec3 {
        let once = [frame.outgoing.z, incoming.z].map(|cos| scattered_once(cos, self.roughness));
        schlick(self.reflectance, frame.outgoing.dot(normal)) * compensation(self.reflectance, once)
    }
}

/// Returns the share (0..1) of its light that a diffuse base sends through the coat over it to a
/// viewer, who sees the shading normal at a cosine.
pub(super) fn base_share(reflectance: Vec3, roughness: f32, cos: f32) -> f32 {
    (1.0 - reflected(reflectance, cos, roughness).max_element() * (1.0 + RELATIVE_ERROR)).max(0.0)
}
