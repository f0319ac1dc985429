//! Renders a panorama from the top to the bottom, in the way of its mode.

use super::lit::LitPanorama;
use super::picture::{Panorama, PanoramaBand};
use super::traced::TracedPanorama;
use crate::render::settings::Mode;
use crate::trace::{RayCounts, parallel::Stop};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Part of the time that references take, 0..1, for the progress that is shown.
const LIGHT_SHARE: f64 = 0.5;

/// Times and rays of a panorama.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PanoramaStats {
    /// False where a stop left rows out.
    pub is_complete: bool,
    /// Rays of references and rows.
    pub rays: RayCounts,
    /// Time that references took, seconds; zero in mode `full`.
    pub reference_secs: f64,
    /// All time, seconds, including what the receiver of the rows took.
    pub secs: f64,
}

impl Panorama<'_> {
    /// Renders all rows and hands them to `write`, band by band from the top. A stop ends the work
    /// after a band, and the rows so far remain valid. `report` is called, perhaps from several
    /// threads, with the finished part, 0..1.
    ///
    /// # Errors
    /// The first error of `write`.
    pub fn render<E>(
        &self,
        stop: Stop<'_>,
        report: &(dyn Fn(f64) + Sync),
        write: &mut dyn FnMut(PanoramaBand) -> Result<(), E>,
    ) -> Result<PanoramaStats, E> {
        let start = Instant::now();
        let mut stats = match self.settings.mode {
            Mode::Full | Mode::Paper => self.render_traced(stop, report, write),
            Mode::Fast | Mode::Exact => self.render_lit(stop, report, write),
        }?;
        stats.secs = start.elapsed().as_secs_f64();
        Ok(stats)
    }

    fn render_traced<E>(
        &self,
        stop: Stop<'_>,
        report: &(dyn Fn(f64) + Sync),
        write: &mut dyn FnMut(PanoramaBand) -> Result<(), E>,
    ) -> Result<PanoramaStats, E> {
        let (traced, mut stats) = (TracedPanorama::new(*self), PanoramaStats::default());
        let counter = Counter { done: AtomicU64::new(0), of: self.pixels(), from: 0.0, report };
        for rows in traced.bands() {
            let Some(band) = traced.render(rows, stop, &|more| counter.add(more)) else { return Ok(stats) };
            stats.rays += band.rays;
            write(band)?;
        }
        stats.is_complete = true;
        Ok(stats)
    }

    fn render_lit<E>(
        &self,
        stop: Stop<'_>,
        report: &(dyn Fn(f64) + Sync),
        write: &mut dyn FnMut(PanoramaBand) -> Result<(), E>,
    ) -> Result<PanoramaStats, E> {
        let lighting = LitPanorama::light(*self, stop, &|part| report(part * LIGHT_SHARE));
        let Some(mut lit) = lighting else { return Ok(PanoramaStats::default()) };
        let (rays, reference_secs) = (lit.reference_rays(), lit.reference_secs());
        let mut stats = PanoramaStats { rays, reference_secs, ..PanoramaStats::default() };
        let counter = Counter { done: AtomicU64::new(0), of: self.pixels(), from: LIGHT_SHARE, report };
        for rows in lit.bands() {
            let Some(band) = lit.render(rows, stop, &|more| counter.add(more)) else { return Ok(stats) };
            stats.rays += band.rays;
            write(band)?;
        }
        stats.is_complete = true;
        Ok(stats)
    }

    fn pixels(&self) -> u64 {
        self.size.map(u64::from).iter().product()
    }
}

/// Counts finished pixels and reports their part.
struct Counter<'a> {
    done: AtomicU64,
    of: u64,
    /// Part of the work that was finished before the first pixel, 0..1.
    from: f64,
    report: &'a (dyn Fn(f64) + Sync),
}

impl Counter<'_> {
    fn add(&self, more: u64) {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        (self.report)(self.from + (1.0 - self.from) * done as f64 / self.of.max(1) as f64);
    }
}
