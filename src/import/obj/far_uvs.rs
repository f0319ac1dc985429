//! Texture coordinates far from zero: whole numbers are taken off in f64, face by face, before f32
//! loses the digits that select a texel. A picture repeats, so it looks the same.

use super::parse::Model;
use super::piece::{Corner, NONE};
use glam::DVec2;
use std::collections::HashMap;

/// Wraps the texture coordinates of all faces that have one far from zero.
pub(super) fn wrap(model: &mut Model) {
    if model.far_uvs.is_empty() {
        return;
    }
    let far = std::mem::take(&mut model.far_uvs);
    let mut wrapper = Wrapper { far, known: HashMap::new() };
    let mut corner_uvs = Vec::new();
    for face in model.faces() {
        let shift = wrapper.shift(face.corners, model);
        corner_uvs.extend(face.corners.iter().map(|c| shift.filter(|_| c.uv != NONE).map(|s| (c.uv, s))));
    }
    let indices: Vec<Option<u32>> =
        corner_uvs.into_iter().map(|key| key.map(|(uv, shift)| wrapper.index(uv, shift, model))).collect();
    for (corner, index) in model.corners_mut().zip(indices) {
        corner.uv = index.unwrap_or(corner.uv);
    }
}

/// Whole numbers that are taken off.
type Shift = [i64; 2];

struct Wrapper {
    far: Vec<(u32, DVec2)>,
    /// Index of a texture coordinate after a shift.
    known: HashMap<(u32, Shift), u32>,
}

impl Wrapper {
    fn far(&self, uv: u32) -> Option<DVec2> {
        self.far.binary_search_by_key(&uv, |(index, _)| *index).ok().map(|at| self.far[at].1)
    }

    fn exact(&self, uv: u32, model: &Model) -> DVec2 {
        self.far(uv).unwrap_or_else(|| model.uvs[uv as usize].as_dvec2())
    }

    /// Returns the shift of a face; `None` where no corner is far from zero.
    fn shift(&self, corners: &[Corner], model: &Model) -> Option<Shift> {
        let uvs = || corners.iter().filter(|c| c.uv != NONE).map(|c| c.uv);
        uvs().find(|uv| self.far(*uv).is_some())?;
        let least = uvs().map(|uv| self.exact(uv, model)).reduce(DVec2::min)?;
        Some(least.floor().to_array().map(|n| n as i64))
    }

    fn index(&mut self, uv: u32, shift: Shift, model: &mut Model) -> u32 {
        let near = self.exact(uv, model) - DVec2::from_array(shift.map(|n| n as f64));
        *self.known.entry((uv, shift)).or_insert_with(|| {
            model.uvs.push(near.as_vec2());
            model.uvs.len() as u32 - 1
        })
    }
}
