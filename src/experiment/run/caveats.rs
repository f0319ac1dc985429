//! What a reader must know before trusting the times of a run.

use super::manifest::Manifest;
use super::record::{RunRecord, counted};
use crate::experiment::statistics::{median, quartiles};
use std::collections::{BTreeMap, BTreeSet};

/// Repetitions are noisy if their quartiles lie further apart than this share of their median.
/// Measured on a run of `error-time` that shared two cores with compilers: the 22 calmest of 48
/// groups stayed within 13 %, the others reached 16 to 199 % (`docs/history/LAB_DIARY.md`).
pub const NOISY_SHARE: f64 = 0.15;

/// Minimum number of repetitions for a spread.
const MIN_REPETITIONS: usize = 3;

/// Returns the caveats as sentences; empty if there are none.
pub fn caveats(manifest: &Manifest, records: &[RunRecord]) -> Vec<String> {
    let mut found = Vec::new();
    let sessions = &manifest.sessions;
    if sessions.iter().any(|s| !s.is_release_build) {
        found.push(
            "A session ran a build without optimisations: its times are not representative.".to_owned(),
        );
    }
    let machines: BTreeSet<(&str, usize)> =
        sessions.iter().map(|s| (s.machine.processor.as_str(), s.threads)).collect();
    if machines.len() > 1 {
        found.push(format!(
            "The run used {} different processors or thread counts: times of different cells are not comparable.",
            machines.len()
        ));
    }
    let spreads = spreads(records);
    let noisy = spreads.iter().filter(|s| **s > NOISY_SHARE).count();
    if noisy > 0 {
        let worst = spreads.iter().copied().fold(0.0, f64::max);
        found.push(format!(
            "The times are noisy: in {noisy} of {} groups of repetitions the quartiles of the frame time lie more than \
             {:.0} % of the median apart (at worst {:.0} %). Other programs were probably running. Errors are not \
             affected.",
            spreads.len(),
            NOISY_SHARE * 100.0,
            worst * 100.0
        ));
    }
    found
}

/// Returns the distance of the quartiles of `frame_secs` as a share of the median, for every group
/// of repetitions.
pub fn spreads(records: &[RunRecord]) -> Vec<f64> {
    let mut groups: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for record in counted(records).filter(|r| r.number("repetition").is_some()) {
        // All fields that are equal in every repetition identify the group.
        let mut group = record.without_times();
        group.0.shift_remove("repetition");
        if let (Some(secs), Ok(key)) = (record.number("frame_secs"), serde_json::to_string(&group)) {
            groups.entry(key).or_default().push(secs);
        }
    }
    groups.values().filter_map(|secs| spread(secs)).collect()
}

fn spread(secs: &[f64]) -> Option<f64> {
    let [lower, upper] = quartiles(secs.iter().copied())?;
    let middle = median(secs.iter().copied()).filter(|m| *m > 0.0 && secs.len() >= MIN_REPETITIONS)?;
    Some((upper - lower) / middle)
}
