//! The geometry of an added [`Ground`].
//!
//! It is geometry like any other, added after the triangles of the model, so that these keep their
//! numbers. Box, scale, building and views of the scene do not know it. It is divided finely below
//! the building and coarsely far away, so that no triangle is much larger than its distance: hits
//! near the building are as exact as those of the model.

use super::ground::{Ground, GroundAdvice, GroundChoice, GroundedGeometry};
use super::{Material, MaterialId, Scene};
use glam::{DVec2, DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

/// Distance of the ground below its height, relative to the building's diagonal, so that a floor at
/// that height is seen and not the ground: a quarter of a millimetre for a house, and far more than
/// the rounding of hits near it.
const GAP: f64 = 1.0 / 65_536.0;

/// Half the side of the finely divided square, relative to half the diagonal of the plan.
const INNER: f64 = 1.25;

/// Number of pieces along each side of a square.
const PIECES: usize = 8;

/// Number of rings around the inner square, each twice as wide as the one before. The edge lies
/// at some 300 diagonals, where it meets the horizon within a pixel.
const RINGS: i32 = 9;

/// Largest distance of the ground from the building, in diagonals.
const MAX_AWAY: f64 = 64.0;

/// Smallest area of level triangles that reach beyond the building at which they are a ground,
/// relative to the area of the building's plan.
const MIN_OWN_GROUND: f64 = 0.5;

/// Distance by which a ground reaches beyond the building, in diagonals; less is rounding.
const BEYOND: f64 = 1e-3;

/// Smallest cosine of the slope of a ground.
const MIN_LEVEL: f32 = 0.7;

impl Scene {
    /// The ground that was added to the model.
    pub fn ground(&self) -> Option<Ground> {
        self.grounded.as_ref().map(|grounded| grounded.ground)
    }

    /// True for triangles of the ground that was added.
    pub fn is_added_ground(&self, triangle: u32) -> bool {
        self.grounded.as_ref().is_some_and(|g| triangle as usize >= g.bare.triangles.len())
    }

    /// Returns the materials of the model, without that of an added ground.
    pub fn model_materials(&self) -> &[Material] {
        &self.materials[..self.materials.len() - usize::from(self.grounded.is_some())]
    }

    /// The ground at the lowest point of the building.
    pub fn lowest_ground(&self) -> Ground {
        Ground { height_m: self.building_m[0].y, albedo: Ground::DEFAULT_ALBEDO }
    }

    /// Whether the scene wants a ground, and why not.
    pub fn ground_advice(&self) -> GroundAdvice {
        self.ground_advice_with(|| self.has_own_ground())
    }

    /// Returns the same where it is known whether the model has a ground of its own: to find that
    /// out takes a look at every triangle.
    pub fn ground_advice_with(&self, has_own: impl FnOnce() -> bool) -> GroundAdvice {
        if self.sun.is_none() && self.sky.is_none() {
            GroundAdvice::NoDaylight
        } else if has_own() {
            GroundAdvice::HasOwn
        } else {
            GroundAdvice::Wanted
        }
    }

    /// Returns this scene with the ground of a choice.
    #[must_use]
    pub fn with_ground_choice(&self, choice: GroundChoice) -> Self {
        let ground = match choice {
            // What the scene's files say of it counts.
            GroundChoice::Auto if self.is_ground_given => return self.clone(),
            GroundChoice::Auto => {
                (self.ground_advice() == GroundAdvice::Wanted).then(|| self.lowest_ground())
            }
            GroundChoice::Off => None,
            GroundChoice::At(height_m) => Some(Ground { height_m, ..self.lowest_ground() }),
        };
        self.with_edit(&super::SceneEdit { ground, ..self.to_edit() })
    }

    /// True where level triangles low in the model reach beyond the building, and are about as wide
    /// as it.
    pub fn has_own_ground(&self) -> bool {
        let [low, high] = self.building_m.map(|p| self.frame.scene_from_world_f64(p).as_vec3());
        let margin = (high - low).length() * BEYOND as f32;
        let middle = f32::midpoint(low.y, high.y);
        let area = |t: u32| {
            let [a, b, c] = self.corners(t);
            let normal = (b - a).cross(c - a) / 2.0;
            let (least, most) = (a.min(b).min(c), a.max(b).max(c));
            let sticks_out = [least.x < low.x - margin, least.z < low.z - margin]
                .into_iter()
                .chain([most.x > high.x + margin, most.z > high.z + margin]);
            let is_low = (a.y + b.y + c.y) / 3.0 < middle;
            let is_level = normal.y.abs() >= MIN_LEVEL * normal.length();
            let counts = is_low && is_level && sticks_out.into_iter().any(|sticks| sticks);
            if counts { f64::from(normal.y.abs()) } else { 0.0 }
        };
        let count = self.grounded.as_ref().map_or(self.triangles.len(), |g| g.bare.triangles.len()) as u32;
        // Summed in order, so that the sum has the same bits at any number of threads.
        let areas: Vec<f64> = (0..count).into_par_iter().map(area).collect();
        let plan = f64::from((high.x - low.x) * (high.z - low.z));
        areas.iter().sum::<f64>() > MIN_OWN_GROUND * plan
    }

    /// True where a ground can be that far from the model.
    fn can_have(&self, ground: &Ground) -> bool {
        let [low, high] = self.building_m;
        let away = (low.y - ground.height_m).max(ground.height_m - high.y);
        away <= MAX_AWAY * (high - low).length() && self.triangles.len() < (i32::MAX - 10_000) as usize
    }

    /// Returns this scene without the ground that was added: the very geometry from before.
    pub(super) fn without_ground(&self) -> Self {
        let mut scene = self.clone();
        if let Some(grounded) = scene.grounded.take() {
            scene.materials.pop();
            scene.set_geometry(&grounded.bare);
        }
        scene
    }

    /// Returns this scene, which has no ground, on a ground; without one where it is impossible.
    /// Where `like`, another state, has the same geometry and ground, the geometry is shared.
    pub(super) fn on_ground(mut self, ground: Option<Ground>, like: &Self) -> Self {
        let Some(ground) = ground.filter(|ground| self.can_have(ground)) else { return self };
        let bare = self.bare_geometry();
        let (from, to) = Ground::ALBEDOS.into_inner();
        let albedo = Vec3::splat(ground.albedo.clamp(from, to));
        self.materials.push(Material::diffuse("Ground", albedo));
        let shared = like.grounded.as_ref().filter(|other| {
            other.ground.height_m == ground.height_m
                && Arc::ptr_eq(&other.bare.triangles, &bare.triangles)
                && Arc::ptr_eq(&other.bare.positions, &bare.positions)
        });
        if shared.is_some() {
            (self.positions, self.normals, self.uvs) =
                (like.positions.clone(), like.normals.clone(), like.uvs.clone());
            (self.triangles, self.triangle_materials, self.objects) =
                (like.triangles.clone(), like.triangle_materials.clone(), like.objects.clone());
        } else {
            self.add_triangles(ground.height_m);
        }
        self.extend_coincident();
        self.grounded = Some(Arc::new(GroundedGeometry { ground, bare }));
        self
    }

    fn add_triangles(&mut self, height_m: f64) {
        let (points, triangles) = self.ground_mesh(height_m);
        let first = self.positions.len() as u32;
        Arc::make_mut(&mut self.objects).begin(self.triangles.len() as u32, None);
        if !self.normals.is_empty() {
            Arc::make_mut(&mut self.normals).extend(points.iter().map(|_| Vec3::ZERO));
        }
        if !self.uvs.is_empty() {
            Arc::make_mut(&mut self.uvs).extend(points.iter().map(|_| Vec2::ZERO));
        }
        let material = MaterialId(self.materials.len() as u32 - 1);
        Arc::make_mut(&mut self.triangle_materials).extend(triangles.iter().map(|_| material));
        Arc::make_mut(&mut self.triangles).extend(triangles.iter().map(|t| t.map(|v| first + v)));
        Arc::make_mut(&mut self.positions).extend(points);
    }

    /// The ground lies on nothing.
    fn extend_coincident(&mut self) {
        if !self.coincident.is_empty() {
            let count = self.triangles.len();
            Arc::make_mut(&mut self.coincident).resize(count, false);
        }
    }

    /// Returns vertices in scene space and triangles that face up.
    fn ground_mesh(&self, height_m: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let [low, high] = self.building_m.map(|p| self.frame.scene_from_world_f64(p));
        let diagonal = (high - low).length();
        let height = self.frame.scene_from_world_f64(DVec3::new(0.0, height_m, 0.0)).y - diagonal * GAP;
        let plan = DVec2::new(high.x - low.x, high.z - low.z).length().max(diagonal * BEYOND);
        let (middle, half) = ((low + high) / 2.0, plan / 2.0 * INNER);
        let vertex = |at: DVec2| DVec3::new(middle.x + half * at.x, height, middle.z + half * at.y).as_vec3();
        let (points, triangles) = unit_mesh();
        (points.into_iter().map(vertex).collect(), triangles)
    }
}

/// Returns the ground around a square from -1 to 1: points on the plan, x and z, and triangles that
/// face up. Neighbours share their vertices, so that no ray falls through.
fn unit_mesh() -> (Vec<DVec2>, Vec<[u32; 3]>) {
    let side = PIECES as u32 + 1;
    let along = |i: u32| f64::from(i) / PIECES as f64 * 2.0 - 1.0;
    let mut points: Vec<DVec2> =
        (0..side * side).map(|i| DVec2::new(along(i % side), along(i / side))).collect();
    let mut triangles = Vec::new();
    let mut quad = |[a, b, c, d]: [u32; 4]| triangles.extend([[a, b, c], [a, c, d]]);
    for (x, z) in (0..side - 1).flat_map(|z| (0..side - 1).map(move |x| (x, z))) {
        let at = |x: u32, z: u32| z * side + x;
        quad([at(x, z), at(x, z + 1), at(x + 1, z + 1), at(x + 1, z)]);
    }
    let mut ring = border(side);
    for step in 1..=RINGS {
        let first = points.len() as u32;
        let outer: Vec<u32> = (0..ring.len() as u32).map(|i| first + i).collect();
        let wider = border(side).into_iter().map(|i| points[i as usize] * f64::from(1 << step));
        points.extend(wider.collect::<Vec<_>>());
        for i in 0..ring.len() {
            let next = (i + 1) % ring.len();
            quad([ring[i], ring[next], outer[next], outer[i]]);
        }
        ring = outer;
    }
    (points, triangles)
}

/// Returns the vertices around the inner square, counter-clockwise on a plan with z pointing down.
fn border(side: u32) -> Vec<u32> {
    let last = side - 1;
    let top = 0..last;
    let right = (0..last).map(|z| z * side + last);
    let bottom = (0..last).map(|x| last * side + last - x);
    let left = (0..last).map(|z| (last - z) * side);
    top.chain(right).chain(bottom).chain(left).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mesh_has_no_holes_and_faces_up() {
        let (points, triangles) = unit_mesh();
        let mut area = 0.0;
        let mut edges = std::collections::HashMap::new();
        for [a, b, c] in &triangles {
            let [p, q, r] = [a, b, c].map(|v| points[*v as usize]);
            // With z as the second coordinate, a triangle that faces up is negative.
            let twice = (q - p).perp_dot(r - p);
            assert!(twice < 0.0, "{p} {q} {r}");
            area -= twice / 2.0;
            for edge in [[a, b], [b, c], [c, a]] {
                *edges.entry([*edge[0].min(edge[1]), *edge[0].max(edge[1])]).or_insert(0) += 1;
            }
        }
        let half = f64::from(1 << RINGS);
        assert!((area / (4.0 * half * half) - 1.0).abs() < 1e-12);
        let open = edges.iter().filter(|(_, count)| **count == 1).count();
        assert_eq!(open, 4 * PIECES, "only the outermost square has open edges");
        assert!(edges.values().all(|count| *count <= 2));
    }
}
