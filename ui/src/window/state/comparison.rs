//! The comparison of the shown picture with the full tracer's.

use super::Quality;
use crate::window::rendering::PublishedFrame;
use afterimage::raster::color::srgb8;
use afterimage::raster::metrics::{CompareError, error_picture, flip_map, psnr_db};
use afterimage::raster::rgb9e5;
use glam::Vec3;

/// View of the comparison while its key is not held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compare {
    /// The comparison is hidden.
    #[default]
    Off,
    /// The shown picture is on the left, the full tracer's on the right.
    Split,
    /// An error map (FLIP): how visible the difference of each pixel is.
    Errors,
}

/// Difference of a picture from the full tracer's, both as displayed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureError {
    /// Peak signal-to-noise ratio in decibels.
    pub psnr_db: f64,
    /// Mean FLIP error, 0 to 1.
    pub flip_mean: f64,
}

/// Identifies two pictures that were measured: generation of the frame, pass of the full tracer,
/// and exposure in stops.
pub type Pair = (u64, u32, f32);

/// The comparison with the full tracer.
#[derive(Debug)]
pub struct Comparison {
    /// View of the comparison while no key is held.
    pub shows: Compare,
    /// The key is held that shows the full tracer's picture.
    pub is_held: bool,
    /// Position of the split line, 0..1 from the left.
    pub split: f32,
    /// The full tracer's picture of the current view.
    pub full: Option<PublishedFrame>,
    /// The measured difference, and the two pictures it belongs to.
    pub error: Option<(Pair, PictureError)>,
}

impl Default for Comparison {
    fn default() -> Self {
        Self { shows: Compare::Off, is_held: false, split: 0.5, full: None, error: None }
    }
}

impl Comparison {
    /// True while the full tracer's picture is shown in any way.
    pub fn is_wanted(&self) -> bool {
        self.is_held || self.shows != Compare::Off
    }

    /// Returns the progress of the full tracer in words; `None` while nothing is compared.
    pub fn progress_text(&self) -> Option<String> {
        self.is_wanted().then(|| match self.full.as_ref().map(|full| full.stats.refined) {
            None => "tracing".to_owned(),
            Some(refined) if refined.is_complete => super::work::passes_done(refined.of.max(1)),
            Some(refined) => format!("pass {}/{}", refined.pass.max(1), refined.of.max(1)),
        })
    }
}

/// Returns the difference of two pictures as they are displayed, and its error map as sRGB,
/// row-major. `picture` and `full` are linear radiance packed as rgb9e5; the exposure is a number
/// of stops.
///
/// # Errors
/// Those of [`flip_map`]: sizes that do not fit.
pub fn difference(
    picture: &[u32],
    full: &[u32],
    size: [u32; 2],
    quality: &Quality,
) -> Result<(PictureError, Vec<[u8; 3]>), CompareError> {
    let exposure_ev = quality.exposure.stops().unwrap_or_default();
    let shown = |packed: &u32| {
        let [r, g, b] = srgb8(rgb9e5::unpack(*packed), exposure_ev, quality.tone_map).map(f32::from);
        Vec3::new(r, g, b) / 255.0
    };
    let [picture, full] = [picture, full].map(|p| p.iter().map(shown).collect::<Vec<Vec3>>());
    let map = flip_map(&picture, &full, size)?;
    let flip_mean = map.iter().map(|&e| f64::from(e)).sum::<f64>() / map.len().max(1) as f64;
    Ok((PictureError { psnr_db: psnr_db(&picture, &full), flip_mean }, error_picture(&map)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::raster::metrics::PSNR_OF_EQUALS_DB;

    #[test]
    fn equal_pictures_do_not_differ_and_a_spot_is_found() {
        let quality = Quality::default();
        let mut picture = vec![rgb9e5::pack(Vec3::splat(0.3)); 32 * 32];
        let full = picture.clone();
        let (error, map) = difference(&picture, &full, [32, 32], &quality).unwrap();
        assert_eq!((error.psnr_db, error.flip_mean), (PSNR_OF_EQUALS_DB, 0.0));
        picture[16 * 32 + 16] = rgb9e5::pack(Vec3::new(4.0, 0.0, 0.0));
        let (error, marked) = difference(&picture, &full, [32, 32], &quality).unwrap();
        assert!(error.psnr_db < 40.0 && error.flip_mean > 1e-3);
        assert!(marked[16 * 32 + 16] != map[16 * 32 + 16] && marked[0] == map[0]);
    }
}
