//! Which cells of a run belong to one process.

use serde::{Deserialize, Serialize};

/// Every `count`-th cell, beginning with cell `index`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Index of the shard, from 0 to `count` - 1.
    pub index: u32,
    /// Number of shards, at least 1.
    pub count: u32,
}

/// Why a shard cannot be determined.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ShardError(String);

impl Shard {
    /// All cells.
    pub const ALL: Self = Self { index: 0, count: 1 };

    /// Parses `I/N`, with I from 0 to N - 1 or from 1 to N: N counts as 0, so that both ways of
    /// counting cover all cells. `/N` takes I from the scheduler's environment; without `text` both
    /// come from there. Without a scheduler the shard is all cells. `variable` reads an environment
    /// variable.
    ///
    /// # Errors
    /// [`ShardError`] if the text or a variable is invalid, or if a number is missing.
    pub fn of(text: Option<&str>, variable: impl Fn(&str) -> Option<String>) -> Result<Self, ShardError> {
        let from_scheduler = Scheduled::read(&variable)?;
        let Some(text) = text else { return from_scheduler.map_or(Ok(Self::ALL), Scheduled::shard) };
        let wanted =
            || ShardError(format!("'{text}' is not a shard; write I/N, such as 0/4, or /N in an array job"));
        let (index, count) = text.split_once('/').ok_or_else(wanted)?;
        let count = count.parse().ok().filter(|n| *n > 0).ok_or_else(wanted)?;
        let index = match (index, from_scheduler) {
            ("", Some(scheduled)) => scheduled.index,
            ("", None) => {
                let names: Vec<&str> = SCHEDULERS.iter().map(|s| s[0]).collect();
                let cause = format!("'{text}' has no I, and none of {} is set", names.join(", "));
                return Err(ShardError(cause));
            }
            (index, _) => index.parse().map_err(|_| wanted())?,
        };
        Self::checked(index, count)
    }

    fn checked(index: u32, count: u32) -> Result<Self, ShardError> {
        if index > count {
            return Err(ShardError(format!(
                "shard {index}/{count} is out of range; I must be from 0 to {count}"
            )));
        }
        Ok(Self { index: index % count, count })
    }

    /// Returns true if the shard contains the cell at this position in the list of cells.
    pub fn has(self, cell: usize) -> bool {
        cell % self.count as usize == self.index as usize
    }
}

/// Variables for index, count, first index and step in the array jobs of Slurm, Kubernetes and AWS
/// Batch. Kubernetes has no variable for the number of completions; the manifest in
/// `docs/history/LAB_DIARY.md` sets one.
const SCHEDULERS: [[&str; 4]; 3] = [
    ["SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_STEP"],
    ["JOB_COMPLETION_INDEX", "JOB_COMPLETIONS", "", ""],
    ["AWS_BATCH_JOB_ARRAY_INDEX", "AWS_BATCH_JOB_ARRAY_SIZE", "", ""],
];

/// The position of this process in an array job, and the names of its variables.
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
            ShardError(format!("{index} is set, {count} is not; give the number of shards: --shard /N"))
        })?;
        Shard::checked(self.index, total)
    }
}
