//! What is to be done, cell by cell, and which cells are this process's share.

use super::RunRecord;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// The smallest part of an experiment that is done or not done: what sets it apart from the other cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell(pub RunRecord);

/// What every cell of a run has in common, and what two runs must share to be joined.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Of [`super::EXPERIMENTS`].
    pub experiment: String,
    /// Of the program: another one may give other figures.
    pub version: String,
    /// As it was named.
    pub scene: String,
    /// SHA-256 of what decides a picture.
    pub scene_sha256: String,
    /// Everything that was asked for, as resolved.
    pub settings: RunRecord,
}

impl Identity {
    /// A stable name of a cell: SHA-256 of the run's identity and the cell's own settings.
    pub fn key(&self, cell: &Cell) -> String {
        let text = serde_json::to_string(&(self, &cell.0)).unwrap_or_default();
        Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// In which way another run is not of the same kind, if it is not.
    pub fn difference(&self, other: &Identity) -> Option<String> {
        let fields = |i: &Identity| {
            [
                ("experiment", i.experiment.clone()),
                ("version", i.version.clone()),
                ("scene", i.scene.clone()),
                ("scene SHA-256", i.scene_sha256.clone()),
            ]
        };
        let told = fields(self).into_iter().zip(fields(other)).find(|(a, b)| a != b);
        if let Some(((name, ours), (_, theirs))) = told {
            return Some(format!("{name} {theirs} there, {ours} here"));
        }
        let names = self.settings.0.keys().chain(other.settings.0.keys());
        let value = |i: &Identity, name: &String| {
            i.settings.0.get(name).map_or("none".to_owned(), ToString::to_string)
        };
        names
            .map(|name| (name, value(self, name), value(other, name)))
            .find(|(_, ours, theirs)| ours != theirs)
            .map(|(name, ours, theirs)| format!("{name} {theirs} there, {ours} here"))
    }
}

/// Every `count`-th cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// From 0, below `count`.
    pub index: u32,
    /// At least 1.
    pub count: u32,
}

/// Why there is no such shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ShardError(String);

impl Shard {
    /// The whole.
    pub const ALL: Self = Self { index: 0, count: 1 };

    /// `I/N`, I from 0 to N - 1 or from 1 to N: N counts as 0, so that both ways of counting cover everything.
    /// `/N` takes I from the scheduler's environment, and no text takes both from there; the whole where there is none.
    ///
    /// # Errors
    /// [`ShardError`] in words.
    pub fn of(text: Option<&str>, variable: impl Fn(&str) -> Option<String>) -> Result<Self, ShardError> {
        let from_scheduler = Scheduled::read(&variable)?;
        let Some(text) = text else { return from_scheduler.map_or(Ok(Self::ALL), Scheduled::shard) };
        let wanted =
            || ShardError(format!("'{text}' is no shard; write I/N, like 0/4, or /N in an array job"));
        let (index, count) = text.split_once('/').ok_or_else(wanted)?;
        let count = count.parse().ok().filter(|n| *n > 0).ok_or_else(wanted)?;
        let index = match (index, from_scheduler) {
            ("", Some(scheduled)) => scheduled.index,
            ("", None) => {
                let names: Vec<&str> = SCHEDULERS.iter().map(|s| s[0]).collect();
                return Err(ShardError(format!(
                    "'{text}' has no I, and none of {} is set",
                    names.join(", ")
                )));
            }
            (index, _) => index.parse().map_err(|_| wanted())?,
        };
        Self::checked(index, count)
    }

    fn checked(index: u32, count: u32) -> Result<Self, ShardError> {
        if index > count {
            return Err(ShardError(format!("shard {index}/{count} is out of range; I is from 0 to {count}")));
        }
        Ok(Self { index: index % count, count })
    }

    /// True where the cell at this place of the plan is in the shard.
    pub fn has(self, cell: usize) -> bool {
        cell % self.count as usize == self.index as usize
    }
}

/// Index, count, first index, step: the variables of the array jobs of Slurm, Kubernetes and AWS Batch. Kubernetes has
/// no variable for the number of completions; the manifest in `docs/EXPERIMENTS.md` sets one.
const SCHEDULERS: [[&str; 4]; 3] = [
    ["SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_STEP"],
    ["JOB_COMPLETION_INDEX", "JOB_COMPLETIONS", "", ""],
    ["AWS_BATCH_JOB_ARRAY_INDEX", "AWS_BATCH_JOB_ARRAY_SIZE", "", ""],
];

/// What a scheduler says of this process.
#[derive(Debug)]
struct Scheduled {
    index: u32,
    count: Option<u32>,
    names: [&'static str; 4],
}

impl Scheduled {
    fn read(variable: &impl Fn(&str) -> Option<String>) -> Result<Option<Self>, ShardError> {
        let number = |name: &str| match variable(name).filter(|_| !name.is_empty()) {
            None => Ok(None),
            Some(text) => text
                .parse::<u32>()
                .map(Some)
                .map_err(|_| ShardError(format!("{name} is '{text}'; it must be a whole number"))),
        };
        for names in SCHEDULERS {
            let [index, count, first, step] = names;
            let Some(index) = number(index)? else { continue };
            let (count, first, step) =
                (number(count)?, number(first)?.unwrap_or(0), number(step)?.unwrap_or(1));
            return Ok(Some(Self { index: index.saturating_sub(first) / step.max(1), count, names }));
        }
        Ok(None)
    }

    fn shard(self) -> Result<Shard, ShardError> {
        let [index, count, ..] = self.names;
        let total = self.count.filter(|n| *n > 0).ok_or_else(|| {
            ShardError(format!("{index} is set, {count} is not; say the number of shards: --shard /N"))
        })?;
        Shard::checked(self.index, total)
    }
}
