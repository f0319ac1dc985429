//! Arguments of `afterimage experiment`.

use crate::cli::{failure::Failure, flags::number_in};
use afterimage::experiment::registry::EXPERIMENTS;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use std::path::PathBuf;

/// Name that merges shards instead of running an experiment.
const MERGE: &str = "merge";

/// Scene of an experiment if none is given.
const DEFAULT_SCENE: &str = "builtin:gallery-bench";

fn names() -> impl Iterator<Item = PossibleValue> {
    let experiments = EXPERIMENTS.iter().map(|e| PossibleValue::new(e.name).help(e.about));
    experiments.chain([PossibleValue::new(MERGE).help("join the folders of shards")])
}

#[derive(Args, Debug)]
pub(crate) struct ExperimentArgs {
    /// Name of the experiment; merge joins the folders of shards.
    #[arg(value_parser = PossibleValuesParser::new(names()))]
    pub(super) name: String,
    /// A model (.obj, .gltf, .glb) or builtin:NAME [default: builtin:gallery-bench, which never
    /// changes]; for merge, the folders of the shards.
    #[arg(value_name = "SCENE")]
    pub(super) inputs: Vec<String>,
    /// Folder of the run. An interrupted run of the same experiment is resumed; a folder of any
    /// other run is refused. Only throughput and at-rest run without one, and keep no files.
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Run every N-th cell, from I on; in an array job, the scheduler's environment gives I or
    /// both.
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    pub(super) shard: Option<String>,
    /// Small pictures and few steps: seconds to a few minutes.
    #[arg(long)]
    pub(super) quick: bool,
    /// Timed repetitions of a frame, after one untimed repetition.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(super) repetitions: Option<u32>,
    /// Number of views along the camera path.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(super) views: Option<u32>,
    /// Number of frames of a camera path.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(super) frames: Option<u32>,
    /// A recorded camera path (JSON) [default: the scene's own]; FILE#NAME selects one of several.
    #[arg(long, value_name = "FILE[#NAME]")]
    pub(super) path: Option<String>,
    /// Memory for references, MB.
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    pub(super) cache_mb: Option<u64>,
    /// Samples, as of --samples, of the converged pictures against which errors are measured.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(super) truth_samples: Option<u32>,
    /// Folder in which converged pictures are kept [default: the user's cache folder].
    #[arg(long, value_name = "DIR")]
    pub(super) truth_cache: Option<PathBuf>,
    /// at-rest: times after which the picture is compared, seconds.
    #[arg(long, value_name = "S,S,...", value_delimiter = ',')]
    #[arg(value_parser = number_in(0.001..=86_400.0, " seconds"))]
    pub(super) seconds: Vec<f64>,
    /// at-rest: samples of the picture of mode full to compare with [default: 256]; 0 for none.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1 << 20))]
    pub(super) full_samples: Option<u32>,
    /// throughput: write the triangles and the timed rays to a file, for other programs.
    #[arg(long, value_name = "FILE")]
    pub(super) dump_rays: Option<PathBuf>,
}

impl ExperimentArgs {
    /// The scene argument, or the scene on which speed is measured.
    pub(super) fn scene(&self) -> Result<&str, Failure> {
        match self.inputs.as_slice() {
            [] => Ok(DEFAULT_SCENE),
            [scene] => Ok(scene),
            [_, second, ..] => {
                Err(Failure::Usage(format!("an experiment takes one scene; '{second}' is a second")))
            }
        }
    }
}
