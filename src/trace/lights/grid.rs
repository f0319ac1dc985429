//! The lights that matter at each place: shading must not pay for lamps in other rooms.
//!
//! The scene is divided into cells. When a surface in a cell is shaded for the first time, random
//! lines are drawn from the cell, enlarged by half a cell on each side, to every light. A light
//! that none of n lines reaches is visible along less than 3/n of all lines at 95 % confidence, so
//! it contributes at most 3/n of its unshadowed irradiance. It is culled from the cell once that
//! bound is below [`TOLERANCE`] of the light that does arrive. Cells depend on the scene alone, so
//! every mode, every thread and every run culls the same lights.

use super::sample::point_on;
use super::share::CellLights;
use crate::math::{Ray, key::Key};
use crate::scene::{Light, MAX_LIGHT_GROUPS, Scene};
use crate::trace::Bvh;
use glam::{UVec3, Vec3};
use std::sync::OnceLock;

/// Side of a cell, scene units: 1/32 to 1/64 of the scene's diagonal, about a metre in a house.
const CELL: f32 = 16.0;

/// Largest mean contribution of a culled light, relative to the light in the cell: one of the 256
/// levels of a display.
const TOLERANCE: f32 = 1.0 / 256.0;

/// Number of lines drawn to every light.
const FIRST_LINES: u32 = 32;

/// Largest number of lines drawn to a light that none has reached yet.
const MAX_LINES: u32 = 1024;

/// Largest number of lines drawn from one cell to all lights: about 20 ms of shadow rays, because a
/// cell is computed without interruption.
const CELL_LINES: u32 = 1 << 17;

/// Smallest number of lights for which any is culled: with fewer nothing is gained.
const MIN_LIGHTS: usize = 3;

/// The lights that matter in each cell, computed at its first use.
#[derive(Debug)]
pub struct LightGrid {
    /// Lower corner of the grid, scene space.
    low: Vec3,
    /// Number of cells along each axis.
    dimensions: UVec3,
    /// Lights of each cell; no cells in a scene of few lights.
    cells: Vec<OnceLock<CellLights>>,
    /// All lights that are on.
    all: CellLights,
    /// Number of lights in the scene.
    lights: usize,
    /// Lights are compared with others of their group only.
    is_by_groups: bool,
}

/// Statistics of the lights that the cells used so far have culled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightCuts {
    /// Number of cells in which a surface was shaded.
    pub cells: usize,
    /// Number of lights in the scene.
    pub lights: usize,
    /// Mean number of lights sampled per cell.
    pub kept_mean: f64,
    /// Number of cells with more than 64 lights, which share the samples of 64.
    pub sharing_cells: usize,
}

impl LightGrid {
    /// A grid over a scene, with no cell computed yet.
    pub(in crate::trace) fn new(scene: &Scene) -> Self {
        let bounds = scene.bounds_m.map(|p| scene.frame.scene_from_world_f64(p).as_vec3());
        let all = all_lights(scene, (bounds[0] + bounds[1]) / 2.0, bounds[0].distance(bounds[1]) / 2.0);
        let dimensions = if scene.lights.len() < MIN_LIGHTS {
            UVec3::ZERO
        } else {
            ((bounds[1] - bounds[0]) / CELL).floor().as_uvec3() + 1
        };
        let count = dimensions.as_usizevec3().element_product();
        let cells = (0..count).map(|_| OnceLock::new()).collect();
        Self { low: bounds[0], dimensions, cells, all, lights: scene.lights.len(), is_by_groups: false }
    }

    /// A grid that compares each light with others of its group.
    pub(in crate::trace) fn by_groups(scene: &Scene) -> Self {
        Self { is_by_groups: true, ..Self::new(scene) }
    }

    /// Returns the lights to sample at a point.
    pub(in crate::trace) fn lights_at(&self, scene: &Scene, bvh: &Bvh, position: Vec3) -> &CellLights {
        if self.cells.is_empty() {
            return &self.all;
        }
        let place = (position - self.low) / CELL;
        // Points far outside the bulk of the scene have no cell.
        if place.min_element() < -1.0 || (place - self.dimensions.as_vec3()).max_element() > 1.0 {
            return &self.all;
        }
        let at = place.max(Vec3::ZERO).as_uvec3().min(self.dimensions - 1);
        let index = ((at.z * self.dimensions.y + at.y) * self.dimensions.x + at.x) as usize;
        self.cells[index].get_or_init(|| self.find(scene, bvh, index as u32, at))
    }

    /// Statistics of the cells used so far.
    pub fn cuts(&self) -> LightCuts {
        let visited: Vec<&CellLights> = self.cells.iter().filter_map(|c| c.get()).collect();
        let kept: usize = visited.iter().map(|c| c.len()).sum();
        LightCuts {
            cells: visited.len(),
            lights: self.lights,
            kept_mean: kept as f64 / visited.len().max(1) as f64,
            sharing_cells: visited.iter().filter(|c| c.is_shared()).count(),
        }
    }

    /// Computes the lights of cell `index`, which lies at `at`.
    fn find(&self, scene: &Scene, bvh: &Bvh, index: u32, at: UVec3) -> CellLights {
        let low = self.low + at.as_vec3() * CELL - CELL / 2.0;
        let region = Region { low, size: CELL * 2.0, key: Key::of_pixel(0, index) };
        // Enclose the region in a sphere.
        let (centre, radius) = (region.low + region.size / 2.0, region.size / 2.0 * 3f32.sqrt());
        let is_on = |light: &u32| !scene.is_switched_off(*light as usize);
        let all = (0..self.lights as u32).filter(is_on);
        let (mut seen, mut estimates) = (vec![false; self.lights], vec![0.0; self.lights]);
        let first_lines = FIRST_LINES.min((CELL_LINES / self.lights as u32).max(1));
        let mut lines_left = CELL_LINES;
        let group_of = |light: u32| match scene.light_groups.of_light.get(light as usize) {
            Some(&group) if self.is_by_groups => usize::from(group).min(MAX_LIGHT_GROUPS),
            _ => 0,
        };
        let mut arriving = [0.0; MAX_LIGHT_GROUPS + 1];
        // Draw a few lines to every light.
        for light in all.clone() {
            let lines = 0..first_lines;
            let reached = lines.filter(|&line| region.reaches(scene, bvh, light, line)).count();
            let share = reached as f32 / first_lines as f32;
            seen[light as usize] = reached > 0;
            // Estimate the light for the far side of the cell, so that a lamp near the middle does
            // not make the others seem negligible.
            estimates[light as usize] = share * unshadowed(&scene.lights[light as usize], centre, -radius);
            arriving[group_of(light)] += estimates[light as usize];
        }
        // Draw more lines to each light that none has reached, until its bound is low enough.
        for light in all.clone().filter(|&light| !seen[light as usize]).collect::<Vec<_>>() {
            let most = unshadowed(&scene.lights[light as usize], centre, radius);
            // In a dark cell the quotient is infinite: every light counts.
            let needed = (3.0 * most / (TOLERANCE * arriving[group_of(light)])).min(MAX_LINES as f32) as u32;
            let mut lines = first_lines..needed.max(first_lines);
            // Keep a light for which no lines are left: it may be visible.
            seen[light as usize] = match lines_left.checked_sub(lines.len() as u32) {
                Some(left) => {
                    lines_left = left;
                    lines.any(|line| region.reaches(scene, bvh, light, line))
                }
                None => true,
            };
        }
        let kept = all.filter(|&light| seen[light as usize]);
        weighed(scene, kept.map(|light| (light, estimates[light as usize])).collect())
    }
}

/// All lights, with estimates for the far side of a sphere around the scene.
fn all_lights(scene: &Scene, centre: Vec3, radius: f32) -> CellLights {
    let estimate = |(index, light)| (index, unshadowed(light, centre, -radius));
    let is_on = |(index, _): &(u32, &Light)| !scene.is_switched_off(*index as usize);
    weighed(scene, (0..).zip(&scene.lights).filter(is_on).map(estimate).collect())
}

/// Lights with their estimated irradiance. The sky is worth all the others: it is large, and a
/// place where it is hidden is not known here.
fn weighed(scene: &Scene, mut lights: Vec<(u32, f32)>) -> CellLights {
    let sum: f32 = lights.iter().map(|(_, estimate)| estimate).sum();
    for (index, estimate) in &mut lights {
        if matches!(scene.lights[*index as usize], Light::Sky) {
            *estimate = sum.max(f32::MIN_POSITIVE);
        }
    }
    CellLights::new(&lights)
}

/// A cell, enlarged by half a cell on each side.
struct Region {
    low: Vec3,
    size: f32,
    key: Key,
}

impl Region {
    /// True where line number `line` from the region to a light meets nothing opaque.
    fn reaches(&self, scene: &Scene, bvh: &Bvh, light: u32, line: u32) -> bool {
        let key = self.key.with(light).with(line);
        let [x, y] = key.pair();
        let [z, _] = key.with(1).pair();
        let from = self.low + Vec3::new(x, y, z) * self.size;
        let Some(to) = point_on(&scene.lights[light as usize], key.with(2).pair()) else { return true };
        // Glass and cut-out texels let light through, so they hide no lamp for certain.
        !bvh.any(&Ray::segment(from, to), |hit| scene.material_of(hit.triangle).is_opaque())
    }
}

/// Returns a bound on the unshadowed irradiance (largest channel) that a light brings to a point
/// within `slack` of `at`.
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
        Light::Triangles { corners, area, radiance, picture, .. } => {
            let points = || Light::outline(corners, picture).iter().flatten().copied();
            let (low, high) =
                points().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
            let solid_angle = area * falloff((low + high) / 2.0, (high - low).length() / 2.0);
            // Near a bright part of a picture, its mean over the hemisphere is no bound.
            let most = if picture.is_some() { f32::MAX } else { std::f32::consts::PI };
            radiance.max_element() * solid_angle.min(most)
        }
        Light::Point { position, intensity, .. } => intensity.max_element() * falloff(*position, 0.0),
        Light::Sun { irradiance, .. } => irradiance.max_element(),
        Light::Sky | Light::SkySuns => 0.0,
    }
}
