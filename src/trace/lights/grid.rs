//! The lights that matter at each place: shading must not pay for lamps in other rooms.
//!
//! The scene is divided into cells. When a surface in a cell is shaded for the first time, random
//! lines are drawn from the cell, enlarged by half a cell on each side, to every light. A light
//! that none of n lines reaches is visible along less than 3/n of all lines at 95 % confidence, so
//! it contributes at most 3/n of its unshadowed irradiance. It is culled from the cell once that
//! bound is below [`TOLERANCE`] of the light that does arrive. Cells depend on the scene alone, so
//! every mode, every thread and every run culls the same lights.
//!
//! In a scene of more than [`MAX_LINED_LIGHTS`] lamps, lines are drawn to parts of a tree of them
//! instead, so that a cell takes a bounded time (`cut`).

use super::cut::Sight;
use super::region::{Region, unshadowed};
use super::share::{CellLights, MAX_LIGHTS, Part};
use super::tree::{LightTree, group_of};
use crate::math::key::Key;
use crate::scene::{Light, MAX_LIGHT_GROUPS, Scene};
use crate::trace::Bvh;
use glam::{UVec3, Vec3};
use std::sync::OnceLock;

/// Side of a cell, scene units: 1/32 to 1/64 of the scene's diagonal, about a metre in a house.
const CELL: f32 = 16.0;

/// Largest mean contribution of a culled light, relative to the light in the cell: one of the 256
/// levels of a display.
const TOLERANCE: f32 = 1.0 / 256.0;

/// The same for a part of the tree of lamps, of which a cell may leave out many.
const PART_TOLERANCE: f32 = TOLERANCE / 8.0;

/// Number of lines drawn to every light.
const FIRST_LINES: u32 = 32;

/// Number of them after which the lights that were reached are counted.
const SOME_LINES: u32 = 4;

/// Largest number of lines drawn to a light that none has reached yet.
const MAX_LINES: u32 = 1024;

/// Largest number of lines drawn from one cell to all lights: about 20 ms of shadow rays, because a
/// cell is computed without interruption.
const CELL_LINES: u32 = 1 << 17;

/// Largest number of lamps to each of which lines are drawn. The largest real model at hand, an
/// office of 133 lamps, is below it.
const MAX_LINED_LIGHTS: usize = 256;

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
    /// The lamps that are on; empty in a scene whose cells cannot have too many of them.
    tree: LightTree,
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
    /// Mean number of lights that matter per cell.
    pub kept_mean: f64,
    /// Number of cells with more than 64 lights, of which only some are sampled at each point.
    pub sharing_cells: usize,
}

impl LightGrid {
    /// A grid over a scene, with no cell computed yet.
    pub(in crate::trace) fn new(scene: &Scene) -> Self {
        let bounds = scene.bounds_m.map(|p| scene.frame.scene_from_world_f64(p).as_vec3());
        let tree = if scene.lights.len() > MAX_LIGHTS { LightTree::new(scene) } else { LightTree::default() };
        let all = all_lights(scene, &tree);
        let dimensions = if scene.lights.len() < MIN_LIGHTS {
            UVec3::ZERO
        } else {
            ((bounds[1] - bounds[0]) / CELL).floor().as_uvec3() + 1
        };
        let count = dimensions.as_usizevec3().element_product();
        let cells = (0..count).map(|_| OnceLock::new()).collect();
        Self { low: bounds[0], dimensions, cells, all, tree, lights: scene.lights.len(), is_by_groups: false }
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

    /// The tree of lamps, of which shared cells have parts.
    pub(super) fn tree(&self) -> &LightTree {
        &self.tree
    }

    /// Statistics of the cells used so far.
    pub fn cuts(&self) -> LightCuts {
        let visited: Vec<&CellLights> = self.cells.iter().filter_map(|c| c.get()).collect();
        let kept: usize = visited.iter().map(|c| c.len(&self.tree)).sum();
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
        if self.tree.len() > MAX_LINED_LIGHTS {
            return self.find_parts(scene, bvh, &region);
        }
        let kept = self.find_singly(scene, bvh, &region).filter(|kept| kept.len() <= MAX_LIGHTS);
        kept.map_or_else(|| self.find_parts(scene, bvh, &region), CellLights::few)
    }

    /// The lights of a region where lamps are looked at by parts of their tree.
    fn find_parts(&self, scene: &Scene, bvh: &Bvh, region: &Region) -> CellLights {
        let sight = Sight {
            scene,
            tree: &self.tree,
            region,
            reaches: |light, key| region.reaches(scene, bvh, light, key),
            is_by_groups: self.is_by_groups,
            tolerance: PART_TOLERANCE,
        };
        CellLights::new(&self.tree, distant_lights(scene), sight.parts())
    }

    /// The lights of a region where each lamp is looked at, ascending; `None` where they are too
    /// many to be sampled one by one, which a few lines show.
    fn find_singly(&self, scene: &Scene, bvh: &Bvh, region: &Region) -> Option<Vec<u32>> {
        // Enclose the region in a sphere.
        let (centre, radius) = (region.centre(), region.radius());
        let is_on = |light: &u32| !scene.is_switched_off(*light as usize);
        let all = (0..self.lights as u32).filter(is_on);
        let (mut seen, mut reached) = (vec![false; self.lights], vec![0; self.lights]);
        let first_lines = FIRST_LINES.min((CELL_LINES / self.lights as u32).max(1));
        let mut lines_left = CELL_LINES;
        let group_of = |light: u32| if self.is_by_groups { group_of(scene, light) } else { 0 };
        let reaches = |light, line| region.reaches(scene, bvh, light, region.key.with(light).with(line));
        let mut arriving = [0.0; MAX_LIGHT_GROUPS + 1];
        // Draw a few lines to every light, and stop after some where many lights are reached.
        let some_lines = SOME_LINES.min(first_lines);
        for light in all.clone() {
            reached[light as usize] = (0..some_lines).filter(|&line| reaches(light, line)).count();
        }
        if reached.iter().filter(|reached| **reached > 0).count() > MAX_LIGHTS {
            return None;
        }
        for light in all.clone() {
            let more = (some_lines..first_lines).filter(|&line| reaches(light, line)).count();
            let reached = reached[light as usize] + more;
            let share = reached as f32 / first_lines as f32;
            seen[light as usize] = reached > 0;
            // Estimate the light for the far side of the cell, so that a lamp near the middle does
            // not make the others seem negligible.
            arriving[group_of(light)] += share * unshadowed(&scene.lights[light as usize], centre, -radius);
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
                    lines.any(|line| reaches(light, line))
                }
                None => true,
            };
        }
        Some(all.filter(|&light| seen[light as usize]).collect())
    }
}

/// All lights that are on.
fn all_lights(scene: &Scene, tree: &LightTree) -> CellLights {
    let is_on = |light: &u32| !scene.is_switched_off(*light as usize);
    if tree.len() <= MAX_LIGHTS {
        return CellLights::few((0..scene.lights.len() as u32).filter(is_on).collect());
    }
    let parts = tree.roots().iter().map(|&node| Part { node, visible: 1.0 }).collect();
    CellLights::new(tree, distant_lights(scene), parts)
}

/// The lights at infinity that are on.
fn distant_lights(scene: &Scene) -> Vec<u32> {
    let is_distant = |light: &Light| matches!(light, Light::Sun { .. } | Light::Sky | Light::SkySuns);
    let lights = (0..).zip(&scene.lights);
    let matters =
        |(index, light): &(u32, &Light)| is_distant(light) && !scene.is_switched_off(*index as usize);
    lights.filter(matters).map(|(index, _)| index).collect()
}
