//! The framework of long runs: cells, a journal of finished cells, shards, merging, and a report.
//!
//! It names no experiment; `registry` lists them. `docs/how_to_add/experiment.md` shows how to add
//! one.

mod caveats;
mod cells;
mod context;
mod csv;
mod error;
mod experiment;
mod folder;
mod identity;
mod journal;
mod manifest;
mod merge;
mod record;
pub mod report;
mod settings;
mod shard;

pub use caveats::{NOISY_SHARE, caveats, spreads};
pub use cells::{CellEvent, run_cells};
pub use context::ExperimentContext;
pub use csv::csv;
pub use error::ExperimentError;
pub use experiment::{CellOutcome, Experiment};
pub use folder::{RunFolder, read_manifest};
pub use identity::{Cell, Identity};
pub use journal::{Done, Journal};
pub use manifest::{Machine, Manifest, Session};
pub use merge::merge;
pub use record::{RunRecord, counted, matching, median_of};
pub use report::Report;
pub use settings::{Effort, ExperimentSettings};
pub use shard::{Shard, ShardError};
