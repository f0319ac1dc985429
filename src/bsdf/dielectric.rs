//! Clear glass and other dielectrics: a solid refracts, an open sheet lets light pass straight.

use super::lobe::{Facing, Lobe};
use super::scatter::ScatterSet;
use crate::scene::SolidSide;
use glam::Vec3;

/// A dielectric; see [`crate::scene::MaterialKind::Glass`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Dielectric {
    pub(super) eta: f32,
    pub(super) transmittance: Vec3,
}

impl Lobe for Dielectric {
    #[inline]
    fn sample(&self, facing: &Facing, incident: Vec3, _random: [f32; 2]) -> ScatterSet {
        match facing.enters_solid {
            None => self.through_sheet(facing, incident),
            Some(true) => self.through_face(facing, incident, 1.0 / self.eta),
            Some(false) => self.through_face(facing, incident, self.eta),
        }
    }

    #[inline(always)]
    fn straight_transmittance(&self, passage: impl FnOnce() -> (f32, SolidSide)) -> Option<Vec3> {
        let (cos, side) = passage();
        Some(self.transmittance * self.straight_share(cos, side))
    }

    #[inline(always)]
    fn straight_transmittances(&self, passage: impl FnOnce() -> ([f32; 8], SolidSide)) -> Option<[Vec3; 8]> {
        let (cos, side) = passage();
        let mut passed = [Vec3::ZERO; 8];
        // First all shares, so that this loop runs in vectors.
        let mut shares = [0.0; 8];
        for (share, cos) in shares.iter_mut().zip(cos) {
            *share = self.straight_share(cos, side);
        }
        for (passed, share) in passed.iter_mut().zip(shares) {
            *passed = self.transmittance * share;
        }
        Some(passed)
    }
}

impl Dielectric {
    /// The share of light, before absorption, that passes straight through a face or a sheet.
    #[inline(always)]
    fn straight_share(&self, cos: f32, side: SolidSide) -> f32 {
        let reflected = fresnel_dielectric(cos, 1.0 / self.eta);
        1.0 - if side == SolidSide::Thin { of_sheet(reflected) } else { reflected }
    }

    /// An open sheet: light passes straight through, and the reflected share includes what bounces
    /// between its two faces.
    fn through_sheet(&self, facing: &Facing, incident: Vec3) -> ScatterSet {
        let share = of_sheet(fresnel_dielectric(facing.cosine(incident), 1.0 / self.eta));
        let transmitted = (incident, self.transmittance * (1.0 - share));
        ScatterSet::split(Some(transmitted), reflected(facing, incident, share))
    }

    /// A face of a solid; `eta` is the index on the viewer's side over that on the other.
    fn through_face(&self, facing: &Facing, incident: Vec3, eta: f32) -> ScatterSet {
        let share = fresnel_dielectric(facing.cosine(incident), eta);
        let transmitted =
            (share < 1.0).then(|| (refract(facing, incident, eta), self.transmittance * (1.0 - share)));
        ScatterSet::split(transmitted, reflected(facing, incident, share))
    }
}

/// The reflected direction and its share; `None` where nothing is reflected.
fn reflected(facing: &Facing, incident: Vec3, share: f32) -> Option<(Vec3, Vec3)> {
    (share > 0.0).then(|| (facing.reflect(incident), Vec3::splat(share)))
}

/// The share that a sheet reflects, from the share that each of its faces does: the geometric
/// series of the light that bounces between them.
#[inline(always)]
pub(super) fn of_sheet(single: f32) -> f32 {
    2.0 * single / (1.0 + single)
}

/// The refracted direction by Snell's law, about the triangle's normal where the shading normal
/// would keep it on the viewer's side.
fn refract(facing: &Facing, incident: Vec3, eta: f32) -> Vec3 {
    let about = |n: Vec3| {
        let cos = n.dot(-incident);
        let sin2 = eta * eta * (1.0 - cos * cos).max(0.0);
        incident * eta + n * (eta * cos - (1.0 - sin2).max(0.0).sqrt())
    };
    let refracted = about(facing.shading_normal);
    if refracted.dot(facing.geometric_normal) < 0.0 { refracted } else { about(facing.geometric_normal) }
}

/// Returns the share of unpolarised light that a dielectric reflects (Fresnel's equations).
///
/// `cos` (0..1) is the cosine of the angle of incidence, `eta` the index of refraction on the side
/// that the light comes from over that on the other side. One under total internal reflection.
#[inline(always)]
pub fn fresnel_dielectric(cos: f32, eta: f32) -> f32 {
    // In f64, because near the critical angle the difference loses what an f32 holds.
    let (cos_wide, eta_wide) = (f64::from(cos), f64::from(eta));
    let cos2_through = 1.0 - eta_wide * eta_wide * (1.0 - cos_wide * cos_wide).max(0.0);
    // Without a branch, so that a loop over several angles runs in vectors.
    let cos_through = cos2_through.sqrt() as f32;
    let parallel = (cos - eta * cos_through) / (cos + eta * cos_through);
    let perpendicular = (eta * cos - cos_through) / (eta * cos + cos_through);
    let share = ((parallel * parallel + perpendicular * perpendicular) / 2.0).clamp(0.0, 1.0);
    if cos2_through <= 0.0 { 1.0 } else { share }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_rays_lose_as_much_as_each_alone() {
        for eta in [1.0, 1.1, 1.5, 2.4] {
            let glass = Dielectric { eta, transmittance: Vec3::new(0.9, 1.0, 0.3) };
            for side in [SolidSide::Thin, SolidSide::InsideBehind, SolidSide::InsideInFront] {
                for step in 0..100 {
                    let cos: [f32; 8] = std::array::from_fn(|ray| (8 * step + ray) as f32 / 799.0);
                    let together = glass.straight_transmittances(|| (cos, side));
                    let alone = cos.map(|cos| glass.straight_transmittance(|| (cos, side)));
                    assert_eq!(together.map(|shares| shares.map(Some)), Some(alone), "{eta}, {side:?}");
                }
            }
        }
    }
}
