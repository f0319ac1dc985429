//! Values for pixels that are not rendered yet, so that a frame can be shown before it is complete.
//!
//! Source: Gortler et al., "The Lumigraph", SIGGRAPH 1996, section 3.5, pull-push. We differ: a
//! level is the plain mean of the known pixels among four, and a hole is interpolated between the
//! cells of the first coarser level that has a known pixel there, without blending levels.

use glam::Vec3;
use rayon::prelude::*;

/// Scratch memory of [`fill_unknown`]: for each level, the weighted sum of known pixels in each
/// cell, and its weight.
pub type Levels = Vec<Vec<(Vec3, f32)>>;

/// Pyramid of a picture's known pixels, in cells of 2, 4, 8, ... pixels.
#[derive(Debug)]
struct Surroundings<'a> {
    levels: &'a Levels,
    /// Columns and rows of each level.
    sizes: Vec<[usize; 2]>,
}

/// Replaces every pixel for which `is_known` is false by a mean of the nearest known pixels around
/// it.
///
/// The picture is row-major with `width` pixels per row. `levels` is scratch memory. Known pixels
/// are not changed; without any known pixel nothing is changed.
pub fn fill_unknown(values: &mut [Vec3], is_known: &[bool], width: usize, levels: &mut Levels) {
    if width == 0 || is_known.iter().all(|&known| known) {
        return;
    }
    let size = [width, values.len() / width];
    let known = |pixel: usize| is_known[pixel].then_some(values[pixel]);
    let surroundings = Surroundings::gather(size, known, levels);
    values.par_chunks_mut(width).zip(is_known.par_chunks(width)).enumerate().for_each(|(y, (row, known))| {
        for (x, value) in row.iter_mut().enumerate().filter(|(x, _)| !known[*x]) {
            *value = surroundings.around([x, y]).unwrap_or(*value);
        }
    });
}

impl<'a> Surroundings<'a> {
    /// Builds the pyramid of a picture of `size` pixels. `known` returns the value of a pixel, if
    /// it is known.
    fn gather(
        size: [usize; 2],
        known: impl Fn(usize) -> Option<Vec3> + Sync,
        levels: &'a mut Levels,
    ) -> Self {
        let mut sizes = Vec::new();
        let mut finer = size;
        while finer[0] > 1 || finer[1] > 1 {
            let coarser = finer.map(|n| n.div_ceil(2));
            if levels.len() == sizes.len() {
                levels.push(Vec::new());
            }
            let (below, level) = levels.split_at_mut(sizes.len());
            let from = |x: usize, y: usize| match below.last() {
                Some(level) => level[y * finer[0] + x],
                None => known(y * size[0] + x).map_or((Vec3::ZERO, 0.0), weighted),
            };
            let cell = |cell: usize| {
                let (x, y) = (cell % coarser[0] * 2, cell / coarser[0] * 2);
                let inside = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
                let inside = inside.into_iter().filter(|&(x, y)| x < finer[0] && y < finer[1]);
                inside.map(|(x, y)| from(x, y)).fold((Vec3::ZERO, 0.0), |(s, w), (r, k)| (s + r, w + k))
            };
            (0..coarser[0] * coarser[1]).into_par_iter().map(cell).collect_into_vec(&mut level[0]);
            sizes.push(coarser);
            finer = coarser;
        }
        Self { levels, sizes }
    }

    /// Returns a mean of the nearest known pixels around a pixel; `None` if no pixel of the picture
    /// is known.
    fn around(&self, [x, y]: [usize; 2]) -> Option<Vec3> {
        let knows =
            |at: usize| self.levels[at][(y >> (at + 1)) * self.sizes[at][0] + (x >> (at + 1))].1 > 0.0;
        let at = (0..self.sizes.len()).find(|&at| knows(at))?;
        let (level, [columns, rows]) = (&self.levels[at], self.sizes[at]);
        let [across, down] = [(x, columns), (y, rows)].map(|(i, count)| {
            let place = (i as f32 + 0.5) / (2 << at) as f32 - 0.5;
            let first = place.floor();
            let part = place - first;
            [(first, 1.0 - part), (first + 1.0, part)].map(|(i, w)| ((i.max(0.0) as usize).min(count - 1), w))
        });
        let (mut sum, mut total) = (Vec3::ZERO, 0.0);
        for (row, wy) in down {
            for (column, wx) in across {
                let (cell, weight) = level[row * columns + column];
                if weight > 0.0 {
                    sum += cell / weight * (wx * wy);
                    total += wx * wy;
                }
            }
        }
        (total > 0.0).then(|| sum / total)
    }
}

/// Weights a pixel. Bright pixels count less, otherwise a lamp would dominate its surroundings.
fn weighted(value: Vec3) -> (Vec3, f32) {
    let weight = 1.0 / (1.0 + value.max_element());
    (value * weight, weight)
}
