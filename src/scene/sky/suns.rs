//! The brightest texels of a sky picture, as a light that is sampled by luminance.
//!
//! Source: Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, sections 12.5.2
//! and A.5.4 (piecewise constant distributions in two dimensions). We differ: only texels with an
//! excess are stored, and a texel is sampled evenly by solid angle.

use crate::raster::color::luminance;
use glam::Vec3;

/// Returns the solid angle of a row of texels.
pub(super) fn row_solid_angle(row: u32, height: u32) -> f64 {
    let edge = |row: u32| (std::f64::consts::PI * f64::from(row) / f64::from(height)).cos();
    std::f64::consts::TAU * (edge(row) - edge(row + 1))
}

/// The texels with an excess: rows in which there are any, and their columns, both with the share
/// of luminance in them and all before.
#[derive(Debug, Default)]
pub(super) struct Suns {
    rows: Vec<u32>,
    row_cdf: Vec<f32>,
    /// For each row, the end of its columns.
    row_ends: Vec<u32>,
    pub(super) columns: Vec<u32>,
    column_cdf: Vec<f32>,
    /// Luminance times solid angle of all texels.
    pub(super) total: f32,
}

impl Suns {
    pub(super) fn new(texels: &[[f32; 3]], [width, height]: [u32; 2], limit: f32) -> Self {
        let mut suns = Self::default();
        let (mut total, mut row_sums) = (0.0, Vec::new());
        for (row, texels) in (0..height).zip(texels.chunks(width as usize)) {
            let (first, mut sum) = (suns.columns.len(), 0.0);
            let mut sums = Vec::new();
            for (column, texel) in (0..width).zip(texels) {
                let texel = Vec3::from(*texel);
                let excess = texel * (1.0 - limit / texel.max_element());
                if texel.max_element() > limit && luminance(excess) > 0.0 {
                    sum += f64::from(luminance(excess));
                    suns.columns.push(column);
                    sums.push(sum);
                }
            }
            if suns.columns.len() > first {
                total += sum * row_solid_angle(row, height);
                suns.rows.push(row);
                suns.row_ends.push(suns.columns.len() as u32);
                suns.column_cdf.extend(sums.iter().map(|s| (s / sum) as f32));
                row_sums.push(total);
            }
        }
        suns.row_cdf = row_sums.iter().map(|s| (s / total) as f32).collect();
        suns.total = (total / f64::from(width)) as f32;
        suns
    }

    /// Chooses a texel. Returns its row and column, and where in it a sample lies, 0 to 1 both
    /// ways.
    pub(super) fn sample(&self, u: [f32; 2]) -> Option<([u32; 2], [f32; 2])> {
        let (row, down) = choose(&self.row_cdf, u[1])?;
        let first = row.checked_sub(1).map_or(0, |before| self.row_ends[before] as usize);
        let columns = first..self.row_ends[row] as usize;
        let (column, along) = choose(&self.column_cdf[columns.clone()], u[0])?;
        Some(([self.columns[columns.start + column], self.rows[row]], [along, down]))
    }
}

/// Returns the entry of a cumulative distribution for a number of 0 to 1, and where in the entry
/// the number lies, 0 to 1.
fn choose(cdf: &[f32], u: f32) -> Option<(usize, f32)> {
    let chosen = cdf.partition_point(|&c| c <= u).min(cdf.len().checked_sub(1)?);
    let below = if chosen == 0 { 0.0 } else { cdf[chosen - 1] };
    Some((chosen, ((u - below) / (cdf[chosen] - below).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0)))
}
