//! All figures as one table.

use crate::experiment::run::report::{Block, Section, Table};
use crate::experiment::run::{Identity, Report, RunRecord};

/// The figures as they are; the summary has them under the names of the one-line answer.
pub(crate) fn report(identity: &Identity, records: &[RunRecord]) -> Report {
    let Some(figures) = records.first() else { return Report::default() };
    let mut summary = figures.0.clone();
    summary.remove("part");
    for name in ["size", "samples", "seed"] {
        summary.insert(name.to_owned(), identity.settings.0.get(name).cloned().unwrap_or_default());
    }
    let rows = figures.0.iter().filter(|(name, _)| *name != "part");
    let table = Table {
        title: "All figures; units are in the names".to_owned(),
        columns: vec!["figure".to_owned(), "value".to_owned()],
        rows: rows.map(|(name, value)| vec![name.clone().into(), value.clone()]).collect(),
    };
    let number = |name: &str| figures.number(name).unwrap_or(f64::NAN);
    let headline = format!(
        "{:.1} million primary and {:.1} million shadow rays a second on {} threads; the warp takes {:.1} times its memory \
         floor.",
        number("primary_mrays_per_sec"),
        number("shadow_mrays_per_sec"),
        number("threads"),
        number("warp_over_memory_floor"),
    );
    let section = Section { title: "The parts".to_owned(), blocks: vec![Block::Table(table)] };
    Report { headline: vec![headline], summary, sections: vec![section], ..Report::default() }
}
