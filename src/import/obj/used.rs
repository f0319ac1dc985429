//! The faces of one piece as an OBJ text of their own, with the numbers they use, parsed by `tobj`.
//!
//! `tobj` looks up the corners of a face among the numbers it has read. So that pieces can be
//! parsed independently, a piece brings those that its faces use, numbered by their first use. That
//! is how `tobj` numbers what it returns, too. Where a piece has texture coordinates or normals,
//! every corner gets them: `tobj` would take those of the corner before. A corner without gets one
//! that stands for none.

use super::numbers::{NumberLines, write_normal, write_position, write_uv};
use super::piece::{Corner, Counts, NONE, Piece, UsedNumbers};
use crate::import::text::{self, Lines};
use glam::{DVec2, DVec3, Vec3};
use std::io::Read as _;

/// Texture coordinates from here on are wrapped before they are rounded to f32, which keeps a
/// sixteenth of a texel of a picture of 4096 texels below.
const UV_FAR: f64 = 256.0;

/// Polygons and the three lists of indices stay as they are: they are welded and filled later.
const OPTIONS: tobj::LoadOptions =
    tobj::LoadOptions { single_index: false, triangulate: false, ignore_points: true, ignore_lines: true };

/// All pieces of a text with their lines of numbers.
pub(super) struct Source<'a> {
    pub(super) texts: &'a [&'a str],
    pub(super) lines: &'a [NumberLines],
    /// Numbers of elements before each piece.
    pub(super) before: &'a [Counts],
    pub(super) has_colors: bool,
}

impl Source<'_> {
    /// Calls `write` with the numbers of an element of one list.
    fn with_line(
        &self,
        index: u32,
        list: fn(&NumberLines) -> &[u32],
        count: fn(&Counts) -> usize,
        write: impl FnOnce(&str),
    ) {
        let index = index as usize;
        let piece = self.before.partition_point(|before| count(before) <= index).saturating_sub(1);
        let at = list(&self.lines[piece]).get(index - count(&self.before[piece]));
        let text = at.and_then(|at| self.texts[piece].get(*at as usize..)).unwrap_or("");
        let line = Lines::new(text, 0).next();
        write(line.as_ref().map_or("", |line| text::keyword(&line.text).1));
    }
}

/// Numbers the elements of one list by their first use in a piece.
struct Numbering {
    /// Lowest index that is used.
    low: u32,
    /// The number of each index from the lowest on, counted from 1; 0 where it is not used yet.
    /// Only pages that are used are touched, so that one far index costs little.
    number_of: Vec<u32>,
    /// Number of the element that stands for none; 0 where it is not used yet.
    none: u32,
    /// Index of each element.
    indices: Vec<u32>,
}

impl Numbering {
    fn of(used: impl Iterator<Item = u32>) -> Self {
        let bounds = used.filter(|index| *index != NONE).fold(None, |bounds, index| {
            let (low, high) = bounds.unwrap_or((index, index));
            Some((index.min(low), index.max(high)))
        });
        let (low, size) = bounds.map_or((0, 0), |(low, high)| (low, (high - low) as usize + 1));
        Self { low, number_of: vec![0; size], none: 0, indices: Vec::new() }
    }

    /// Returns the number of an element, and whether this is its first use.
    fn number(&mut self, index: u32) -> (u32, bool) {
        let next = self.indices.len() as u32 + 1;
        let number = match index {
            NONE => &mut self.none,
            _ => &mut self.number_of[(index - self.low) as usize],
        };
        let is_first = *number == 0;
        if is_first {
            *number = next;
            self.indices.push(index);
        }
        (*number, is_first)
    }
}

/// Writer of a piece.
struct Writer<'a> {
    source: &'a Source<'a>,
    positions: Numbering,
    uvs: Numbering,
    normals: Numbering,
    numbers: String,
    faces: Vec<u8>,
}

impl<'a> Writer<'a> {
    fn new(source: &'a Source<'a>, corners: &[Corner]) -> Self {
        Self {
            source,
            positions: Numbering::of(corners.iter().map(|c| c.position)),
            uvs: Numbering::of(corners.iter().map(|c| c.uv)),
            normals: Numbering::of(corners.iter().map(|c| c.normal)),
            numbers: String::new(),
            faces: Vec::with_capacity(corners.len() * 16),
        }
    }

    fn face(&mut self, corners: &[Corner]) {
        self.faces.push(b'f');
        for corner in corners {
            self.faces.push(b' ');
            self.position(corner.position);
            let (has_uvs, has_normals) = (!self.uvs.number_of.is_empty(), !self.normals.number_of.is_empty());
            if has_uvs || has_normals {
                self.faces.push(b'/');
            }
            if has_uvs {
                self.uv(corner.uv);
            }
            if has_normals {
                self.faces.push(b'/');
                self.normal(corner.normal);
            }
        }
        self.faces.push(b'\n');
    }

    fn position(&mut self, index: u32) {
        let (number, is_first) = self.positions.number(index);
        push_index(&mut self.faces, number);
        if is_first {
            let write = |line: &str| write_position(&mut self.numbers, line, self.source.has_colors);
            self.source.with_line(index, |lines| &lines.positions, |counts| counts.positions, write);
        }
    }

    fn uv(&mut self, index: u32) {
        let (number, is_first) = self.uvs.number(index);
        push_index(&mut self.faces, number);
        if is_first && index == NONE {
            self.numbers.push_str("vt NaN NaN\n");
        } else if is_first {
            let write = |line: &str| write_uv(&mut self.numbers, line);
            self.source.with_line(index, |lines| &lines.uvs, |counts| counts.uvs, write);
        }
    }

    fn normal(&mut self, index: u32) {
        let (number, is_first) = self.normals.number(index);
        push_index(&mut self.faces, number);
        if is_first && index == NONE {
            self.numbers.push_str("vn 0 0 0\n");
        } else if is_first {
            let write = |line: &str| write_normal(&mut self.numbers, line);
            self.source.with_line(index, |lines| &lines.normals, |counts| counts.normals, write);
        }
    }
}

/// Parses the faces of a piece by `tobj`, with the numbers they use, and sets their corners.
pub(super) fn parse(piece: &mut Piece, source: &Source) -> Result<UsedNumbers, String> {
    let mut writer = Writer::new(source, &piece.corners);
    let mut start = 0;
    for face in &piece.faces {
        writer.face(&piece.corners[start..face.end as usize]);
        start = face.end as usize;
    }
    let Writer { numbers, faces, positions, uvs, normals, .. } = writer;
    let mut reader = numbers.as_bytes().chain(faces.as_slice());
    let meshes = tobj::load_obj_buf(&mut reader, &OPTIONS, |_| Ok(Default::default()));
    let (meshes, _) = meshes.map_err(|error| error.to_string())?;
    let mesh = meshes.into_iter().next().map(|model| model.mesh).unwrap_or_default();
    if mesh.indices.len() != piece.corners.len() {
        return Err(format!("{} corners instead of {}", mesh.indices.len(), piece.corners.len()));
    }
    let used = UsedNumbers::of(&mesh, &positions.indices, &uvs.indices, &normals.indices);
    // A normal without a length is none.
    let normal = |(index, n): &(u32, Vec3)| if *n == Vec3::ZERO { NONE } else { *index };
    let normals: Vec<u32> = used.normals.iter().map(normal).collect();
    set_corners(&mut piece.corners, &mesh, [&positions.indices, &uvs.indices, &normals]);
    Ok(used)
}

impl UsedNumbers {
    fn of(mesh: &tobj::Mesh, positions: &[u32], uvs: &[u32], normals: &[u32]) -> Self {
        let triple = |n: &[f64; 3]| DVec3::from_array(*n);
        let unit = |n: &[f64; 3]| triple(n).try_normalize().unwrap_or(DVec3::ZERO).as_vec3();
        let pair = |n: &[f64; 2]| DVec2::from_array(*n);
        let (of_positions, _) = mesh.positions.as_chunks();
        let (of_colors, _) = mesh.vertex_color.as_chunks();
        let (of_uvs, of_normals) = (mesh.texcoords.as_chunks().0, mesh.normals.as_chunks().0);
        let colors = positions.iter().zip(of_colors).map(|(i, n)| (*i, triple(n).as_vec3()));
        let all_uvs = || uvs.iter().zip(of_uvs).map(|(i, n)| (*i, pair(n)));
        Self {
            positions: positions.iter().zip(of_positions).map(|(i, n)| (*i, triple(n))).collect(),
            normals: normals.iter().zip(of_normals).map(|(i, n)| (*i, unit(n))).collect(),
            uvs: all_uvs().map(|(i, uv)| (i, uv.as_vec2())).collect(),
            far_uvs: all_uvs().filter(|(_, uv)| uv.abs().max_element() >= UV_FAR).collect(),
            colors: colors.filter(|(_, color)| color.is_finite()).collect(),
        }
    }
}

/// Replaces corners by those that `tobj` has read: it numbers positions, texture coordinates and
/// normals as these lists do.
fn set_corners(corners: &mut [Corner], mesh: &tobj::Mesh, [positions, uvs, normals]: [&[u32]; 3]) {
    let at = |of_tobj: &[u32], i: usize, list: &[u32]| {
        of_tobj.get(i).and_then(|at| list.get(*at as usize)).copied().unwrap_or(NONE)
    };
    for (i, corner) in corners.iter_mut().enumerate() {
        *corner = Corner {
            position: at(&mesh.indices, i, positions),
            uv: at(&mesh.texcoord_indices, i, uvs),
            normal: at(&mesh.normal_indices, i, normals),
        };
    }
}

fn push_index(text: &mut Vec<u8>, index: u32) {
    let (mut digits, mut first, mut left) = ([0; 10], 10, index);
    while left > 0 {
        first -= 1;
        digits[first] = b'0' + (left % 10) as u8;
        left /= 10;
    }
    text.extend_from_slice(&digits[first..]);
}
