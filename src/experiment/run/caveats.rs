//! What a reader must know before trusting a run's times.

use super::manifest::Manifest;
use super::record::{RunRecord, counted};
use crate::experiment::statistics::{median, percentile};
use std::collections::{BTreeMap, BTreeSet};

/// Repetitions whose quartiles lie further apart than this share of their median are called noisy. Measured on a run of
/// `error-time` that shared two cores with compilers: the 22 calmest of 48 groups lay within 13 %, the others reached
/// 16 to 199 % (`docs/EXPERIMENTS.md`).
pub const NOISY_SHARE: f64 = 0.15;

/// Fewer say nothing of a spread.
const FEWEST: usize = 3;

/// In sentences; none where there is nothing to say.
pub fn caveats(manifest: &Manifest, records: &[RunRecord]) -> Vec<String> {
    let mut found = Vec::new();
    let sessions = &manifest.sessions;
    if sessions.iter().any(|s| !s.is_release_build) {
        found.push("Run with a build without all optimisations: its times say little.".to_owned());
    }
    let machines: BTreeSet<(&str, usize)> =
        sessions.iter().map(|s| (s.machine.processor.as_str(), s.threads)).collect();
    if machines.len() > 1 {
        found.push(format!(
            "Run on {} machines or numbers of threads: times of different cells do not compare.",
            machines.len()
        ));
    }
    let spreads = spreads(records);
    let noisy = spreads.iter().filter(|s| **s > NOISY_SHARE).count();
    if noisy > 0 {
        let worst = spreads.iter().copied().fold(0.0, f64::max);
        found.push(format!(
            "Noisy: in {noisy} of {} groups of repetitions the quartiles of the frame time lie more than {:.0} % of \
             the median apart (worst {:.0} %). Something else was running; errors are not touched by it.",
            spreads.len(),
            NOISY_SHARE * 100.0,
            worst * 100.0
        ));
    }
    found
}

/// The distance of the quartiles of `frame_secs` as a share of the median, for every group of repetitions.
pub fn spreads(records: &[RunRecord]) -> Vec<f64> {
    let mut groups: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for record in counted(records).filter(|r| r.number("repetition").is_some()) {
        // What is the same in every repetition names the group.
        let mut group = record.without_times();
        group.0.shift_remove("repetition");
        if let (Some(secs), Ok(key)) = (record.number("frame_secs"), serde_json::to_string(&group)) {
            groups.entry(key).or_default().push(secs);
        }
    }
    groups.values().filter_map(|secs| spread(secs)).collect()
}

fn spread(secs: &[f64]) -> Option<f64> {
    let quartile = |percent| percentile(secs.iter().copied(), percent);
    let middle = median(secs.iter().copied()).filter(|m| *m > 0.0 && secs.len() >= FEWEST)?;
    Some((quartile(75.0)? - quartile(25.0)?) / middle)
}
