//! Which cells of a run belong to one process.

use serde::{Deserialize, Serialize};

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
