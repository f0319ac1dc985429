//! Which cell a surface point belongs to.

use crate::math::{key::Key, rounding::floor};
use crate::trace::Reader;
use glam::Vec3;
use std::ops::RangeInclusive;

/// Exponents of the sides of the smallest and largest cells, in scene units.
const LEVELS: [i32; 2] = [-12, 12];

/// Largest side of a cell as a share of the length of the ray that reads it. In a daylit room a
/// quarter had the error of an eighth, with a third of the cells fewer.
const SIDE_SHARE: f32 = 0.25;

/// Samples from which on the share shrinks, so that it stays below the distance between samples.
const SHARED_SAMPLES: f32 = 16.0;

/// Smallest side of a cell, in footprints of the pixel that reads it, with one sample. A cell of
/// four footprints is read some ten times by sixteen samples; below that, tracing the path on costs
/// less than the cell.
const MIN_FOOTPRINTS: f32 = 16.0;

/// Finer cells that are tried where a cell lies on both sides of a wall, before the path is traced
/// on.
pub(super) const MAX_SPLITS: i32 = 2;

/// Moves the borders of cells, in cells, off the round coordinates that walls tend to have.
const BORDER: Vec3 = Vec3::new(0.391, 0.631, 0.457);

/// A cube of space, and the side that the surfaces in it face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CellKey {
    at: [i32; 3],
    level: i8,
    /// Axis of the largest component of the normal, and 3 more where it is negative.
    side: u8,
}

impl CellKey {
    /// The levels of the cells that a ray may read, from the finest to the largest; none where the
    /// ray is too short.
    pub(super) fn levels_of(reader: &Reader) -> RangeInclusive<i32> {
        let samples = reader.samples.max(1) as f32;
        let share = SIDE_SHARE * (SHARED_SAMPLES / samples).sqrt().min(1.0);
        let level = |side: f32| side.log2().clamp(LEVELS[0] as f32, LEVELS[1] as f32 + 1.0);
        let finest = level(reader.footprint * MIN_FOOTPRINTS / samples.sqrt()).ceil() as i32;
        let largest = level(reader.length * share).floor() as i32;
        finest..=largest.min(LEVELS[1])
    }

    /// The cell of a point with this unit normal; `None` below the smallest level.
    pub(super) fn new(position: Vec3, normal: Vec3, level: i32) -> Option<Self> {
        if level < LEVELS[0] {
            return None;
        }
        let at = (position / side_of(level) + BORDER).to_array().map(floor);
        let axis = normal.abs().max_position();
        let side = axis as u8 + if normal[axis] < 0.0 { 3 } else { 0 };
        Some(Self { at, level: level as i8, side })
    }

    /// Length of the cube's edges, scene units.
    pub(super) fn length(&self) -> f32 {
        side_of(i32::from(self.level))
    }

    /// The corner of the cube with the smallest coordinates, scene space.
    pub(super) fn low(&self) -> Vec3 {
        (Vec3::from(self.at.map(|i| i as f32)) - BORDER) * self.length()
    }

    /// Axis that the normals of the cell's surfaces are nearest to, 0 to 2, and their sign along
    /// it.
    pub(super) fn facing(&self) -> (usize, f32) {
        (usize::from(self.side % 3), if self.side < 3 { 1.0 } else { -1.0 })
    }

    /// True where a surface with this unit normal belongs to the cell if it lies in the cube.
    pub(super) fn faces_like(&self, normal: Vec3) -> bool {
        let (axis, sign) = self.facing();
        normal.abs().max_position() == axis && normal[axis] * sign > 0.0
    }

    /// 64 random bits of the key, never zero.
    pub(super) fn hash(&self) -> u64 {
        let [x, y, z] = self.at.map(|i| i as u32);
        let word = u32::from(self.level as u8) << 8 | u32::from(self.side);
        Key::of_pixel(u64::from(x) << 32 | u64::from(y), z).with(word).bits().max(1)
    }
}

fn side_of(level: i32) -> f32 {
    f32::from_bits(((level + 127) as u32) << 23)
}
