//! Aggregates the records of each setup: medians and their spread over repetitions and over the
//! walk.

use crate::experiment::run::{RunRecord, counted};
use crate::experiment::statistics::{median, quartiles};
use std::collections::BTreeMap;

/// A measure of error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Metric {
    /// Position in [`METRICS`].
    pub(super) index: usize,
    /// Name in records.
    pub(super) field: &'static str,
    /// Name in reports.
    pub(super) name: &'static str,
    /// True if higher is better and the scale is already logarithmic.
    pub(super) is_decibel: bool,
}

/// The metric of the headline.
pub(super) const LEAD: Metric =
    Metric { index: 0, field: "flip_mean", name: "FLIP, mean", is_decibel: false };

/// All metrics, the one of the headline first.
pub(super) const METRICS: [Metric; 4] = [
    LEAD,
    Metric { index: 1, field: "psnr_db", name: "PSNR, dB", is_decibel: true },
    Metric { index: 2, field: "rel_mse", name: "relMSE", is_decibel: false },
    Metric { index: 3, field: "flip_p95", name: "FLIP, 95th percentile", is_decibel: false },
];

impl Metric {
    /// Converts a value to an error: lower is better, zero is none.
    pub(super) fn error(self, value: f64) -> f64 {
        if self.is_decibel { 10f64.powf(-value / 10.0) } else { value }
    }
}

/// Measurements at one view or frame of the walk.
#[derive(Clone, Debug, Default)]
pub(super) struct ViewResult {
    /// Frame times of all repetitions that count.
    frame_secs: Vec<f64>,
    /// Share of the walk's reference time that a frame pays.
    reference_secs: f64,
    /// Values of [`METRICS`].
    values: [f64; METRICS.len()],
}

impl ViewResult {
    /// Median time of a frame, with its share of the references if they count.
    pub(super) fn secs(&self, references_count: bool) -> f64 {
        let own = median(self.frame_secs.iter().copied()).unwrap_or(f64::NAN);
        if references_count { own + self.reference_secs } else { own }
    }

    /// Value of a metric.
    pub(super) fn value(&self, metric: Metric) -> f64 {
        self.values[metric.index]
    }
}

/// A mode with its number of references and samples, over all views of the walk.
#[derive(Clone, Debug)]
pub(super) struct Setup {
    pub(super) mode: String,
    /// Number of references; `None` if the walk was flown with its own.
    pub(super) references: Option<usize>,
    pub(super) samples: usize,
    /// Results by the number of the view or frame.
    pub(super) views: BTreeMap<usize, ViewResult>,
}

impl Setup {
    /// Groups the records of still views and of flown walks, in the order of the records.
    pub(super) fn all(records: &[RunRecord]) -> Vec<Self> {
        let mut setups: Vec<Self> = Vec::new();
        for record in counted(records) {
            let Some((mode, references, samples)) = key(record) else { continue };
            let is_it = |s: &Self| s.mode == mode && s.references == references && s.samples == samples;
            let index = setups.iter().position(is_it).unwrap_or_else(|| {
                setups.push(Self { mode: mode.to_owned(), references, samples, views: BTreeMap::new() });
                setups.len() - 1
            });
            setups[index].add(record);
        }
        for setup in &mut setups {
            setup.share_flown_references();
        }
        setups
    }

    fn add(&mut self, record: &RunRecord) {
        let number = |name: &str| record.number(name);
        let (Some(at), Some(secs)) = (number("view").or(number("frame")), number("frame_secs")) else {
            return;
        };
        let view = self.views.entry(at as usize).or_default();
        view.frame_secs.push(secs);
        view.reference_secs += number("flown_reference_secs").unwrap_or(0.0);
        if let Some(spread) = number("spread_reference_secs") {
            view.reference_secs = spread;
        }
        view.values = METRICS.map(|m| number(m.field).unwrap_or(f64::NAN));
    }

    /// Spreads the time of references over all frames: a flown walk records it at the frame that
    /// traced one.
    fn share_flown_references(&mut self) {
        if self.references.is_none() {
            let sum: f64 = self.views.values().map(|v| v.reference_secs).sum();
            let share = sum / self.views.len().max(1) as f64;
            self.views.values_mut().for_each(|v| v.reference_secs = share);
        }
    }

    /// Views with errors: all still views, and some frames of a flown walk.
    pub(super) fn measured(&self) -> impl Iterator<Item = (&usize, &ViewResult)> + Clone {
        self.views.iter().filter(|(_, v)| v.values.iter().all(|v| v.is_finite()))
    }

    /// Median frame time over the walk.
    pub(super) fn secs(&self, references_count: bool) -> f64 {
        median(self.views.values().map(|v| v.secs(references_count))).unwrap_or(f64::NAN)
    }

    /// Median of a metric over the walk.
    pub(super) fn value(&self, metric: Metric) -> f64 {
        median(self.measured().map(|(_, v)| v.value(metric))).unwrap_or(f64::NAN)
    }

    /// Median frame time and error over the walk.
    pub(super) fn secs_and_error(&self, metric: Metric, references_count: bool) -> [f64; 2] {
        [self.secs(references_count), metric.error(self.value(metric))]
    }

    /// Quartiles of the frame time over repetitions and the walk.
    pub(super) fn secs_range(&self, references_count: bool) -> Option<[f64; 2]> {
        let share = |v: &ViewResult| if references_count { v.reference_secs } else { 0.0 };
        quartiles(self.views.values().flat_map(|v| v.frame_secs.iter().map(move |s| s + share(v))))
    }

    /// Quartiles of a metric over the walk.
    pub(super) fn value_range(&self, metric: Metric) -> Option<[f64; 2]> {
        quartiles(self.measured().map(|(_, v)| v.value(metric)))
    }

    /// Returns a label such as `4 references, 16 samples`.
    pub(super) fn label(&self) -> String {
        let samples = counted_word(self.samples, "sample");
        match self.references {
            None => format!("flown, {samples}"),
            Some(0) => samples,
            Some(n) => format!("{}, {samples}", counted_word(n, "reference")),
        }
    }
}

/// Mode, references and samples of a record.
fn key(record: &RunRecord) -> Option<(&str, Option<usize>, usize)> {
    let number = |name: &str| record.number(name).map(|n| n as usize);
    let references = match record.text("kind")? {
        "still" => Some(number("references")?),
        "flown" => None,
        _ => return None,
    };
    Some((record.text("mode")?, references, number("samples")?))
}

/// Returns a count with its noun, such as `1 sample` or `2 samples`.
fn counted_word(count: usize, word: &str) -> String {
    format!("{count} {word}{}", if count == 1 { "" } else { "s" })
}
