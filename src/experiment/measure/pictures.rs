//! The pictures of a frame for a report.

use crate::experiment::run::{ExperimentContext, ExperimentError};
use crate::raster::metrics::{CompareError, error_picture, flip_map};
use crate::raster::{color::ToneMap, load::exposed};
use crate::render::Frame;
use crate::render::aov::{display_rows, types_rows};
use glam::Vec3;

/// A frame as a report shows it: the picture, its pixel types and its error, all 8-bit sRGB.
#[derive(Clone, Debug)]
pub struct FramePictures {
    /// Base name of the files.
    pub name: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The tone-mapped frame.
    pub shown: Vec<[u8; 3]>,
    /// Type 1 in blue, Type 2 in yellow, Type 3 in orange.
    pub types: Vec<[u8; 3]>,
    /// FLIP error of every pixel against the converged picture, 0 to 1.
    pub flip: Vec<f32>,
}

impl FramePictures {
    /// Shows a frame and compares it with the linear radiance of its converged picture, at an
    /// exposure in stops.
    ///
    /// # Errors
    /// [`CompareError`] for a frame without pixels.
    pub fn of(name: &str, frame: &Frame, truth: &[Vec3], exposure_ev: f32) -> Result<Self, CompareError> {
        let size = frame.view.size;
        let [found, right] = [&frame.radiance[..], truth].map(|r| exposed(r, exposure_ev));
        Ok(Self {
            name: name.to_owned(),
            size,
            shown: display_rows(&frame.radiance, exposure_ev, ToneMap::Aces),
            types: types_rows(&frame.types),
            flip: flip_map(&found, &right, size)?,
        })
    }

    /// The FLIP error map as a picture; brighter is worse.
    pub fn error(&self) -> Vec<[u8; 3]> {
        error_picture(&self.flip)
    }

    /// Writes `NAME.png`, `NAME-types.png` and `NAME-error.png` to the pictures of the run.
    ///
    /// # Errors
    /// [`ExperimentError::Save`] if a file cannot be written.
    pub fn save(&self, context: &ExperimentContext<'_>) -> Result<(), ExperimentError> {
        let name = &self.name;
        context.save_picture(&format!("{name}.png"), self.size, &self.shown)?;
        context.save_picture(&format!("{name}-types.png"), self.size, &self.types)?;
        context.save_picture(&format!("{name}-error.png"), self.size, &self.error())
    }
}
