//! Spatial index of references: for each cell of the scene, which references hold light there.
//!
//! The scene is divided into a grid of cells with one bit per reference. A look-up then visits only
//! references that lit a surface near its point, wherever the viewer stands and however many
//! references there are.

use super::ReferenceFrame;
use crate::math::rounding::round;
use crate::scene::Scene;
use glam::{UVec3, Vec3};
use rayon::prelude::*;

/// Maximum number of references in a directory.
pub const MAX_SLOTS: usize = 128;

/// Maximum number of cells: 4 MB of bits, which stay in a processor's cache.
const MAX_CELLS: f32 = (1 << 18) as f32;

/// Set of references, one bit per slot.
pub type SlotMask = u128;

/// For each cell of the scene, the references that lit a surface in it.
#[derive(Clone, Debug, Default)]
pub struct Directory {
    low: Vec3,
    cells_per_unit: f32,
    dimensions: UVec3,
    masks: Vec<SlotMask>,
    normals: Vec<PackedNormal>,
}

/// Unit normal of a triangle in three bytes. Its direction is off by less than half a degree, its
/// length by up to one percent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackedNormal([i8; 3]);

/// Minimum cosine between the normals of two triangles that share light: eight degrees.
pub(crate) const ALIKE_COSINE: f32 = 0.99;

impl PackedNormal {
    /// No normal.
    pub(crate) const ZERO: Self = Self([0; 3]);

    fn of([a, b, c]: [Vec3; 3]) -> Self {
        Self::of_unit((b - a).cross(c - a).normalize_or(Vec3::Y))
    }

    /// Packs a unit vector.
    #[inline(always)]
    pub(crate) fn of_unit(normal: Vec3) -> Self {
        let n = normal * 127.0;
        Self([round(n.x) as i8, round(n.y) as i8, round(n.z) as i8])
    }

    /// True if two triangles have similar orientation, within [`ALIKE_COSINE`], regardless of their
    /// winding.
    #[inline(always)]
    pub(crate) fn is_like(self, other: Self) -> bool {
        let along = self.dot(other);
        // Divide by the lengths: rounded, they alone would separate triangles of one plane.
        along * along >= ALIKE_COSINE * ALIKE_COSINE * self.dot(self) * other.dot(other)
    }

    /// True if two triangles have similar orientation and face the same way.
    #[inline(always)]
    pub(crate) fn faces_like(self, other: Self) -> bool {
        self.dot(other) > 0.0 && self.is_like(other)
    }

    #[inline(always)]
    fn dot(self, other: Self) -> f32 {
        (0..3).map(|i| i32::from(self.0[i]) * i32::from(other.0[i])).sum::<i32>() as f32
    }
}

impl Directory {
    /// Creates an empty directory for a scene.
    pub fn new(scene: &Scene) -> Self {
        let [low, high] = scene.bounds_m.map(|p| scene.frame.scene_from_world_f64(p).as_vec3());
        // A flat scene is still one cell thick.
        let extent = (high - low).max(Vec3::splat((high - low).max_element() / 1024.0 + f32::MIN_POSITIVE));
        let cell = (extent.element_product() / (MAX_CELLS / 2.0)).cbrt().max(extent.max_element() / 512.0);
        let dimensions = (extent / cell).floor().as_uvec3() + 1;
        let count = dimensions.as_usizevec3().element_product();
        let triangles = 0..scene.triangles.len() as u32;
        let normals = triangles.into_par_iter().map(|t| PackedNormal::of(scene.corners(t))).collect();
        Self { low, cells_per_unit: 1.0 / cell, dimensions, masks: vec![0; count], normals }
    }

    /// Packed normal of each triangle.
    pub(crate) fn normals(&self) -> &[PackedNormal] {
        &self.normals
    }

    /// Number of cells.
    pub(crate) fn cells(&self) -> usize {
        self.masks.len()
    }

    /// Index of the cell that contains a point in scene space. Points outside belong to the nearest
    /// cell.
    #[inline(always)]
    pub(crate) fn cell_of(&self, position: Vec3) -> u32 {
        self.index(self.coordinates(position))
    }

    #[inline(always)]
    fn coordinates(&self, position: Vec3) -> UVec3 {
        ((position - self.low) * self.cells_per_unit).max(Vec3::ZERO).as_uvec3().min(self.dimensions - 1)
    }

    #[inline(always)]
    fn index(&self, at: UVec3) -> u32 {
        (at.z * self.dimensions.y + at.y) * self.dimensions.x + at.x
    }

    /// Indices of a cell and of those that touch it.
    pub(crate) fn cells_around(&self, cell: u32) -> impl Iterator<Item = u32> + '_ {
        let [width, height] = [self.dimensions.x, self.dimensions.y];
        let at = UVec3::new(cell % width, cell / width % height, cell / width / height);
        let (low, high) = (at.saturating_sub(UVec3::ONE), (at + 1).min(self.dimensions - 1));
        (low.z..=high.z).flat_map(move |z| {
            (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| self.index(UVec3::new(x, y, z))))
        })
    }

    /// References that lit a surface in a cell.
    #[inline(always)]
    pub(crate) fn mask(&self, cell: u32) -> SlotMask {
        self.masks[cell as usize]
    }

    /// Adds a reference's lit pixels to the cells, under a slot; also those whose light is stale.
    pub(crate) fn add(&mut self, frame: &ReferenceFrame, slot: usize) {
        let width = frame.view.size[0].max(1);
        let step = frame.view.scene_from_pixel.x_axis.length();
        let cells: Vec<Vec<u32>> = (0..frame.view.size[1])
            .into_par_iter()
            .map(|y| {
                let (mut cells, mut last) = (Vec::new(), None);
                let lit = (y * width..(y + 1) * width).filter(|&pixel| frame.was_lit(pixel));
                for pixel in lit.filter(|&pixel| frame.disparity()[pixel as usize] > 0.0) {
                    let position = frame.view.eye + frame.offset_from_eye(pixel);
                    // A sample may be looked up from as far away as the next sample. The reach is
                    // limited to one cell, so that the cost stays bounded however coarse the
                    // samples are.
                    let reach = (step / frame.disparity()[pixel as usize]).min(1.0 / self.cells_per_unit);
                    let reach = Vec3::splat(reach);
                    let touched = [position - reach, position + reach].map(|p| self.coordinates(p));
                    if last.replace(touched) != Some(touched) {
                        self.cells_between(touched, &mut cells);
                    }
                }
                cells.dedup();
                cells
            })
            .collect();
        for cell in cells.into_iter().flatten() {
            self.masks[cell as usize] |= 1 << slot;
        }
    }

    /// Appends the indices of all cells in a box.
    fn cells_between(&self, [low, high]: [UVec3; 2], cells: &mut Vec<u32>) {
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                cells.extend((low.x..=high.x).map(|x| self.index(UVec3::new(x, y, z))));
            }
        }
    }

    /// Removes all references.
    pub(crate) fn clear(&mut self) {
        self.masks.fill(0);
    }

    /// Removes the reference in a slot.
    pub(crate) fn remove(&mut self, slot: usize) {
        self.masks.par_iter_mut().with_min_len(1 << 14).for_each(|mask| *mask &= !(1 << slot));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(axis: Vec3, degrees: f32, start: Vec3) -> PackedNormal {
        let n = glam::Quat::from_axis_angle(axis, degrees.to_radians()) * start;
        let (e1, e2) = n.any_orthonormal_pair();
        PackedNormal::of([Vec3::ZERO, e1, e2])
    }

    #[test]
    fn equal_normals_are_alike_and_ten_degrees_are_not_wherever_they_point() {
        for i in 0..2000u32 {
            let t = i as f32 * 2.399_963;
            let z = (i as f32 + 0.5) / 1000.0 - 1.0;
            let start = Vec3::new((1.0 - z * z).sqrt() * t.cos(), (1.0 - z * z).sqrt() * t.sin(), z);
            let axis = start.any_orthonormal_vector();
            let normal = turned(axis, 0.0, start);
            assert!(normal.is_like(normal) && normal.is_like(turned(axis, 180.0, start)), "{start}");
            assert!(normal.is_like(turned(axis, 6.0, start)), "{start}");
            assert!(!normal.is_like(turned(axis, 10.0, start)), "{start}");
        }
    }
}
