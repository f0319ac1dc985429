//! The manifest of a run folder: what was run, how much of it is finished, and on which machines.

use super::{identity::Identity, shard::Shard};
use serde::{Deserialize, Serialize};
use sysinfo::{CpuRefreshKind, System};

/// Content of `manifest.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Format of the folder's files.
    pub format: u32,
    /// What was run.
    #[serde(flatten)]
    pub identity: Identity,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Shard of the cells that the folder holds.
    pub shard: Shard,
    /// Number of cells of the whole experiment.
    pub cells: usize,
    /// Number of finished cells.
    pub cells_done: usize,
    /// True if every cell of the shard is finished.
    pub is_complete: bool,
    /// Processes that worked on the folder, in order.
    pub sessions: Vec<Session>,
}

/// Format of the files that this version writes. A folder of another format is refused.
pub(super) const FORMAT: u32 = 1;

impl Manifest {
    /// The manifest of a run that begins.
    pub(super) fn new(identity: Identity, shard: Shard, cells: usize) -> Self {
        let seed = identity.settings.0.get("seed").and_then(serde_json::Value::as_u64).unwrap_or(0);
        let (cells_done, is_complete, sessions) = (0, false, Vec::new());
        Self { format: FORMAT, identity, seed, shard, cells, cells_done, is_complete, sessions }
    }
}

/// One process that worked on the folder.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// Command line.
    pub argv: Vec<String>,
    /// Commit of the source, if it was known when the program was built.
    pub commit: Option<String>,
    /// True if the program was built with optimisations.
    pub is_release_build: bool,
    /// Machine on which the process ran.
    pub machine: Machine,
    /// Number of tracing threads.
    pub threads: usize,
    /// Start time in seconds since 1970, UTC.
    pub started_unix_secs: u64,
}

/// Properties of a machine that times depend on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor; empty if the system does not report it.
    pub processor: String,
    /// Number of logical cores.
    pub logical_cores: usize,
    /// Memory in gigabytes, if the system reports it.
    pub memory_gb: Option<f64>,
    /// Name and version of the operating system; empty if it does not report them.
    #[serde(default)]
    pub system: String,
    /// Operating system, such as `linux`.
    pub os: String,
    /// Architecture, such as `x86_64`.
    pub arch: String,
}

impl Machine {
    /// Describes this machine.
    pub fn here() -> Self {
        let system = System::new().map(|mut system| {
            system.refresh_memory();
            system.refresh_cpu_list(CpuRefreshKind::nothing());
            system
        });
        let processor = system.as_ref().ok().and_then(|s| Some(s.cpus().first()?.brand().trim().to_owned()));
        let bytes = system.as_ref().map_or(0, System::total_memory);
        Self {
            processor: processor.unwrap_or_default(),
            logical_cores: std::thread::available_parallelism().map_or(0, usize::from),
            memory_gb: (bytes > 0).then(|| (bytes as f64 / 1.024e8).round() / 10.0),
            system: System::long_os_version().unwrap_or_default(),
            os: std::env::consts::OS.to_owned(),
            arch: std::env::consts::ARCH.to_owned(),
        }
    }
}

impl Session {
    /// The session that begins now. `commit` is the commit of the source, if it is known.
    pub fn now(argv: Vec<String>, commit: Option<&str>) -> Self {
        let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        Self {
            argv,
            commit: commit.map(str::to_owned),
            is_release_build: !cfg!(debug_assertions),
            machine: Machine::here(),
            threads: rayon::current_num_threads(),
            started_unix_secs: since.map_or(0, |d| d.as_secs()),
        }
    }
}
