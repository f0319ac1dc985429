//! The report of a run: lines of text, and files in the run folder: `plots/*.svg`, `plots/*.png`,
//! and `report.html`, which needs no other file. The page of a tour shows pictures that lie next to
//! it.

mod axis;
mod chart;
mod page;
mod plots;
#[cfg(test)]
mod tests;
mod text;
mod tour;

pub(super) use text::report as text;
pub(super) use tour::{TourPage, write_tour_page};

use super::failure::Failure;
use afterimage::experiment::run::report::{Block, Chart};
use afterimage::experiment::run::{Report, RunFolder};
use afterimage::raster::save::write_atomically;

/// Writes the report's files into the folder of its run.
pub(super) fn write(folder: &RunFolder, report: &Report) -> Result<(), Failure> {
    let charts: Vec<&Chart> = charts(report).collect();
    plots::write(&folder.path().join("plots"), &charts)?;
    let page = page::html(folder.manifest(), folder.path(), report)?;
    write_atomically(&folder.path().join("report.html"), page.as_bytes())?;
    Ok(())
}

fn charts(report: &Report) -> impl Iterator<Item = &Chart> {
    report.sections.iter().flat_map(|s| &s.blocks).filter_map(|block| match block {
        Block::Chart(chart) => Some(chart),
        _ => None,
    })
}
