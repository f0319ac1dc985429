//! Records of one setting brought together: medians and their spread over repetitions and over the walk.

use crate::experiment::run::{RunRecord, counted};
use crate::experiment::statistics::{median, percentile};
use std::collections::BTreeMap;

/// A measure of error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Metric {
    /// In records.
    pub(super) field: &'static str,
    /// For people.
    pub(super) name: &'static str,
    /// PSNR is better where it is higher; it grows with the logarithm already.
    pub(super) is_decibel: bool,
}

/// The first is the one that sentences speak of.
pub(super) const METRICS: [Metric; 4] = [
    Metric { field: "flip_mean", name: "FLIP, mean", is_decibel: false },
    Metric { field: "psnr_db", name: "PSNR, dB", is_decibel: true },
    Metric { field: "rel_mse", name: "relMSE", is_decibel: false },
    Metric { field: "flip_p95", name: "FLIP, 95th percentile", is_decibel: false },
];

impl Metric {
    /// Lower is better, zero is none.
    pub(super) fn error(self, value: f64) -> f64 {
        if self.is_decibel { 10f64.powf(-value / 10.0) } else { value }
    }
}

/// A place of the walk.
#[derive(Clone, Debug, Default)]
pub(super) struct SurfaceKey {
    /// Of all repetitions that count.
    pub(super) frame_secs: Vec<f64>,
    /// What a frame pays for the references of the walk.
    pub(super) reference_secs: f64,
    /// As in [`METRICS`].
    pub(super) values: [f64; METRICS.len()],
}

impl SurfaceKey {
    /// Of a frame, without or with its share of references.
    pub(super) fn secs(&self, references_count: bool) -> f64 {
        let own = median(self.frame_secs.iter().copied()).unwrap_or(f64::NAN);
        if references_count { own + self.reference_secs } else { own }
    }
}

/// A mode with its references and samples, over the places of the walk.
#[derive(Clone, Debug)]
pub(super) struct Setup {
    pub(super) mode: String,
    /// `None` where the walk was flown with its own.
    pub(super) references: Option<usize>,
    pub(super) samples: usize,
    pub(super) places: BTreeMap<usize, SurfaceKey>,
}

impl Setup {
    /// Of still views and of flown walks alike, in the order of the records.
    pub(super) fn all(records: &[RunRecord]) -> Vec<Self> {
        let mut setups: Vec<Self> = Vec::new();
        for record in counted(records) {
            let Some((mode, references, samples)) = key(record) else { continue };
            let is_it = |s: &&mut Self| s.mode == mode && s.references == references && s.samples == samples;
            match setups.iter_mut().find(is_it) {
                Some(setup) => setup.add(record),
                None => {
                    let mut setup =
                        Self { mode: mode.to_owned(), references, samples, places: BTreeMap::new() };
                    setup.add(record);
                    setups.push(setup);
                }
            }
        }
        setups.iter_mut().for_each(Self::share_flown_references);
        setups
    }

    fn add(&mut self, record: &RunRecord) {
        let number = |name: &str| record.number(name);
        let (Some(at), Some(secs)) = (number("view").or(number("frame")), number("frame_secs")) else {
            return;
        };
        let place = self.places.entry(at as usize).or_default();
        place.frame_secs.push(secs);
        place.reference_secs += number("flown_reference_secs").unwrap_or(0.0);
        if let Some(spread) = number("spread_reference_secs") {
            place.reference_secs = spread;
        }
        place.values = METRICS.map(|m| number(m.field).unwrap_or(f64::NAN));
    }

    /// A flown walk pays for a reference where it is made; every frame has its share of it.
    fn share_flown_references(&mut self) {
        if self.references.is_none() {
            let sum: f64 = self.places.values().map(|p| p.reference_secs).sum();
            let share = sum / self.places.len().max(1) as f64;
            self.places.values_mut().for_each(|p| p.reference_secs = share);
        }
    }

    /// Places that have errors: all of still views, some of a flown walk.
    pub(super) fn measured(&self) -> impl Iterator<Item = (&usize, &SurfaceKey)> + Clone {
        self.places.iter().filter(|(_, p)| p.values.iter().all(|v| v.is_finite()))
    }

    /// Median over the walk.
    pub(super) fn secs(&self, references_count: bool) -> f64 {
        median(self.places.values().map(|p| p.secs(references_count))).unwrap_or(f64::NAN)
    }

    /// Median over the walk.
    pub(super) fn value(&self, metric: usize) -> f64 {
        median(self.measured().map(|(_, p)| p.values[metric])).unwrap_or(f64::NAN)
    }

    /// Quartiles over repetitions and the walk.
    pub(super) fn secs_range(&self, references_count: bool) -> Option<[f64; 2]> {
        let share = |p: &SurfaceKey| if references_count { p.reference_secs } else { 0.0 };
        quartiles(self.places.values().flat_map(|p| p.frame_secs.iter().map(move |s| s + share(p))))
    }

    /// Quartiles over the walk.
    pub(super) fn value_range(&self, metric: usize) -> Option<[f64; 2]> {
        quartiles(self.measured().map(|(_, p)| p.values[metric]))
    }

    /// `4 references, 16 samples`.
    pub(super) fn label(&self) -> String {
        let samples = counted_word(self.samples, "sample");
        match self.references {
            None => format!("flown, {samples}"),
            Some(0) => samples,
            Some(n) => format!("{}, {samples}", counted_word(n, "reference")),
        }
    }
}

fn key(record: &RunRecord) -> Option<(&str, Option<usize>, usize)> {
    let number = |name: &str| record.number(name).map(|n| n as usize);
    let references = match record.text("kind")? {
        "still" => Some(number("references")?),
        "flown" => None,
        _ => return None,
    };
    Some((record.text("mode")?, references, number("samples")?))
}

fn quartiles(values: impl Iterator<Item = f64> + Clone) -> Option<[f64; 2]> {
    Some([percentile(values.clone(), 25.0)?, percentile(values, 75.0)?])
}

/// `1 sample`, `2 samples`.
pub(super) fn counted_word(count: usize, word: &str) -> String {
    format!("{count} {word}{}", if count == 1 { "" } else { "s" })
}
