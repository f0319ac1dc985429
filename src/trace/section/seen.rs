//! What camera rays and their reflections see of a scene that may be cut.

use super::cut::Section;
use super::plane::{CutPlane, Interval};
use super::solids::Solids;
use crate::math::Ray;
use crate::trace::{Hit, Tracer};
use glam::Vec3;
use std::sync::Arc;

/// Width of the lines of the hatching, relative to the distance between them.
const LINE: f32 = 0.22;

/// Width of the outline of a cap, relative to the distance between lines of the hatching.
const OUTLINE: f32 = 0.4;

/// A point of the cut through a closed body, seen by a camera ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// Distance along the ray, in units of its direction.
    pub t: f32,
    /// Constant radiance that is shown there: no light falls on a cap.
    pub radiance: Vec3,
}

impl Tracer {
    /// Returns a tracer of the same scene that is cut by planes for the camera; without planes, of
    /// the whole scene. It has the same epoch: light does not see the section.
    ///
    /// `tones` are the radiances of the ground and the lines of caps, so that they can be shown
    /// with constant display values: see [`super::CAP_TONES`].
    #[must_use]
    pub fn with_section(&self, planes: &[CutPlane], tones: [f32; 2]) -> Self {
        let mut cut = self.clone();
        let section = (!planes.is_empty()).then(|| Arc::new(Section::new(self.scene(), planes, tones)));
        cut.full = self.full.as_ref().map(|full| {
            let mut full = Tracer::clone(full);
            full.section.clone_from(&section);
            Arc::new(full)
        });
        cut.section = section;
        cut
    }

    /// The section through which camera rays see the scene; `None` where they see all of it.
    pub fn section(&self) -> Option<&Arc<Section>> {
        self.section.as_ref()
    }

    /// The closed bodies of the scene, found when a ray first asks for them.
    fn solids(&self) -> &Solids {
        self.solids.get_or_init(|| Arc::new(Solids::find(self.scene(), self.bvh())))
    }

    /// Number of closed bodies of the scene whose cut surfaces sections show.
    pub fn solid_count(&self) -> usize {
        self.solids().count()
    }

    /// Returns the nearest hit along a camera ray: [`Self::closest`] in the part of the scene that
    /// the section keeps. `None` where the ray sees a cap, which [`Self::cap`] returns.
    pub fn closest_seen(&self, ray: &Ray) -> Option<Hit> {
        if self.section.is_none() {
            return self.closest(ray);
        }
        self.closest_seen_where(ray, |_| true)
    }

    /// [`Self::closest_seen`] of the hits for which `is_there` holds.
    pub(in crate::trace) fn closest_seen_where(
        &self,
        ray: &Ray,
        is_there: impl Fn(&Hit) -> bool,
    ) -> Option<Hit> {
        let Some(section) = &self.section else {
            return self.bvh().closest(ray, |hit| is_there(hit) && self.stands(ray, hit));
        };
        let piece = section.region.clip(ray)?;
        if self.is_capped(section, ray, &piece) {
            return None;
        }
        let kept = Ray { t_max: ray.t_max.min(piece.end), ..*ray };
        self.bvh().closest(&kept, |hit| hit.t >= piece.start && is_there(hit) && self.stands(ray, hit))
    }

    /// Returns the nearest hit along a ray that leaves a surface that the camera sees: it ends
    /// where it leaves the kept part of the scene.
    pub(in crate::trace) fn closest_from_seen(&self, ray: &Ray) -> Option<Hit> {
        match &self.section {
            None => self.closest(ray),
            Some(section) => self.closest(&Ray { t_max: ray.t_max.min(section.region.end_of(ray)), ..*ray }),
        }
    }

    /// The ray up to its last point in the kept part of the scene; `None` where it misses that.
    pub(in crate::trace) fn clipped(&self, ray: Ray) -> Option<Ray> {
        let Some(section) = &self.section else { return Some(ray) };
        section.region.clip(&ray).map(|piece| Ray { t_max: ray.t_max.min(piece.end), ..ray })
    }

    /// True where a hit of a ray is not before the kept part of the scene.
    pub(in crate::trace) fn is_kept(&self, ray: &Ray, hit: &Hit) -> bool {
        let clip = |section: &Arc<Section>| section.region.clip(ray);
        self.section.as_ref().is_none_or(|section| clip(section).is_some_and(|piece| hit.t >= piece.start))
    }

    /// True where a camera ray sees a hit that is the nearest one in the whole scene.
    pub(in crate::trace) fn is_seen(&self, ray: &Ray, hit: &Hit) -> bool {
        let Some(section) = &self.section else { return true };
        section.region.clip(ray).is_some_and(|piece| {
            (piece.start..piece.end).contains(&hit.t) && !self.is_capped(section, ray, &piece)
        })
    }

    /// Returns the cap that a camera ray sees; `None` where it enters the kept part of the scene in
    /// the open, or not at all.
    pub fn cap(&self, ray: &Ray) -> Option<Cap> {
        let section = self.section.as_ref()?;
        let piece = section.region.clip(ray)?;
        let plane = piece.entered.filter(|_| self.is_capped(section, ray, &piece))?;
        let tone = usize::from(self.is_on_line(section, ray.origin + ray.direction * piece.start, plane));
        Some(Cap { t: piece.start, radiance: Vec3::splat(section.tones[tone]) })
    }

    /// Returns the radiance along a camera ray that hits no surface, and the disparity of what it
    /// sees: that of a cap, or zero for the sky.
    pub fn beyond_surfaces(&self, ray: &Ray) -> (Vec3, f32) {
        match self.cap(ray) {
            Some(cap) => (cap.radiance, 1.0 / cap.t),
            None => (self.sky(ray.direction), 0.0),
        }
    }

    fn is_capped(&self, section: &Section, ray: &Ray, piece: &Interval) -> bool {
        piece.entered.is_some_and(|plane| {
            let solids = self.solids();
            let profile = section.profile(plane, self.scene(), solids);
            profile.is_inside(solids, ray.origin + ray.direction * piece.start)
        })
    }

    /// True where a point of a cap lies on a line of the hatching or on the outline.
    fn is_on_line(&self, section: &Section, point: Vec3, plane: usize) -> bool {
        let (axis, _) = section.region.plane(plane);
        let diagonal = (point[(axis + 1) % 3] + point[(axis + 2) % 3]) * std::f32::consts::FRAC_1_SQRT_2;
        let profile = || section.profile(plane, self.scene(), self.solids());
        (diagonal / section.spacing).rem_euclid(1.0) < LINE
            || profile().is_at_outline(point, OUTLINE * section.spacing)
    }
}
