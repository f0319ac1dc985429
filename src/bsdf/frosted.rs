//! Rough dielectrics: a frosted pane, or the rough face of a solid.
//!
//! An open sheet reflects and transmits by the same lobe, once mirrored about the sheet, as
//! `KHR_materials_transmission` of glTF describes it; what bounces between its faces is included. A
//! face of a solid refracts as in Walter et al. 2007, whose lobe loses what would meet further
//! microfacets; a sheet is compensated as a metal is (`energy`).

use super::dielectric::{Dielectric, fresnel_dielectric, of_sheet};
use super::energy::{compensation, scattered_once};
use super::ggx::Ggx;
use super::lobe::{Facing, Lobe};
use super::local::LocalFrame;
use super::scatter::ScatterSet;
use crate::math::sampling::lattice;
use crate::scene::{SMOOTH, SolidSide};
use glam::Vec3;

/// Smallest index of refraction of a solid whose face is rough: at 1 no roughness bends light, and
/// its lobe would be a single direction.
const MIN_ETA: f32 = 1.0 + 1.0 / 64.0;

/// The lobe; see [`crate::scene::MaterialKind::Frosted`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Frosted {
    pub(super) clear: Dielectric,
    pub(super) roughness: f32,
}

/// A microfacet that scatters between two directions.
struct Facet {
    frame: LocalFrame,
    /// Local direction in which the path continues.
    incoming: Vec3,
    normal: Vec3,
    /// Cosine to the frame's normal over that to the shading normal.
    ratio: f32,
}

impl Lobe for Frosted {
    fn sample(&self, facing: &Facing, incident: Vec3, random: [f32; 2]) -> ScatterSet {
        if self.is_specular() {
            return self.clear.sample(facing, incident, random);
        }
        self.sample_rough(facing, incident, random).unwrap_or(ScatterSet::EMPTY)
    }

    fn evaluate(&self, facing: &Facing, incident: Vec3, scattered: Vec3) -> Vec3 {
        let Some(facet) = self.facet(facing, incident, scattered) else { return Vec3::ZERO };
        let weight = self.weight(facing, &facet.frame, facet.incoming, facet.normal);
        let density = self.density(facing, &facet);
        weight * (density / facet.incoming.z.abs() * facet.ratio)
    }

    fn pdf(&self, facing: &Facing, incident: Vec3, scattered: Vec3) -> f32 {
        let Some(facet) = self.facet(facing, incident, scattered) else { return 0.0 };
        // What carries nothing is not sampled.
        let weight = self.weight(facing, &facet.frame, facet.incoming, facet.normal);
        if weight.max_element() > 0.0 { self.density(facing, &facet) } else { 0.0 }
    }

    fn is_specular(&self) -> bool {
        self.roughness < SMOOTH
    }

    fn width(&self) -> f32 {
        self.roughness * self.roughness
    }

    #[inline(always)]
    fn straight_transmittance(&self, passage: impl FnOnce() -> (f32, SolidSide)) -> Option<Vec3> {
        self.clear.straight_transmittance(passage)
    }

    #[inline(always)]
    fn straight_transmittances(&self, passage: impl FnOnce() -> ([f32; 8], SolidSide)) -> Option<[Vec3; 8]> {
        self.clear.straight_transmittances(passage)
    }
}

impl Frosted {
    fn ggx(&self) -> Ggx {
        Ggx::new(self.roughness)
    }

    /// Share (0..1) of its light that a diffuse part of an open sheet sends to a viewer at a
    /// cosine: what the sheet does not reflect, estimated by a few microfacets.
    pub(super) fn base_share(&self, cos: f32) -> f32 {
        const FACETS: u32 = 16;
        /// Bound on the relative error of the estimate.
        const ERROR: f32 = 1.0 / 16.0;
        let facing = Facing { geometric_normal: Vec3::Z, shading_normal: Vec3::Z, enters_solid: None };
        let incident = -Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
        let black = Self { clear: Dielectric { transmittance: Vec3::ZERO, ..self.clear }, ..*self };
        let reflected = |i| black.sample(&facing, incident, lattice(i, FACETS, [0.5; 2])).total_weight();
        let mean = (0..FACETS).map(reflected).sum::<f32>() / FACETS as f32;
        (1.0 - mean * (1.0 + ERROR)).clamp(0.0, 1.0)
    }

    /// Index of refraction on the viewer's side over that on the other; `None` for a sheet.
    fn eta(&self, facing: &Facing) -> Option<f32> {
        let eta = self.clear.eta.max(MIN_ETA);
        facing.enters_solid.map(|enters| if enters { 1.0 / eta } else { eta })
    }

    /// Share of light that a microfacet reflects.
    fn reflected(&self, facing: &Facing, cos: f32) -> f32 {
        match self.eta(facing) {
            Some(eta) => fresnel_dielectric(cos, eta),
            None => of_sheet(fresnel_dielectric(cos, 1.0 / self.clear.eta)),
        }
    }

    fn sample_rough(&self, facing: &Facing, incident: Vec3, random: [f32; 2]) -> Option<ScatterSet> {
        let frame = LocalFrame::new(facing, incident)?;
        let normal = self.ggx().sample(frame.outgoing, random);
        let cos = frame.outgoing.dot(normal).clamp(0.0, 1.0);
        let mirrored = normal * (2.0 * cos) - frame.outgoing;
        let through = match self.eta(facing) {
            None => Some(mirrored * Vec3::new(1.0, 1.0, -1.0)),
            Some(eta) => refracted(frame.outgoing, normal, eta),
        };
        let branch = |local: Vec3, is_transmitted: bool| {
            let scattered = frame.scene(local);
            let is_on_side = (local.z < 0.0) == is_transmitted
                && (scattered.dot(facing.geometric_normal) < 0.0) == is_transmitted;
            frame.cosine_ratio(facing, scattered).filter(|_| is_on_side)?;
            let weight = self.weight(facing, &frame, local, normal);
            (weight.max_element() > 0.0).then_some((scattered, weight))
        };
        let through = through.and_then(|local| branch(local, true));
        Some(ScatterSet::split(through, branch(mirrored, false)))
    }

    /// What a sample through a microfacet carries.
    fn weight(&self, facing: &Facing, frame: &LocalFrame, incoming: Vec3, normal: Vec3) -> Vec3 {
        let (ggx, outgoing) = (self.ggx(), frame.outgoing);
        let reflected = self.reflected(facing, outgoing.dot(normal).clamp(0.0, 1.0));
        let is_transmitted = incoming.z < 0.0;
        let share = if is_transmitted {
            self.clear.transmittance * (1.0 - reflected)
        } else {
            Vec3::splat(reflected)
        };
        if facing.enters_solid.is_some() && is_transmitted {
            // The heights of both sides of a face have nothing in common.
            return share * ggx.visible(incoming);
        }
        let once = [outgoing.z, incoming.z.abs()].map(|cos| scattered_once(cos, self.roughness));
        let more = if facing.enters_solid.is_none() { compensation(Vec3::ONE, once) } else { Vec3::ONE };
        share * more * (ggx.visible_from_both(outgoing, incoming) / ggx.visible(outgoing))
    }

    /// Density of the sampled directions that continue on the side of the facet's.
    fn density(&self, facing: &Facing, facet: &Facet) -> f32 {
        let Facet { frame, incoming, normal, .. } = facet;
        let visible = self.ggx().visible_density(frame.outgoing, *normal);
        let [out, into] = [frame.outgoing, *incoming].map(|direction| direction.dot(*normal));
        match self.eta(facing) {
            Some(eta) if incoming.z < 0.0 => {
                let sum = eta * out + into;
                visible * into.abs() / (sum * sum)
            }
            _ => visible / (4.0 * out),
        }
    }

    /// The microfacet that scatters one direction into the other; `None` where there is none.
    fn facet(&self, facing: &Facing, incident: Vec3, scattered: Vec3) -> Option<Facet> {
        if self.is_specular() {
            return None;
        }
        let frame = LocalFrame::new(facing, incident)?;
        let (ratio, incoming) = (frame.cosine_ratio(facing, scattered)?, frame.local(scattered));
        let normal = match self.eta(facing) {
            Some(eta) if incoming.z < 0.0 => {
                let normal = (frame.outgoing * eta + incoming).normalize_or(Vec3::Z);
                let normal = if normal.z < 0.0 { -normal } else { normal };
                let [out, into] = [frame.outgoing, incoming].map(|direction| direction.dot(normal));
                (out > 0.0 && into < 0.0).then_some(normal)?
            }
            _ => (frame.outgoing + incoming * Vec3::new(1.0, 1.0, incoming.z.signum())).normalize_or(Vec3::Z),
        };
        Some(Facet { frame, incoming, normal, ratio })
    }
}

/// The direction beyond a microfacet by Snell's law; `None` where the light is reflected totally.
fn refracted(outgoing: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    let cos = outgoing.dot(normal);
    let cos2_through = 1.0 - eta * eta * (1.0 - cos * cos);
    (cos2_through > 0.0).then(|| normal * (eta * cos - cos2_through.sqrt()) - outgoing * eta)
}
