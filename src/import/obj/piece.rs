//! One piece of an OBJ file: its faces, and what else is read from its lines.

use crate::import::tally::Tally;
use glam::{DVec2, DVec3, Vec2, Vec3};

/// Index that stands for no texture coordinate or no normal.
pub(super) const NONE: u32 = u32::MAX;

/// A corner of a face: indices into the lists of the whole file, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}
const _: () = assert!(size_of::<Corner>() == 12);

/// A polygon: the end of its corners in the list of its piece, and its line, counted from the first
/// line of the piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) end: u32,
    pub(super) line: u32,
}

/// Contents of one piece of the text.
#[derive(Debug, Default)]
pub(super) struct Piece {
    pub(super) first_line: u64,
    /// Corners of all faces.
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    /// `usemtl` lines: the number of faces before each, and the name.
    pub(super) switches: Vec<(usize, String)>,
    /// `o` and `g` lines: the number of faces before each, whether it is an `o`, and the name.
    pub(super) shapes: Vec<(usize, bool, String)>,
    /// `s` lines: the number of faces before each, and the group; 0 is flat.
    pub(super) smoothing: Vec<(usize, u32)>,
    /// `usemtl` after the pieces are joined: the end of each run of faces, and the number of its
    /// material.
    pub(super) runs: Vec<(usize, u32)>,
    pub(super) libraries: Vec<(u64, String)>,
    pub(super) tally: Tally,
}

/// The numbers that the faces of a piece use, as `tobj` has read them. Each list is in the order of
/// first use, with the index of each element in the file.
#[derive(Debug, Default)]
pub(super) struct UsedNumbers {
    pub(super) positions: Vec<(u32, DVec3)>,
    /// Unit vectors, or zero.
    pub(super) normals: Vec<(u32, Vec3)>,
    pub(super) uvs: Vec<(u32, Vec2)>,
    /// Texture coordinates of which f32 keeps too few digits.
    pub(super) far_uvs: Vec<(u32, DVec2)>,
    /// Colours of vertices as written.
    pub(super) colors: Vec<(u32, Vec3)>,
}

/// Numbers of lines and vertex attributes in a text.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub(super) lines: u64,
    pub(super) positions: usize,
    pub(super) uvs: usize,
    pub(super) normals: usize,
}

impl Counts {
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            lines: self.lines + other.lines,
            positions: self.positions + other.positions,
            uvs: self.uvs + other.uvs,
            normals: self.normals + other.normals,
        }
    }
}
