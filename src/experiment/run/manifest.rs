//! What a run folder says of itself.

use super::identity::Identity;
use super::shard::Shard;
use serde::{Deserialize, Serialize};

/// `manifest.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// The form of the folder; another version of the program may write another.
    pub format: u32,
    /// What was run.
    #[serde(flatten)]
    pub identity: Identity,
    /// Of all random numbers.
    pub seed: u64,
    /// Which part of the cells.
    pub shard: Shard,
    /// Cells of the whole experiment.
    pub cells: usize,
    /// Those that are done.
    pub cells_done: usize,
    /// Whether every cell of the shard is done.
    pub is_complete: bool,
    /// Every time somebody worked on the folder.
    pub sessions: Vec<Session>,
}

/// Of the folder's files; a folder of another form is refused.
pub(super) const FORMAT: u32 = 1;

/// One process that worked on the folder.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// The command line.
    pub argv: Vec<String>,
    /// Of the source, where it was known when the program was built.
    pub commit: Option<String>,
    /// Whether the program was built with all optimisations.
    pub is_release_build: bool,
    /// What it ran on.
    pub machine: Machine,
    /// Threads that trace.
    pub threads: usize,
    /// Seconds since 1970, UTC.
    pub started_unix_secs: u64,
}

/// What figures of time depend on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// As the system names it; empty where it does not.
    pub processor: String,
    /// Threads it runs at once.
    pub logical_cores: usize,
    /// Memory, where the system tells.
    pub memory_gb: Option<f64>,
    /// `linux`.
    pub os: String,
    /// `x86_64`.
    pub arch: String,
}

impl Machine {
    /// This one.
    pub fn here() -> Self {
        let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
        let value = |text: &str, name: &str| {
            let line = text.lines().find(|l| l.starts_with(name))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        };
        let kilobytes = value(&read("/proc/meminfo"), "MemTotal")
            .and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
        Self {
            processor: value(&read("/proc/cpuinfo"), "model name").unwrap_or_default(),
            logical_cores: std::thread::available_parallelism().map_or(0, usize::from),
            memory_gb: kilobytes.map(|kb| (kb / 1e5).round() / 10.0),
            os: std::env::consts::OS.to_owned(),
            arch: std::env::consts::ARCH.to_owned(),
        }
    }
}

impl Session {
    /// The one that begins now. `commit` is that of the source, where it is known.
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
