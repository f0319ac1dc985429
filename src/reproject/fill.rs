//! A stand-in for pixels that are not done yet, so that a frame can be shown before it is complete.
//!
//! Source: Gortler et al., "The Lumigraph", SIGGRAPH 1996, section 3.5, pull-push. We differ: a level is a plain mean
//! of the known among four, and a hole takes the first coarser level that knows something, without blending.

use glam::Vec3;

/// Gives every pixel for which `is_known` is false the mean of known pixels around it, the nearest there are.
///
/// Takes row-major pictures of `width` pixels a row. `levels` is scratch memory. Never touches a known pixel.
pub fn fill_unknown(
    radiance: &mut [Vec3],
    is_known: &[bool],
    width: usize,
    levels: &mut Vec<Vec<(Vec3, f32)>>,
) {
    if width == 0 || is_known.iter().all(|&known| known) {
        return;
    }
    let sizes = pull(radiance, is_known, width, levels);
    for (pixel, value) in radiance.iter_mut().enumerate().filter(|(pixel, _)| !is_known[*pixel]) {
        let (mut x, mut y) = (pixel % width, pixel / width);
        for (level, &(columns, _)) in levels.iter().zip(&sizes) {
            (x, y) = (x / 2, y / 2);
            let (sum, weight) = level[y * columns + x];
            if weight > 0.0 {
                *value = sum / weight;
                break;
            }
        }
    }
}

/// Sums of the known pixels over squares of 2, 4, 8, ... pixels; returns columns and rows of each level.
fn pull(
    radiance: &[Vec3],
    is_known: &[bool],
    width: usize,
    levels: &mut Vec<Vec<(Vec3, f32)>>,
) -> Vec<(usize, usize)> {
    let mut sizes = Vec::new();
    let (mut columns, mut rows) = (width, radiance.len() / width);
    while columns > 1 || rows > 1 {
        let (from_columns, from_rows) = (columns, rows);
        (columns, rows) = (columns.div_ceil(2), rows.div_ceil(2));
        let index = sizes.len();
        if levels.len() == index {
            levels.push(Vec::new());
        }
        let (finer, coarser) = levels.split_at_mut(index);
        let from = |x: usize, y: usize| match finer.last() {
            Some(level) => level[y * from_columns + x],
            None if is_known[y * width + x] => (radiance[y * width + x], 1.0),
            None => (Vec3::ZERO, 0.0),
        };
        let level = &mut coarser[0];
        level.clear();
        level.extend((0..columns * rows).map(|cell| {
            let (x, y) = (cell % columns * 2, cell / columns * 2);
            let inside = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
            let inside = inside.into_iter().filter(|&(x, y)| x < from_columns && y < from_rows);
            inside.map(|(x, y)| from(x, y)).fold((Vec3::ZERO, 0.0), |(s, w), (r, k)| (s + r, w + k))
        }));
        sizes.push((columns, rows));
    }
    sizes
}
