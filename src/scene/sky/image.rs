//! A picture of the sky in latitude and longitude, and what of it is too bright to be found by
//! chance.

use super::suns::{Suns, row_solid_angle};
use glam::Vec3;
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Largest value of the remainder, in multiples of its mean over all directions. One sample by
/// solid angle then has a variance of at most 15 times the squared mean.
///
/// Measured on skies of Hosek and Wilkie with a sun at 5, 15 and 40 degrees, 2048 x 1024 texels: 16
/// cuts out the sun alone (8 to 10 texels), and a cosine-weighted sample has the relative variance
/// of the sky without the sun, 0.61, 0.40 and 0.17; without the cut it is 3,000 to 32,000. With 8
/// it is 0.56, 0.39 and 0.17, for thousands of texels more.
pub(super) const MAX_DIFFUSE_RATIO: f64 = 16.0;

/// Largest value of a texel. Sums over a sphere of them stay finite.
const MAX_VALUE: f32 = 1e12;

/// A picture of a sky, linear Rec. 709. Its first row is straight above, its centre in the north
/// (-Z), and its right half in the east (+X).
#[derive(Debug)]
pub struct SkyImage {
    file: PathBuf,
    size: [u32; 2],
    pub(super) texels: Vec<[f32; 3]>,
    /// Luminance in cd/m2 of a value of one, where the file gives it.
    nits: Option<f32>,
    /// Largest value of the remainder.
    limit: f32,
    pub(super) suns: Suns,
    digest: [u8; 32],
}

/// Why a picture is no sky.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SkyImageError {
    /// It is not twice as wide as high.
    #[error("it has {0}x{1} pixels; a picture of all directions is twice as wide as high")]
    Shape(u32, u32),
    /// It has more than [`SkyImage::MAX_WIDTH`] columns.
    #[error("it has {0}x{1} pixels, at most 8192x4096 are read")]
    TooLarge(u32, u32),
    /// A value is not a number, infinite, or above 1e12.
    #[error("{0} of its pixels are not finite or above 1e12, the first in column {1} of row {2}")]
    NotFinite(usize, u32, u32),
}

impl SkyImage {
    /// Maximum width in pixels. The texels then take 400 MB.
    pub const MAX_WIDTH: u32 = 8192;

    /// Checks width and height in pixels, before anything is decoded.
    ///
    /// # Errors
    /// [`SkyImageError::Shape`] and [`SkyImageError::TooLarge`].
    pub fn check_size([width, height]: [u32; 2]) -> Result<(), SkyImageError> {
        if height == 0 || u64::from(width) != 2 * u64::from(height) {
            return Err(SkyImageError::Shape(width, height));
        }
        if width > Self::MAX_WIDTH {
            return Err(SkyImageError::TooLarge(width, height));
        }
        Ok(())
    }

    /// Creates the sky of a file from its texels, row by row from the top. Negative values become
    /// zero. `nits` is the luminance in cd/m2 of a value of one, where the file gives it.
    ///
    /// # Errors
    /// [`SkyImageError`].
    ///
    /// # Panics
    /// If the number of texels is not that of the size.
    pub fn new(
        file: &Path,
        size: [u32; 2],
        mut texels: Vec<[f32; 3]>,
        nits: Option<f32>,
    ) -> Result<Self, SkyImageError> {
        Self::check_size(size)?;
        assert_eq!(texels.len(), size[0] as usize * size[1] as usize, "texels of another size");
        let is_wrong = |t: &[f32; 3]| t.iter().any(|v| !v.is_finite() || *v > MAX_VALUE);
        if let Some(first) = texels.iter().position(is_wrong) {
            let (count, at) = (texels.iter().filter(|t| is_wrong(t)).count(), first as u32);
            return Err(SkyImageError::NotFinite(count, at % size[0], at / size[0]));
        }
        texels.par_iter_mut().for_each(|t| *t = t.map(|v| v.max(0.0)));
        let limit = limit(&texels, size);
        let suns = Suns::new(&texels, size, limit);
        let digest = Sha256::digest(bytemuck::cast_slice::<_, u8>(&texels)).into();
        Ok(Self { file: file.to_owned(), size, texels, nits, limit, suns, digest })
    }

    /// Returns the path of the file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Returns width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the luminance in cd/m2 of a value of one, where the file gives it.
    pub fn nits(&self) -> Option<f32> {
        self.nits
    }

    /// Returns the SHA-256 of the texels.
    pub fn digest(&self) -> &[u8; 32] {
        &self.digest
    }

    /// Returns the number of texels that are lights of their own, at least in part.
    pub fn sun_texels(&self) -> usize {
        self.suns.columns.len()
    }

    /// Returns the largest value of a texel.
    pub fn max_value(&self) -> f32 {
        self.texels.iter().flatten().copied().fold(0.0, f32::max)
    }

    /// Returns the value at a place, 0 to 1 along and down the picture, with bilinear filtering.
    pub(super) fn bilinear(&self, [u, v]: [f32; 2]) -> Vec3 {
        let [width, height] = self.size;
        let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let column = |x: f32| (x as i64).rem_euclid(i64::from(width)) as u32;
        let row = |y: f32| (y.max(0.0) as u32).min(height - 1);
        let texel = |x, y| Vec3::from(self.texels[(row(y) * width + column(x)) as usize]);
        let at_row = |y| texel(x0, y).lerp(texel(x0 + 1.0, y), x - x0);
        at_row(y0).lerp(at_row(y0 + 1.0), y - y0)
    }

    pub(super) fn nearest(&self, [u, v]: [f32; 2]) -> Vec3 {
        let at = |t: f32, count: u32| ((t * count as f32) as u32).min(count - 1);
        Vec3::from(self.texels[(at(v, self.size[1]) * self.size[0] + at(u, self.size[0])) as usize])
    }

    /// Returns the share of a texel that is remainder.
    pub(super) fn diffuse_share(&self, texel: Vec3) -> f32 {
        let value = texel.max_element();
        if value > self.limit { self.limit / value } else { 1.0 }
    }
}

impl PartialEq for SkyImage {
    fn eq(&self, other: &Self) -> bool {
        (self.size, self.digest) == (other.size, other.digest)
    }
}

/// Returns the largest value of the remainder: [`MAX_DIFFUSE_RATIO`] times the mean of what is left
/// when everything above it is cut off.
fn limit(texels: &[[f32; 3]], [width, height]: [u32; 2]) -> f32 {
    /// Passes over the texels. Each lowers the limit by a factor until the mean no longer changes;
    /// pictures of skies take 2 to 5, and one texel on black falls by its share of the sphere.
    const MAX_PASSES: u32 = 64;
    /// Change of the limit below which the passes end.
    const SETTLED: f64 = 0.999;
    let mean_below = |limit: f64| {
        let row_sum = |(row, texels): (usize, &[[f32; 3]])| {
            let sum: f64 = texels.iter().map(|t| f64::from(Vec3::from(*t).max_element()).min(limit)).sum();
            sum * row_solid_angle(row as u32, height)
        };
        // The rows are summed in order, so that no result depends on the number of threads.
        let rows: Vec<f64> = texels.par_chunks(width as usize).enumerate().map(row_sum).collect();
        rows.iter().sum::<f64>() / f64::from(width) / (2.0 * std::f64::consts::TAU)
    };
    let mut limit = MAX_DIFFUSE_RATIO * mean_below(f64::INFINITY);
    for _ in 0..MAX_PASSES {
        let next = MAX_DIFFUSE_RATIO * mean_below(limit);
        let has_settled = next >= limit * SETTLED;
        limit = next;
        if has_settled {
            break;
        }
    }
    limit as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_that_are_no_skies_are_refused() {
        let new = |size: [u32; 2], value: f32| {
            let mut texels = vec![[1.0; 3]; size[0] as usize * size[1] as usize];
            texels[9][1] = value;
            SkyImage::new(Path::new("x"), size, texels, None).unwrap_err()
        };
        assert_eq!(new([8, 8], 1.0), SkyImageError::Shape(8, 8));
        assert_eq!(new([8, 4], f32::NAN), SkyImageError::NotFinite(1, 1, 1));
        assert_eq!(new([8, 4], f32::INFINITY), SkyImageError::NotFinite(1, 1, 1));
        assert_eq!(new([8, 4], 1e13), SkyImageError::NotFinite(1, 1, 1));
        assert_eq!(SkyImage::check_size([16_384, 8192]), Err(SkyImageError::TooLarge(16_384, 8192)));
        assert_eq!(SkyImage::check_size([0, 0]), Err(SkyImageError::Shape(0, 0)));
        let negative = SkyImage::new(Path::new("x"), [2, 1], vec![[-1.0, 1.0, 2.0]; 2], None).unwrap();
        assert_eq!(negative.texels[0], [0.0, 1.0, 2.0]);
    }
}
