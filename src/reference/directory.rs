//! Which references know the light of which part of the scene.
//!
//! The scene is cut into cells; each holds one bit per reference. A surface point then asks only those references that
//! lit something near it, wherever the viewer stands and however many references there are.

use super::ReferenceFrame;
use crate::math::whole::round;
use crate::scene::Scene;
use glam::{UVec3, Vec3};
use rayon::prelude::*;

/// References a directory tells apart.
pub const MAX_SLOTS: usize = 128;

/// Cells at most: 4 MB of bits, which stay in a processor's cache.
const MAX_CELLS: f32 = (1 << 18) as f32;

/// One bit per reference.
pub type SlotMask = u128;

/// For each cell of the scene, the references that lit something in it.
#[derive(Clone, Debug, Default)]
pub struct Directory {
    low: Vec3,
    cells_per_unit: f32,
    dimensions: UVec3,
    masks: Vec<SlotMask>,
    normals: Vec<PackedNormal>,
}

/// The normal of a triangle in three bytes, less than half a degree off; its length is off by up to a hundredth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackedNormal([i8; 3]);

/// Cosine of eight degrees: triangles that turn less from one to the next lend each other light.
pub(crate) const ALIKE_COSINE: f32 = 0.99;

impl PackedNormal {
    pub(crate) const ZERO: Self = Self([0; 3]);

    fn of([a, b, c]: [Vec3; 3]) -> Self {
        Self::of_unit((b - a).cross(c - a).normalize_or(Vec3::Y))
    }

    #[inline(always)]
    pub(crate) fn of_unit(normal: Vec3) -> Self {
        let n = normal * 127.0;
        Self([round(n.x) as i8, round(n.y) as i8, round(n.z) as i8])
    }

    /// True where two triangles are turned alike, whichever way they are wound.
    #[inline(always)]
    pub(crate) fn is_like(self, other: Self) -> bool {
        let along = self.dot(other);
        // Lengths are divided out: rounded, they alone would part triangles of one plane.
        along * along >= ALIKE_COSINE * ALIKE_COSINE * self.dot(self) * other.dot(other)
    }

    /// True where two sides of triangles face alike.
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
    /// An empty directory of a scene.
    pub fn new(scene: &Scene) -> Self {
        let [low, high] = scene.bounds_m.map(|p| scene.frame.scene_from_world_f64(p).as_vec3());
        // A flat scene still has a thickness of one cell.
        let extent = (high - low).max(Vec3::splat((high - low).max_element() / 1024.0 + f32::MIN_POSITIVE));
        let cell = (extent.element_product() / (MAX_CELLS / 2.0)).cbrt().max(extent.max_element() / 512.0);
        let dimensions = (extent / cell).floor().as_uvec3() + 1;
        let count = dimensions.as_usizevec3().element_product();
        let triangles = 0..scene.triangles.len() as u32;
        let normals = triangles.into_par_iter().map(|t| PackedNormal::of(scene.corners(t))).collect();
        Self { low, cells_per_unit: 1.0 / cell, dimensions, masks: vec![0; count], normals }
    }

    /// Of each triangle.
    pub(crate) fn normals(&self) -> &[PackedNormal] {
        &self.normals
    }

    /// The cell of a point in scene space; points outside belong to the nearest cell.
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

    /// The references that lit something in a cell.
    #[inline(always)]
    pub(crate) fn mask(&self, cell: u32) -> SlotMask {
        self.masks[cell as usize]
    }

    /// Enters a reference's lit pixels under a slot.
    pub(crate) fn add(&mut self, frame: &ReferenceFrame, slot: usize) {
        let width = frame.view.size[0].max(1);
        let step = frame.view.scene_from_pixel.x_axis.length();
        let cells: Vec<Vec<u32>> = (0..frame.view.size[1])
            .into_par_iter()
            .map(|y| {
                let (mut cells, mut last) = (Vec::new(), None);
                let lit = (y * width..(y + 1) * width).filter(|&pixel| frame.has_light(pixel));
                for pixel in lit.filter(|&pixel| frame.disparity()[pixel as usize] > 0.0) {
                    let position = frame.view.eye + frame.offset_from_eye(pixel);
                    // A sample may be looked up from as far as the next one. One cell at most: the cost must stay bounded, however coarse the sample.
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

    /// Appends the cells of a box.
    fn cells_between(&self, [low, high]: [UVec3; 2], cells: &mut Vec<u32>) {
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                cells.extend((low.x..=high.x).map(|x| self.index(UVec3::new(x, y, z))));
            }
        }
    }

    /// Forgets all slots.
    pub(crate) fn clear(&mut self) {
        self.masks.fill(0);
    }

    /// Forgets a slot.
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
