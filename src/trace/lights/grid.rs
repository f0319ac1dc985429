//! Which lights matter where: a building with a hundred lamps must not pay for those nobody sees.
//!
//! The scene is cut into cells. When a surface in a cell is shaded for the first time, random lines are drawn from the
//! cell and half a cell around it to every light. A light that none of n lines reaches is seen from less than 3/n of
//! them at 95 % confidence, so it brings at most 3/n of its unshadowed irradiance. It is cut from the cell once that
//! bound is below [`TOLERANCE`] of the light that does arrive. Cells depend on the scene alone, so every mode, every
//! thread and every run cuts the same lights.

use crate::math::Ray;
use crate::math::key::Key;
use crate::math::sampling::lattice;
use crate::scene::{Light, Scene, point_on_mesh};
use crate::trace::Bvh;
use glam::{UVec3, Vec3};
use std::sync::OnceLock;

/// Side of a cell in scene units: 1/32 to 1/64 of the scene's diagonal, about a metre in a house.
const CELL: f32 = 16.0;

/// What a cut light may bring on average, as a share of the light in the cell: one step in the 256 of a display.
const TOLERANCE: f32 = 1.0 / 256.0;

/// Lines drawn to every light, and at most to one that none has reached yet.
const FIRST_LINES: u32 = 32;
const MAX_LINES: u32 = 1024;

/// Lines drawn from one cell in all, some 20 ms at the rate of shadow rays: a cell is found in one go.
const CELL_LINES: u32 = 1 << 17;

/// Fewer lights than this are always all sampled: there is nothing to win.
const FEWEST_LIGHTS: usize = 3;

/// The lights that matter in each cell, found when first asked for.
#[derive(Debug)]
pub struct LightGrid {
    low: Vec3,
    dimensions: UVec3,
    cells: Vec<OnceLock<Box<[u32]>>>,
    all: Box<[u32]>,
}

/// What the cells visited so far have cut.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightCuts {
    /// Cells in which something was shaded.
    pub cells: usize,
    /// Lights in the scene.
    pub lights: usize,
    /// Lights sampled per cell, on average.
    pub kept_mean: f64,
}

impl LightGrid {
    pub(crate) fn new(scene: &Scene) -> Self {
        let all: Box<[u32]> = (0..scene.lights.len() as u32).collect();
        let bounds = scene.bounds_m.map(|p| scene.frame.scene_from_world_f64(p).as_vec3());
        let dimensions = if all.len() < FEWEST_LIGHTS {
            UVec3::ZERO
        } else {
            ((bounds[1] - bounds[0]) / CELL).floor().as_uvec3() + 1
        };
        let count = dimensions.as_usizevec3().element_product();
        Self { low: bounds[0], dimensions, cells: (0..count).map(|_| OnceLock::new()).collect(), all }
    }

    /// The lights to sample at a point, as indices into the scene's.
    pub(crate) fn lights_at(&self, scene: &Scene, bvh: &Bvh, position: Vec3) -> &[u32] {
        if self.cells.is_empty() {
            return &self.all;
        }
        let place = (position - self.low) / CELL;
        // What lies far outside the bulk of the scene has no cell of its own.
        if place.min_element() < -1.0 || (place - self.dimensions.as_vec3()).max_element() > 1.0 {
            return &self.all;
        }
        let at = place.max(Vec3::ZERO).as_uvec3().min(self.dimensions - 1);
        let index = ((at.z * self.dimensions.y + at.y) * self.dimensions.x + at.x) as usize;
        self.cells[index].get_or_init(|| self.find(scene, bvh, index as u32, at))
    }

    /// What has been cut so far.
    pub fn cuts(&self) -> LightCuts {
        let visited: Vec<usize> = self.cells.iter().filter_map(|c| c.get()).map(|c| c.len()).collect();
        let kept: usize = visited.iter().sum();
        LightCuts {
            cells: visited.len(),
            lights: self.all.len(),
            kept_mean: kept as f64 / visited.len().max(1) as f64,
        }
    }

    fn find(&self, scene: &Scene, bvh: &Bvh, index: u32, at: UVec3) -> Box<[u32]> {
        let low = self.low + at.as_vec3() * CELL - CELL / 2.0;
        let region = Region { low, size: CELL * 2.0, key: Key::of_pixel(0, index) };
        let mut seen = vec![false; self.all.len()];
        let first_lines = FIRST_LINES.min((CELL_LINES / self.all.len() as u32).max(1));
        let mut lines_left = CELL_LINES;
        let mut arriving = 0.0;
        for &light in &self.all {
            let lines = 0..first_lines;
            let reached = lines.filter(|&line| region.reaches(scene, bvh, light, line)).count();
            let share = reached as f32 / first_lines as f32;
            seen[light as usize] = reached > 0;
            // As from the cell's far side, so that a lamp near its middle does not drown the others.
            arriving += share * unshadowed(&scene.lights[light as usize], region.centre(), -region.radius());
        }
        for &light in self.all.iter().filter(|&&light| !seen[light as usize]).collect::<Vec<_>>() {
            let most = unshadowed(&scene.lights[light as usize], region.centre(), region.radius());
            // In a dark cell every light counts; the quotient is then infinite.
            let needed = (3.0 * most / (TOLERANCE * arriving)).min(MAX_LINES as f32) as u32;
            let mut lines = first_lines..needed.max(first_lines);
            // A light there are no lines left for is kept: it may be seen.
            seen[light as usize] = match lines_left.checked_sub(lines.len() as u32) {
                Some(left) => {
                    lines_left = left;
                    lines.any(|line| region.reaches(scene, bvh, light, line))
                }
                None => true,
            };
        }
        self.all.iter().copied().filter(|&light| seen[light as usize]).collect()
    }
}

/// A cell with its surroundings.
struct Region {
    low: Vec3,
    size: f32,
    key: Key,
}

impl Region {
    fn centre(&self) -> Vec3 {
        self.low + self.size / 2.0
    }

    /// Of the sphere around it.
    fn radius(&self) -> f32 {
        self.size / 2.0 * 3f32.sqrt()
    }

    /// True where line `line` from the region to a light meets nothing opaque.
    fn reaches(&self, scene: &Scene, bvh: &Bvh, light: u32, line: u32) -> bool {
        let key = self.key.with(light).with(line);
        let [x, y] = key.pair();
        let [z, _] = key.with(1).pair();
        let from = self.low + Vec3::new(x, y, z) * self.size;
        let Some(to) = point_on(&scene.lights[light as usize], key.with(2).pair()) else { return true };
        // Textured cut-outs and glass let light through: they never hide a lamp for good.
        !bvh.any(&Ray::segment(from, to), |hit| scene.material_of(hit.triangle).is_opaque())
    }
}

/// A random point of a light; `None` for lights without a place, which are never cut.
fn point_on(light: &Light, random: [f32; 2]) -> Option<Vec3> {
    let u = lattice(0, 1, random);
    match light {
        Light::Quad { corner, edge_u, edge_v, .. } => Some(*corner + *edge_u * u[0] + *edge_v * u[1]),
        Light::Triangles { corners, cumulative_area, .. } => {
            Some(point_on_mesh(corners, cumulative_area, u).0)
        }
        Light::Point { position, .. } => Some(*position),
        Light::Sun { .. } | Light::Sky => None,
    }
}

/// The largest channel of the irradiance a light can bring to a point within `slack` of `at` with nothing in the way.
fn unshadowed(light: &Light, at: Vec3, slack: f32) -> f32 {
    let falloff = |centre: Vec3, radius: f32| {
        let nearest = (centre.distance(at) - radius - slack).max(0.0);
        1.0 / (nearest * nearest).max(f32::MIN_POSITIVE)
    };
    match light {
        Light::Quad { corner, edge_u, edge_v, radiance } => {
            let (centre, radius) = (*corner + (*edge_u + *edge_v) / 2.0, (*edge_u + *edge_v).length() / 2.0);
            let solid_angle = edge_u.cross(*edge_v).length() * falloff(centre, radius);
            radiance.max_element() * solid_angle.min(std::f32::consts::PI)
        }
        Light::Triangles { corners, area, radiance, .. } => {
            let points = || corners.iter().flatten().copied();
            let (low, high) =
                points().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
            let solid_angle = area * falloff((low + high) / 2.0, (high - low).length() / 2.0);
            radiance.max_element() * solid_angle.min(std::f32::consts::PI)
        }
        Light::Point { position, intensity } => intensity.max_element() * falloff(*position, 0.0),
        Light::Sun { irradiance, .. } => irradiance.max_element(),
        Light::Sky => 0.0,
    }
}
