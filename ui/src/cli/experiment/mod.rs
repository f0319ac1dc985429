//! `afterimage experiment NAME`: runs an experiment into a folder, and merges the folders of
//! shards.

mod args;
mod run;
mod throughput;

pub(super) use args::ExperimentArgs;
pub(super) use run::run;
