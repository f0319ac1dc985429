//! The mixture of two pictures of a view that has the least estimated error.

use glam::Vec3;

/// Side of the square of pixels whose errors are estimated together.
const BLOCK: usize = 16;

/// Replaces each looked-up pixel by a mixture with the mean of the full tracer's passes.
///
/// Over a block, the squared distance of the two pictures is the error of the first plus the
/// variance of the second. So the first's error is known, and the shares that minimize the error of
/// the mixture are those of the inverse errors.
pub(super) fn mix(shown: &mut [Vec3], full: &[Option<(Vec3, f32)>], width: usize) {
    let (columns, rows) = (width.div_ceil(BLOCK), (shown.len() / width.max(1)).div_ceil(BLOCK));
    let block_of = |pixel: usize| pixel / width / BLOCK * columns + pixel % width / BLOCK;
    let mut errors = vec![[0.0f64; 2]; columns * rows];
    let energy = full.iter().flatten().map(|(mean, _)| f64::from(mean.length_squared())).sum::<f64>();
    let usual = energy / full.len().max(1) as f64;
    for (pixel, (shown, full)) in shown.iter().zip(full).enumerate() {
        if let Some((mean, variance)) = full {
            // Errors count as they are seen: less in pixels brighter than the picture.
            let weight = 1.0 / (usual + f64::from(mean.length_squared())).max(f64::MIN_POSITIVE);
            let error = &mut errors[block_of(pixel)];
            error[0] += weight * f64::from((*shown - *mean).length_squared());
            error[1] += weight * f64::from(*variance);
        }
    }
    for (pixel, (shown, full)) in shown.iter_mut().zip(full).enumerate() {
        if let Some((mean, _)) = full {
            let [distance, variance] = errors[block_of(pixel)];
            let bias = (distance - variance).max(0.0);
            let share = if bias + variance > 0.0 { bias / (bias + variance) } else { 1.0 };
            *shown = shown.lerp(*mean, share as f32);
        }
    }
}
