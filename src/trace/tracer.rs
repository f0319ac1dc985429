//! The tracer: a scene with its hierarchy, and the rays traced through it.

use super::bvh::{Bvh, Hit, NO_TRIANGLE};
use super::lights::{CellLights, LightGrid};
use super::section::{Section, Solids};
use super::surface::{SurfacePoint, albedo_of_hit, emission_of_hit, interpolate_uv};
use crate::camera::View;
use crate::math::Ray;
use crate::raster::exposure::Metered;
use crate::scene::{Material, Scene, beats, share_plane};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// Largest distance by which a hit may lie in front of or behind its triangle, relative to its own
/// distance. Beyond it the triangle test has failed on a needle.
const REACH_SLACK: f32 = 1e-3;

/// A scene that is ready to be traced.
#[derive(Clone, Debug)]
pub struct Tracer {
    scene: Arc<Scene>,
    /// Shared with tracers of the same geometry.
    bvh: Arc<Bvh>,
    lights: Arc<LightGrid>,
    epoch: SceneEpoch,
    build_secs: f64,
    pub(super) metered: Arc<OnceLock<Metered>>,
    /// The tracer of the scene with all lights as the files have them; `None` where this is it.
    pub(super) full: Option<Arc<Tracer>>,
    /// See [`Self::showing_light`].
    shows_light: bool,
    /// The section through which camera rays see the scene.
    pub(super) section: Option<Arc<Section>>,
    /// The closed bodies, once a section has needed them. Shared with tracers of the same geometry.
    pub(super) solids: Arc<OnceLock<Arc<Solids>>>,
}

/// Identifies one state of one scene. Every change of light or geometry makes a new tracer, and so
/// a new epoch; results of another epoch are never used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SceneEpoch(u64);

static NEXT_EPOCH: AtomicU64 = AtomicU64::new(0);

impl SceneEpoch {
    fn next() -> Self {
        Self(NEXT_EPOCH.fetch_add(1, Ordering::Relaxed))
    }
}

impl Tracer {
    /// Builds the hierarchy over a scene.
    pub fn new(scene: Arc<Scene>) -> Self {
        profiling::scope!("tree of triangles");
        let start = Instant::now();
        let corners: Vec<[Vec3; 3]> =
            (0..scene.triangles.len() as u32).into_par_iter().map(|t| scene.corners(t)).collect();
        let bvh = Arc::new(Bvh::build_without(&corners, &scene.hidden));
        let solids = Arc::default();
        let full = scene
            .full
            .clone()
            .map(|full| Arc::new(Self::with_bvh(full, (bvh.clone(), Arc::clone(&solids)), None, start)));
        Self::with_bvh(scene, (bvh, solids), full, start)
    }

    /// Begins a new epoch with a hierarchy whose building began at `start`. Where lights of the
    /// scene are dimmed, the exposure is that of the scene at full light.
    fn with_bvh(
        scene: Arc<Scene>,
        (bvh, solids): (Arc<Bvh>, Arc<OnceLock<Arc<Solids>>>),
        full: Option<Arc<Self>>,
        start: Instant,
    ) -> Self {
        let lights = Arc::new(LightGrid::new(&scene));
        let metered = full.as_ref().map(|full| full.metered.clone()).unwrap_or_default();
        let (epoch, build_secs) = (SceneEpoch::next(), start.elapsed().as_secs_f64());
        log::info!("{}: ready for rays after {build_secs:.3} s, {} lights", scene.name, scene.lights.len());
        let shows_light = false;
        Self { scene, bvh, lights, epoch, build_secs, metered, full, shows_light, section: None, solids }
    }

    /// Returns a tracer of a scene with the same triangles, whose materials or lights may differ.
    /// It shares the hierarchy, and what is known of the scene at full light.
    ///
    /// # Panics
    /// If the numbers of triangles differ.
    #[must_use]
    pub fn with_same_geometry(&self, scene: Arc<Scene>) -> Self {
        let counts = [&scene, &self.scene].map(|scene| scene.triangles.len());
        assert_eq!(counts[0], counts[1], "another geometry needs another hierarchy");
        let start = Instant::now();
        let known = self.full.as_deref().unwrap_or(self);
        let is_known = known.scene.hash == scene.full_hash();
        let geometry = || (self.bvh.clone(), self.solids.clone());
        match &scene.full {
            None if is_known => Self { scene, epoch: SceneEpoch::next(), ..known.clone() },
            None => Self::with_bvh(scene, geometry(), None, start),
            Some(full) => {
                let full = match is_known {
                    true => self.full.clone().unwrap_or_else(|| Arc::new(known.clone())),
                    false => Arc::new(Self::with_bvh(full.clone(), geometry(), None, start)),
                };
                Self::with_bvh(scene, geometry(), Some(full), start)
            }
        }
    }

    /// The tracer of the same scene at full light whose places leave out lights only where these
    /// bring next to nothing of their own group's light: where the other groups are dimmed, it is
    /// seen.
    pub(crate) fn by_groups(&self) -> Self {
        let full = self.full.as_deref().unwrap_or(self);
        let lights = Arc::new(LightGrid::by_groups(&full.scene));
        Self { lights, ..full.clone() }
    }

    /// Returns the same tracer, of the same epoch, for pictures or for the light that arrives at
    /// surfaces. With `shows_light`, the first surface of each pixel is white and matte: it emits
    /// nothing, and reflects nothing else. Paths that begin there meet the scene as it is, so that
    /// references serve both kinds of pictures.
    #[must_use]
    pub fn showing_light(&self, shows_light: bool) -> Self {
        Self { shows_light, ..self.clone() }
    }

    /// True where pictures show the light that arrives at surfaces.
    pub fn shows_light(&self) -> bool {
        self.shows_light
    }

    /// The tracer of the scene with all lights as the files have them; `None` where this is it.
    pub fn full(&self) -> Option<&Arc<Self>> {
        self.full.as_ref()
    }

    /// Returns a tracer of another state of the scene. It shares the hierarchy where the geometry
    /// is the same.
    #[must_use]
    pub fn with_state(&self, scene: Arc<Scene>) -> Self {
        if scene.has_same_geometry(&self.scene) { self.with_same_geometry(scene) } else { Self::new(scene) }
    }

    /// The scene that is traced.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Changes parts that no picture depends on, views and the camera path, also of the scene at
    /// full light.
    pub(super) fn change_views(&mut self, change: impl Fn(&mut Scene)) {
        change(Arc::make_mut(&mut self.scene));
        if let Some(full) = &mut self.full {
            change(Arc::make_mut(&mut Arc::make_mut(full).scene));
        }
    }

    /// The hierarchy over the scene's triangles.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The grid of the lights that matter at each place.
    pub fn light_grid(&self) -> &LightGrid {
        &self.lights
    }

    /// Returns the lights to sample at a point.
    pub(super) fn lights_at(&self, position: Vec3) -> &CellLights {
        self.lights.lights_at(&self.scene, &self.bvh, position)
    }

    /// Identifier of this state of the scene.
    pub fn epoch(&self) -> SceneEpoch {
        self.epoch
    }

    /// Time that building the hierarchy took, seconds.
    pub fn build_secs(&self) -> f64 {
        self.build_secs
    }

    /// Returns the ray through the centre of a pixel; its `t` is depth along the viewing axis.
    pub fn primary_ray(view: &View, pixel: u32) -> Ray {
        Ray::new(view.eye, view.direction_of_pixel(pixel))
    }

    /// Returns the nearest hit along a ray. Cut-out texels are not hit.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        if self.scene.features.checks_hits() {
            self.bvh.closest(ray, |hit| self.stands(ray, hit))
        } else {
            self.bvh.closest(ray, |_| true)
        }
    }

    /// True where a hit counts: it is not cut out, and lies on its triangle.
    pub(super) fn stands(&self, ray: &Ray, hit: &Hit) -> bool {
        let features = self.scene.features;
        self.blocks_light(ray, hit) && (!features.coincident || self.is_seen_first(ray, hit))
    }

    /// True where a hit of a shadow ray counts. Of faces in one place, any of them blocks.
    pub(super) fn blocks_light(&self, ray: &Ray, hit: &Hit) -> bool {
        let features = self.scene.features;
        (!features.alpha || self.is_covered(hit)) && (!features.needles || self.is_in_reach(ray, hit))
    }

    /// False where another face in the same place is seen instead: the one that faces the viewer,
    /// else the first of the model.
    pub(super) fn is_seen_first(&self, ray: &Ray, hit: &Hit) -> bool {
        /// Length, relative to the distance, of the piece of the ray in which the other face is
        /// looked for: 512 units in the last place.
        const SLACK: f32 = 1.0 / 16_384.0;
        /// The same, relative to the coordinates of the face, which bound the rounding of its
        /// distance.
        const ROUNDING: f32 = 1.0 / (1 << 20) as f32;
        let scene = &*self.scene;
        if !scene.is_coincident(hit.triangle) {
            return true;
        }
        let largest = scene.corners(hit.triangle).iter().fold(0.0, |m: f32, p| m.max(p.abs().max_element()));
        let slack = (hit.t * SLACK).max(largest * ROUNDING / ray.direction.length());
        // The ray itself, not a piece of it: both faces are met or missed by the same arithmetic.
        let until = Ray { t_max: ray.t_max.min(hit.t + slack), ..*ray };
        !self.bvh.any(&until, |other| {
            let (a, b) = (hit.triangle, other.triangle);
            other.t >= hit.t - slack
                && scene.is_coincident(b)
                && a != b
                && share_plane(scene.corners(a), scene.corners(b))
                && beats(scene, b, a, ray.direction)
        })
    }

    /// True where a hit lies between the nearest and the farthest corner of its triangle, within
    /// [`REACH_SLACK`]. On needles it may not, because the products of their corners have no more
    /// bits than they are wide (Embree, issue 387).
    fn is_in_reach(&self, ray: &Ray, hit: &Hit) -> bool {
        let along = ray.direction / ray.direction.length_squared();
        let t = self.scene.corners(hit.triangle).map(|corner| (corner - ray.origin).dot(along));
        let (low, high) = (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
        let slack = REACH_SLACK * low.abs().max(high.abs());
        low - slack <= hit.t && hit.t <= high + slack
    }

    /// Alpha test: true where the surface is not cut out.
    pub(super) fn is_covered(&self, hit: &Hit) -> bool {
        let Some(map) = self.scene.material_of(hit.triangle).alpha_texture else { return true };
        let uv = interpolate_uv(&self.scene, hit.triangle, [hit.b1, hit.b2]);
        map.alpha(&self.scene.textures, uv) >= 0.5
    }

    /// Returns the hit of a ray with one triangle, whatever else the ray meets, with the bits of
    /// [`Self::closest`].
    pub fn hit_on_triangle(&self, ray: &Ray, triangle: u32) -> Option<Hit> {
        (triangle != NO_TRIANGLE)
            .then(|| self.bvh.on_triangle(ray, triangle, self.scene.corners(triangle)))
            .flatten()
    }

    /// Returns the diffuse reflectance at the hit of a pixel's ray, per channel, towards the origin
    /// of a ray of this direction (any length), as pictures show it.
    #[inline(always)]
    pub fn albedo(&self, hit: &Hit, direction: Vec3) -> Vec3 {
        if self.shows_light { Vec3::ONE } else { albedo_of_hit(&self.scene, hit, direction) }
    }

    /// Returns the texture coordinate at a hit.
    pub(crate) fn uv(&self, hit: &Hit) -> Vec2 {
        interpolate_uv(&self.scene, hit.triangle, [hit.b1, hit.b2])
    }

    /// Returns the diffuse reflectance of a pixel's surface point, as pictures show it.
    pub(crate) fn albedo_of(&self, point: &SurfacePoint) -> Vec3 {
        if self.shows_light { Vec3::ONE } else { point.albedo(&self.scene) }
    }

    /// Returns the radiance that a pixel's surface point emits, as pictures show it.
    pub(crate) fn emission_of(&self, point: &SurfacePoint) -> Vec3 {
        if self.shows_light { Vec3::ZERO } else { point.emission(&self.scene) }
    }

    /// Returns the radiance emitted at the hit of a pixel's ray, towards the origin of a ray of
    /// this direction (any length), as pictures show it.
    #[inline(always)]
    pub fn emission(&self, hit: &Hit, direction: Vec3) -> Vec3 {
        if self.shows_light {
            return Vec3::ZERO;
        }
        let uv = || interpolate_uv(&self.scene, hit.triangle, [hit.b1, hit.b2]);
        emission_of_hit(&self.scene, hit.triangle, uv, direction)
    }

    /// Material of a surface point, as it is there.
    pub(super) fn material(&self, point: &SurfacePoint) -> Cow<'_, Material> {
        self.scene.materials[point.material.0 as usize].at(&self.scene.textures, || point.uv)
    }

    /// True where part of the radiance of a surface depends on the viewer, so that it must be
    /// traced.
    pub fn is_view_dependent(&self, point: &SurfacePoint) -> bool {
        self.scene.materials[point.material.0 as usize].is_view_dependent()
    }

    /// Returns the surface point of a hit.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        SurfacePoint::new(&self.scene, hit.triangle, [hit.b1, hit.b2], ray.direction)
    }

    /// Returns how well the hit of a ray of this direction on a triangle is determined, 0..1.
    ///
    /// Below [`super::ILL_CONDITIONED`] the hit may be missed or misplaced, and must not be reused.
    pub fn condition(&self, direction: Vec3, triangle: u32) -> f64 {
        super::surface::condition(self.scene.corners(triangle), direction)
    }

    /// Returns the radiance that arrives from a direction (any length) along a ray that leaves the
    /// scene.
    pub fn sky(&self, direction: Vec3) -> Vec3 {
        self.scene.sky.as_ref().map_or(Vec3::ZERO, |s| s.radiance(direction.normalize_or(Vec3::Y)))
    }

    /// Returns the radiance that a direction (any length) of the sky adds to a ray that leaves a
    /// diffuse surface and the scene: without what [`Light::SkySuns`](crate::scene::Light::SkySuns)
    /// brings by shadow rays.
    pub fn diffuse_sky(&self, direction: Vec3) -> Vec3 {
        let sky = self.scene.sky.as_ref();
        sky.map_or(Vec3::ZERO, |s| s.diffuse_radiance(direction.normalize_or(Vec3::Y)))
    }
}
