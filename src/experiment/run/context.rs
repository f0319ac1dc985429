//! The scene, settings and folders that a cell runs with.

use super::identity::{Identity, sha256_hex};
use super::{error::ExperimentError, record::RunRecord, settings::ExperimentSettings};
use crate::camera::{Camera, CameraPath};
use crate::raster::save::save_png;
use crate::trace::{Tracer, parallel::Stop};
use std::{path::Path, sync::Arc};

/// The scene, settings and folders that a cell runs with.
#[derive(Clone, Copy)]
pub struct ExperimentContext<'a> {
    /// Tracer of the scene.
    pub tracer: &'a Arc<Tracer>,
    /// Walk of the scene, or a recorded one.
    pub walk: &'a CameraPath,
    /// Settings of the run.
    pub settings: &'a ExperimentSettings,
    /// Folder that keeps converged pictures between runs; `None` keeps none.
    pub truth_folder: Option<&'a Path>,
    /// Folder `images/` of the run.
    pub images: &'a Path,
    /// Polled often; returns true to stop the run.
    pub stop: Stop<'a>,
}

impl std::fmt::Debug for ExperimentContext<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ExperimentContext").field("settings", self.settings).finish_non_exhaustive()
    }
}

impl ExperimentContext<'_> {
    /// Returns what all cells of the run share. `scene` is the scene as the user named it.
    pub fn identity(&self, experiment: &str, scene: &str) -> Identity {
        let walk = serde_json::to_string(self.walk).unwrap_or_default();
        Identity {
            experiment: experiment.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.to_owned(),
            scene_sha256: self.tracer.scene().hash.clone(),
            settings: RunRecord::default()
                .with_fields(self.settings)
                .with("walk_sha256", sha256_hex(walk.as_bytes()))
                .with_fields(&serde_json::json!({"stiffness": self.tracer.scene().conditioning})),
        }
    }

    /// Returns the camera at a share of the walk: 0 is its start, 1 its end; other shares are
    /// clamped.
    ///
    /// # Errors
    /// [`ExperimentError::EmptyWalk`] for a walk without key frames.
    pub fn camera_on_walk(&self, share: f64) -> Result<Camera, ExperimentError> {
        /// The walk is divided into this many frames: a share is rounded to a ten-thousandth.
        const FRAMES: u32 = 10_001;
        let frame = (f64::from(FRAMES - 1) * share.clamp(0.0, 1.0)).round() as u32;
        self.walk.camera(frame, FRAMES).ok_or(ExperimentError::EmptyWalk)
    }

    /// Writes an 8-bit sRGB picture to `images/`.
    ///
    /// # Errors
    /// [`ExperimentError::Save`] if the file cannot be written.
    pub fn save_picture(&self, name: &str, size: [u32; 2], srgb: &[[u8; 3]]) -> Result<(), ExperimentError> {
        Ok(save_png(&self.images.join(name), size, srgb, &[])?)
    }
}
