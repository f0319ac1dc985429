//! A section of a scene: its planes, and how its caps look.

use super::plane::{CutPlane, Region};
use super::profile::Profile;
use super::solids::Solids;
use crate::scene::Scene;
use glam::{DVec3, Vec3};
use std::sync::OnceLock;

/// Display value (0..1, linear) of the ground of a cap, and of its hatching and outline.
pub const CAP_TONES: [f32; 2] = [0.80, 0.02];

/// A scene that is cut open by planes.
#[derive(Debug)]
pub struct Section {
    planes: Vec<CutPlane>,
    pub(super) region: Region,
    /// Radiance of the ground of a cap, and of its lines.
    pub(super) tones: [f32; 2],
    /// Distance between two lines of the hatching, scene units.
    pub(super) spacing: f32,
    /// The cut through the bodies by each plane, once a ray has met it.
    profiles: Vec<OnceLock<Profile>>,
}

impl PartialEq for Section {
    /// Two sections are equal where their pictures are, of one scene.
    fn eq(&self, other: &Self) -> bool {
        self.planes == other.planes && self.tones == other.tones
    }
}

impl Section {
    pub(super) fn new(scene: &Scene, planes: &[CutPlane], tones: [f32; 2]) -> Self {
        let region = Region::new(planes, &scene.frame);
        let profiles = planes.iter().map(|_| OnceLock::new()).collect();
        let spacing = (hatch_spacing_m(scene) * scene.frame.units_per_metre) as f32;
        Self { planes: planes.to_vec(), region, tones, spacing, profiles }
    }

    /// The cut by a plane.
    pub(super) fn profile(&self, plane: usize, scene: &Scene, solids: &Solids) -> &Profile {
        let (axis, at) = self.region.plane(plane);
        self.profiles[plane].get_or_init(|| Profile::new(scene, solids, axis, at))
    }

    /// The planes.
    pub fn planes(&self) -> &[CutPlane] {
        &self.planes
    }
}

/// Distance between two lines of the hatching, metres: a round number near 1/150 of the building's
/// diagonal.
fn hatch_spacing_m(scene: &Scene) -> f64 {
    let [low, high] = scene.building_m;
    let wanted = ((high - low).length() / 150.0).max(1e-6);
    let decade = 10f64.powf(wanted.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade);
    steps
        .into_iter()
        .min_by(|a, b| (a / wanted).ln().abs().total_cmp(&(b / wanted).ln().abs()))
        .unwrap_or(decade)
}

/// Why planes make no section of a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SectionError {
    /// A plane lies outside of the model.
    #[error(
        "{axis}={at_m} lies outside the model, which reaches from {axis}={low_m:.2} to {axis}={high_m:.2}"
    )]
    Outside {
        /// Name of the axis.
        axis: char,
        /// The plane, world metres.
        at_m: f64,
        /// Lower end of the model, world metres.
        low_m: f64,
        /// Upper end of the model, world metres.
        high_m: f64,
    },
    /// The planes leave nothing of the model.
    #[error(
        "the planes leave nothing of the model, which reaches from {low_m:.2} to {high_m:.2} (x, y, z in metres)"
    )]
    Nothing {
        /// Lower corner of the model, world metres.
        low_m: DVec3,
        /// Upper corner of the model, world metres.
        high_m: DVec3,
    },
    /// The planes leave the whole model.
    #[error(
        "the planes cut nothing off the model, which reaches from {low_m:.2} to {high_m:.2} (x, y, z in metres)"
    )]
    Everything {
        /// Lower corner of the model, world metres.
        low_m: DVec3,
        /// Upper corner of the model, world metres.
        high_m: DVec3,
    },
}

/// Checks that planes cut a scene: some of its building is left, and some is removed.
///
/// # Errors
/// [`SectionError`] with what the planes do instead.
pub fn check_planes(scene: &Scene, planes: &[CutPlane]) -> Result<(), SectionError> {
    let [low_m, high_m] = scene.building_m;
    let region = Region::new(planes, &scene.frame);
    let corners: [Vec3; 2] = [low_m, high_m].map(|p| scene.frame.scene_from_world_f64(p).as_vec3());
    let is_beyond = |plane: &&CutPlane| !(low_m[plane.axis]..=high_m[plane.axis]).contains(&plane.at_m);
    let beyond = planes.iter().find(is_beyond);
    let (meets, contains) = (region.meets(corners), region.contains(corners));
    match beyond.filter(|_| planes.len() == 1) {
        Some(plane) => Err(SectionError::Outside {
            axis: ['x', 'y', 'z'][plane.axis],
            at_m: plane.at_m,
            low_m: low_m[plane.axis],
            high_m: high_m[plane.axis],
        }),
        None if !meets => Err(SectionError::Nothing { low_m, high_m }),
        None if contains => Err(SectionError::Everything { low_m, high_m }),
        None => Ok(()),
    }
}
