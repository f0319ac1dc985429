//! From a builder to a complete scene. Everything that cannot be traced is dropped and counted
//! here, once.

use super::coincident;
use super::conditioning::{Conditioning, Repairs};
use super::duplicates::Duplicates;
use super::light_groups::{LightGroups, LightSettings};
use super::{
    Light, Material, NamedView, ProfileLight, Scene, SceneBuilder, SceneError, SceneFeatures, SceneFrame,
    SpotLight, bounds, building, is_valid_position, sanitize, views,
};
use crate::camera::CameraPath;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

/// The warning about a scene without any light.
pub(crate) const NO_LIGHT: &str = "the scene has no light";

impl SceneBuilder {
    /// Makes the scene: chooses the scale, drops what cannot be traced, and finds lights and
    /// solids. A scene without light gets a sun and a sky; one without views or a camera path gets
    /// them generated.
    ///
    /// # Errors
    /// [`SceneError::Empty`] if no triangle is left, and [`SceneError::TooLarge`] above 2^32 - 2
    /// vertices or 2^31 - 1 triangles.
    pub fn finish(mut self) -> Result<Scene, SceneError> {
        self.check_sizes()?;
        let count = self.triangles.len();
        self.objects.number();
        if self.materials.is_empty() {
            self.add_material(Material::diffuse("default", Vec3::splat(0.6)));
        }
        let mut repairs = sanitize::sanitize(&mut self);
        let (bounds_m, frame) =
            self.drop_distant(&mut repairs).ok_or_else(|| self.empty_error(count, &repairs))?;
        let positions: Vec<Vec3> =
            self.positions.par_iter().map(|&p| frame.scene_from_world_f64(p).as_vec3()).collect();
        repairs.triangles_without_area =
            self.drop_triangles(|_, t| has_area(t.map(|v| positions[v as usize])), "without area");
        if self.triangles.is_empty() {
            return Err(self.empty_error(count, &repairs));
        }
        self.light_if_dark();
        let (point_lights, settings) = (self.point_lights(&frame), std::mem::take(&mut self.light_settings));
        let mut scene = self.into_scene(positions, frame, bounds_m);
        let duplicates = Duplicates::find(&scene);
        (repairs.duplicates_hidden, repairs.duplicates_seen) = (duplicates.hidden.len(), duplicates.seen);
        scene.hidden = duplicates.hidden;
        scene.coincident = Arc::new(coincident::find(&scene));
        scene.conditioning = Conditioning::of(&scene, repairs);
        scene.features.needles = scene.conditioning.needles > 0;
        scene.derive(point_lights);
        scene.update_light_numbers();
        Ok(if settings.is_empty() { scene } else { Arc::new(scene).with_light_settings(&settings) })
    }

    /// Moves everything into a scene. What follows from the rest is still missing.
    fn into_scene(mut self, positions: Vec<Vec3>, frame: SceneFrame, bounds_m: [DVec3; 2]) -> Scene {
        let building_m = building::extent(&self.positions, &self.triangles, bounds_m, frame.units_per_metre);
        let (walk, [brings_view, brings_walk]) = self.views_and_walk(building_m);
        let is_textured = self.materials.iter().any(|m| m.textures().next().is_some());
        let has_normals = self.normals.iter().any(|n| *n != Vec3::ZERO);
        Scene {
            name: self.name,
            hash: String::new(),
            frame,
            normals: Arc::new(if has_normals { self.normals } else { Vec::new() }),
            uvs: Arc::new(if is_textured { self.uvs } else { Vec::new() }),
            positions: Arc::new(positions),
            triangles: Arc::new(self.triangles),
            triangle_materials: Arc::new(self.triangle_materials),
            objects: Arc::new(self.objects),
            edited_objects: None,
            grounded: None,
            is_ground_given: false,
            solids: Vec::new(),
            materials: self.materials,
            textures: Arc::new(self.textures),
            lights: Vec::new(),
            lamp_triangles: Vec::new(),
            sun: self.sun,
            sky: self.sky,
            light_groups: LightGroups::default(),
            lamp_groups: self.lamp_groups,
            light_settings: LightSettings::default(),
            full: None,
            is_photometric: self.is_photometric,
            views: self.views,
            walk,
            exposure: self.exposure,
            brings_view,
            brings_walk,
            features: SceneFeatures::default(),
            warnings: self.warnings,
            files: Arc::new(self.files),
            bounds_m,
            building_m,
            hidden: Vec::new(),
            coincident: Arc::default(),
            conditioning: Conditioning::default(),
        }
    }

    fn check_sizes(&self) -> Result<(), SceneError> {
        let check = |what, count, limit| {
            if count <= limit {
                return Ok(());
            }
            Err(SceneError::TooLarge { name: self.name.clone(), what, count, limit })
        };
        check("vertices", self.positions.len(), u32::MAX as usize - 1)?;
        check("triangles", self.triangles.len(), i32::MAX as usize)
    }

    /// Drops triangles that are too far away to be traced. Returns the bounding box in metres and
    /// the frame that belongs to it, or `None` if no triangle is left.
    fn drop_distant(&mut self, repairs: &mut Repairs) -> Option<([DVec3; 2], SceneFrame)> {
        /// Largest coordinate in scene units. Products of three coordinates stay below the largest
        /// f32.
        const MAX_COORDINATE: f64 = (1u64 << 40) as f64;
        repairs.triangles_not_finite = self.drop_triangles(
            |b, t| t.iter().all(|&v| b.positions.get(v as usize).is_some_and(|p| is_valid_position(*p))),
            "with a vertex that is missing, not finite or farther than 1e100 m away",
        );
        let (bounds_m, ignores_outliers) = bounds::of(&self.positions, &self.triangles)?;
        repairs.ignores_outliers = ignores_outliers;
        let frame = bounds::frame_for(bounds_m);
        if ignores_outliers {
            self.warn_of_scene(
                "a few vertices lie far outside the rest; centre, scale and views ignore them".to_owned(),
            );
            let is_near = |p: DVec3| frame.scene_from_world_f64(p).abs().max_element() < MAX_COORDINATE;
            repairs.triangles_not_finite += self.drop_triangles(
                |b, t| t.iter().all(|&v| is_near(b.positions[v as usize])),
                "too far from all others",
            );
        }
        Some((bounds_m, frame))
    }

    /// Drops the triangles that `keep` rejects, records a warning, and returns their number.
    fn drop_triangles(&mut self, keep: impl Fn(&Self, [u32; 3]) -> bool + Sync, what: &str) -> usize {
        let kept: Vec<bool> = self.triangles.par_iter().map(|&t| keep(self, t)).collect();
        let dropped = kept.iter().filter(|k| !**k).count();
        if dropped > 0 {
            let mut is_kept = kept.iter();
            self.triangles.retain(|_| is_kept.next() == Some(&true));
            let mut is_kept = kept.iter();
            self.triangle_materials.retain(|_| is_kept.next() == Some(&true));
            self.objects.retain(&kept);
            self.warn_of_scene(format!("{dropped} triangles {what} were left out"));
        }
        dropped
    }

    /// Returns the error of a scene that had this number of triangles and has none left.
    fn empty_error(&self, count: usize, repairs: &Repairs) -> SceneError {
        let (flat, far) = (repairs.triangles_without_area, repairs.triangles_not_finite);
        let cause = match (flat, far) {
            (0, 0) => "it holds no triangles".to_owned(),
            (_, 0) => format!("none of its {count} triangles has an area"),
            (0, _) => format!(
                "each of its {count} triangles has a vertex that is missing, not finite or too far from the others"
            ),
            _ => format!(
                "of its {count} triangles, {flat} have no area, and {far} have a vertex that is missing, not finite or \
                 too far from the others"
            ),
        };
        SceneError::Empty { name: self.name.clone(), cause }
    }

    /// Adds a sun and a sky to a scene without any light, unless its files switch them off.
    fn light_if_dark(&mut self) {
        let is_emissive = self.triangle_materials.iter().any(|m| self.materials[m.0 as usize].is_emissive());
        let has_lamps =
            !(self.point_lights.is_empty() && self.spot_lights.is_empty() && self.profile_lights.is_empty());
        let is_dark = !is_emissive && !has_lamps && self.sun.is_none() && self.sky.is_none();
        if let Some(added) = is_dark.then(|| self.add_clear_day()).flatten() {
            self.warn_of_scene(format!("{NO_LIGHT}; {added}"));
        }
    }

    fn point_lights(&self, frame: &SceneFrame) -> Vec<Light> {
        let square = (frame.units_per_metre * frame.units_per_metre) as f32;
        let light = |&(position, intensity): &(DVec3, Vec3)| Light::Point {
            position: frame.scene_from_world_f64(position).as_vec3(),
            intensity: intensity * square,
            beam: None,
            profile: None,
        };
        let spot = |spot: &SpotLight| Light::Point {
            position: frame.scene_from_world_f64(spot.position_m).as_vec3(),
            intensity: spot.intensity * square,
            beam: Some(spot.beam),
            profile: None,
        };
        let profiled = |lamp: &ProfileLight| Light::Point {
            position: frame.scene_from_world_f64(lamp.position_m).as_vec3(),
            intensity: lamp.intensity * square,
            beam: None,
            profile: Some(Box::new(lamp.profile.clone())),
        };
        let (points, spots) = (self.point_lights.iter().map(light), self.spot_lights.iter().map(spot));
        points.chain(spots).chain(self.profile_lights.iter().map(profiled)).collect()
    }

    /// Generates the view and the camera path that the model does not have. Returns the path, and
    /// which of view and path the model has.
    fn views_and_walk(&mut self, building_m: [DVec3; 2]) -> (CameraPath, [bool; 2]) {
        let own_view = self.views.first().map(|view| view.camera);
        let overview = views::overview(building_m, 0.0, views::USUAL_RISE);
        if own_view.is_none() {
            self.views.push(NamedView { name: "start".to_owned(), camera: overview });
        }
        let has = [own_view.is_some(), self.walk.is_some()];
        let generated = || {
            own_view
                .map_or_else(|| views::orbit(building_m, &overview), |camera| CameraPath::turning(&camera))
        };
        (self.walk.take().unwrap_or_else(generated), has)
    }
}

/// True if the cross product of two edges, computed in f64 from the f32 corners, is not zero.
pub(super) fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    (b - a).cross(c - a).length_squared() > 0.0
}
