//! All figures as one table.

use crate::experiment::run::report::{Block, Section};
use crate::experiment::run::{Identity, Report, RunRecord};

/// Reports the figures as they are. The summary has them under the same names as the answer without
/// a run folder.
pub(crate) fn report(identity: &Identity, records: &[RunRecord]) -> Report {
    let Some(figures) = records.first() else { return Report::default() };
    let mut summary = figures.0.clone();
    summary.remove("part");
    let rows = summary.iter().map(|(name, value)| vec![name.clone().into(), value.clone()]);
    let table = Block::table("All figures; units are in the names", ["figure", "value"], rows);
    for name in ["size", "samples", "seed"] {
        summary.insert(name.to_owned(), identity.settings.0.get(name).cloned().unwrap_or_default());
    }
    let number = |name: &str| figures.number(name).unwrap_or(f64::NAN);
    let headline = format!(
        "{:.1} million primary and {:.1} million shadow rays per second on {} threads; the warp takes {:.1} times the time \
         of its memory bound.",
        number("primary_mrays_per_sec"),
        number("shadow_mrays_per_sec"),
        number("threads"),
        number("warp_over_memory_floor"),
    );
    let sections = vec![Section::new("The stages", vec![table])];
    Report { headline: vec![headline], summary, sections, ..Report::default() }
}
