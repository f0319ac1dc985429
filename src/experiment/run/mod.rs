//! Experiments that last: cells, a journal of what is done, shards, and a report.
//!
//! # Adding an experiment
//! 1. Write one file `src/experiment/NAME.rs` with a `pub const EXPERIMENT: Experiment`.
//! 2. `cells` lists what is to be done, each cell a [`RunRecord`] of what sets it apart (`mode`, `samples`, ...).
//! 3. `run_cell` does one of them and returns flat records: names with units, `repetition`, `is_warm_up: true` where it
//!    does not count. Pictures go to `context.save_picture`. Names that hold `_secs`, `speedup`, `per_sec`, `_ns` or `_us`
//!    may differ from run to run; all others must be the same to the bit for a seed. `None` after a stop.
//! 4. `report` turns records, of whatever cells are done, into sentences, a summary, tables and charts.
//! 5. Add it to [`EXPERIMENTS`].
//!
//! The rest is done here and in the command line: resuming, shards, merging, progress, CSV, JSON, plots, `report.html`.

mod caveats;
mod folder;
mod journal;
mod manifest;
mod merge;
mod plan;
mod record;
pub mod report;

pub use caveats::{NOISY_SHARE, caveats, spreads};
pub use folder::{RunFolder, read_manifest};
pub use journal::{Done, Journal};
pub use manifest::{Machine, Manifest, Session};
pub use merge::merge;
pub use plan::{Cell, Identity, Shard, ShardError};
pub use record::{RunRecord, counted};
pub use report::Report;

use super::{error_time, placement, scaling, soak, stability, table1, throughput};
use crate::camera::CameraPath;
use crate::raster::color::metered_exposure_ev;
use crate::raster::save::{SaveError, save_png};
use crate::trace::parallel::Stop;
use crate::trace::{TraceSettings, Tracer};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Every experiment that can be run by its name.
pub const EXPERIMENTS: &[Experiment] = &[
    table1::EXPERIMENT,
    error_time::EXPERIMENT,
    placement::EXPERIMENT,
    scaling::EXPERIMENT,
    throughput::EXPERIMENT,
    stability::EXPERIMENT,
    soak::EXPERIMENT,
];

/// An experiment, as data.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// On the command line.
    pub name: &'static str,
    /// What it is about, in one line.
    pub about: &'static str,
    /// What is asked for where the user says nothing else.
    pub settings: fn(Effort) -> ExperimentSettings,
    /// What is to be done.
    pub cells: fn(&ExperimentContext<'_>) -> Vec<Cell>,
    /// Does one of them. `None` after a stop.
    pub run_cell: fn(&ExperimentContext<'_>, &RunRecord) -> CellOutcome,
    /// What the records say.
    pub report: fn(&Identity, &[RunRecord]) -> Report,
}

/// What a cell left. `None` after a stop.
pub type CellOutcome = Result<Option<Vec<RunRecord>>, ExperimentError>;

/// How long a run may take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    /// Seconds to a few minutes on two cores: small pictures, few steps.
    Quick,
    /// What the figures of `docs/EXPERIMENTS.md` are made with: some minutes on two cores.
    #[default]
    Usual,
}

/// What every experiment is told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExperimentSettings {
    /// How much is tried.
    pub effort: Effort,
    /// Of pictures.
    pub size: [u32; 2],
    /// Shadow rays per light and pixel, where they are not what is varied.
    pub samples: u32,
    /// Diffuse bounces.
    pub bounces: u32,
    /// Of all random numbers.
    pub seed: u64,
    /// Timed repetitions of a frame, after one that warms up and does not count.
    pub repetitions: u32,
    /// Views along the walk.
    pub views: u32,
    /// Frames of the walk, where it is flown.
    pub frames: u32,
    /// Shadow rays of the converged pictures that errors are measured against.
    pub truth_samples: u32,
    /// Memory for references.
    pub cache_mb: u64,
    /// Stops that pictures are brought up by before they are shown and compared; see [`ExperimentContext::exposure_ev`].
    #[serde(skip_serializing_if = "Option::is_none")] // TOML knows no nothing
    pub exposure_ev: Option<f32>,
}

impl Default for ExperimentSettings {
    fn default() -> Self {
        Self {
            effort: Effort::Usual,
            size: [320, 180],
            samples: 16,
            bounces: 0,
            seed: 0,
            repetitions: 3,
            views: 5,
            frames: 300,
            truth_samples: 1024,
            cache_mb: 1024,
            exposure_ev: None,
        }
    }
}

impl ExperimentSettings {
    /// Samples, bounces, seed.
    pub fn trace(&self) -> TraceSettings {
        TraceSettings { samples: self.samples, bounces: self.bounces, seed: self.seed }
    }
}

/// Where cells are run.
#[derive(Clone, Copy)]
pub struct ExperimentContext<'a> {
    /// The scene.
    pub tracer: &'a Arc<Tracer>,
    /// The scene's own walk, or one that was recorded.
    pub walk: &'a CameraPath,
    /// What was asked for.
    pub settings: &'a ExperimentSettings,
    /// Where converged pictures are kept; `None` keeps none.
    pub truth_folder: Option<&'a Path>,
    /// The folder of pictures of the run.
    pub images: &'a Path,
    /// Asked often whether to stop.
    pub stop: Stop<'a>,
}

impl std::fmt::Debug for ExperimentContext<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lab").field("settings", self.settings).finish_non_exhaustive()
    }
}

/// Why a run cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// A folder that is not what it should be.
    #[error("{path}: {cause}", path = path.display())]
    Folder {
        /// Which one.
        path: PathBuf,
        /// What is wrong, and what to do.
        cause: String,
    },
    /// The system refused.
    #[error("{path}: {cause}", path = path.display())]
    File {
        /// What was meant.
        path: PathBuf,
        /// What the system said.
        cause: std::io::Error,
    },
    /// A picture or a table cannot be written.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// Pictures cannot be compared.
    #[error(transparent)]
    Compare(#[from] crate::raster::metrics::CompareError),
    /// A scene of the experiment's own cannot be made.
    #[error(transparent)]
    Scene(#[from] crate::scene::SceneError),
    /// The experiment cannot be done with this scene or these settings.
    #[error("{0}")]
    Unsuitable(String),
    /// Merging without folders.
    #[error("there is no folder to merge")]
    NothingToMerge,
}

impl ExperimentError {
    pub(super) fn at(path: &Path, cause: std::io::Error) -> Self {
        Self::File { path: path.to_owned(), cause }
    }
}

/// The experiment of a name.
pub fn find(name: &str) -> Option<&'static Experiment> {
    EXPERIMENTS.iter().find(|e| e.name == name)
}

impl ExperimentContext<'_> {
    /// What the run has in common, and what two runs must share to be joined. `scene` is the scene as it was named.
    pub fn identity(&self, experiment: &Experiment, scene: &str) -> Identity {
        let walk = serde_json::to_string(self.walk).unwrap_or_default();
        Identity {
            experiment: experiment.name.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.to_owned(),
            scene_sha256: self.tracer.scene().hash.clone(),
            settings: RunRecord::default()
                .with_fields(self.settings)
                .with("walk_sha256", super::truth::digest(&walk))
                .with_fields(&serde_json::json!({"stiffness": self.tracer.scene().conditioning})),
        }
    }

    /// The exposure, in stops, at which a view is shown and its errors are measured: what was asked for; else none for
    /// the embedded scenes, which are lit for it, and for others the one that suits the converged picture of the view:
    /// by the sun they may be black or white throughout, and then have no error.
    pub fn exposure_ev(&self, truth: &[Vec3]) -> f32 {
        let is_embedded = self.tracer.scene().name.starts_with("builtin:");
        let metered = || if is_embedded { None } else { metered_exposure_ev(truth) };
        self.settings.exposure_ev.or_else(metered).unwrap_or(0.0)
    }

    /// Writes an 8-bit sRGB picture to `images/`.
    ///
    /// # Errors
    /// [`ExperimentError::Save`] where it cannot be written.
    pub fn save_picture(&self, name: &str, size: [u32; 2], srgb: &[[u8; 3]]) -> Result<(), ExperimentError> {
        Ok(save_png(&self.images.join(name), size, srgb, &[])?)
    }
}

/// What happens in a run, as it happens.
#[derive(Clone, Copy, Debug)]
pub enum LabEvent<'a> {
    /// A cell begins; so many of the shard's cells are done.
    Begins(&'a Cell, usize),
    /// And ended.
    Done(&'a Cell, usize),
}

/// Runs the cells of the folder's shard that are not done yet. After a stop what was done is kept, and true is returned
/// only where all are done.
///
/// # Errors
/// [`ExperimentError`] where a cell cannot be done or kept; those before it are kept.
pub fn run_cells(
    experiment: &Experiment,
    context: &ExperimentContext<'_>,
    folder: &mut RunFolder,
    mut observe: impl FnMut(LabEvent<'_>),
) -> Result<bool, ExperimentError> {
    let identity = folder.manifest().identity.clone();
    let shard = folder.manifest().shard;
    let cells: Vec<Cell> = (experiment.cells)(context);
    let mine = cells.iter().enumerate().filter(|(place, _)| shard.has(*place));
    for (done, (place, cell)) in mine.enumerate() {
        let key = identity.key(cell);
        if !folder.has(&key) {
            observe(LabEvent::Begins(cell, done));
            let start = Instant::now();
            let records = if (context.stop)() { None } else { (experiment.run_cell)(context, &cell.0)? };
            let Some(records) = records else { return Ok(false) };
            let records = records.into_iter().map(|r| cell.0.clone().with_fields(&r)).collect();
            folder.add(Done { place, key, records, cell_secs: start.elapsed().as_secs_f64() })?;
        }
        observe(LabEvent::Done(cell, done + 1));
    }
    Ok(true)
}
