//! Lights the references of a plan.

use super::demand::Cover;
use super::error::ErrorEstimate;
use super::plan::BakePlan;
use crate::lookup::LookupSet;
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::store::{StoreBuilder, StoreError};
use crate::trace::{TraceSettings, parallel::Stop};

/// Cost of finding the surfaces of a reference, as a share of lighting all of its pixels.
const SURFACES_COST: f64 = 0.02;

/// Samples of a pixel, at most: further ones would not change light of nine bits.
const MAX_SAMPLES: u32 = 1 << 14;

/// How the references of a plan are lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeSettings {
    /// Samples of the first pass, bounces and seed.
    pub trace: TraceSettings,
    /// This process traces every n-th reference of the plan, from some number below n on.
    pub shard: [u32; 2],
    /// Whether the plan is lit again once it is done, with twice the samples each time, until the
    /// bake is stopped.
    pub repeats: bool,
}

/// Progress of a bake, as it goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BakeProgress {
    /// The pass, from zero on.
    pub pass: u32,
    /// Samples of a pixel in this pass.
    pub samples: u32,
    /// References of this pass that are stored.
    pub stored: usize,
    /// References of a pass.
    pub planned: usize,
    /// The share of the work of this pass that is done, 0..1.
    pub part: f64,
    /// The share of what can be seen from the walkable places, or from the camera path, that
    /// references of the plan light, 0..1.
    pub covered: f64,
    /// Estimated error of the light that this process traced, as a share of the light: in the first
    /// pass so far, then in the last whole pass. `None` before the first reference.
    pub error: Option<f64>,
}

/// Result of a bake.
#[derive(Debug, Default)]
pub struct BakeReport {
    /// Where it ended.
    pub progress: BakeProgress,
    /// References that the store had before, of all passes that were begun.
    pub already_stored: usize,
    /// References that were traced.
    pub traced: usize,
    /// Passes that are whole.
    pub passes: u32,
    /// The share of what can be seen that some pass has lit, 0..1.
    pub covered: f64,
    /// Estimated error of the references that were traced in the last whole pass, or the first.
    pub error: Option<f64>,
    /// Why references could not be stored.
    pub problem: Option<StoreError>,
}

/// Lights the references of a plan, in its order, and adds them to a store, which is of the same
/// scene. References that the store has are not traced again. A stop ends the bake; what was traced
/// of the reference in progress is lost.
pub fn bake(
    plan: &BakePlan,
    settings: &BakeSettings,
    store: &mut StoreBuilder,
    stop: Stop<'_>,
    mut observe: impl FnMut(&BakeProgress),
) -> BakeReport {
    let mut report = BakeReport::default();
    for pass in 0.. {
        let samples = u64::from(settings.trace.samples.max(1)) << pass;
        if pass > 0 && (!settings.repeats || samples > u64::from(MAX_SAMPLES)) {
            break;
        }
        if !Pass::new(plan, settings, pass).run(store, stop, &mut report, &mut observe) {
            break;
        }
        report.passes = pass + 1;
    }
    if let Err(error) = store.finish() {
        report.problem.get_or_insert(error);
    }
    report
}

/// One pass over the plan.
struct Pass<'p> {
    plan: &'p BakePlan,
    settings: &'p BakeSettings,
    number: u32,
    cover: Cover<'p>,
    error: ErrorEstimate,
    cost: f64,
    cost_done: f64,
    progress: BakeProgress,
}

impl<'p> Pass<'p> {
    fn new(plan: &'p BakePlan, settings: &'p BakeSettings, number: u32) -> Self {
        let mut pass = Self {
            plan,
            settings,
            number,
            cover: Cover::new(&plan.demand),
            error: ErrorEstimate::default(),
            cost: 0.0,
            cost_done: 0.0,
            progress: BakeProgress { pass: number, ..BakeProgress::default() },
        };
        let own = pass.own();
        (pass.progress.planned, pass.cost) = (own.len(), own.iter().map(|&at| pass.cost_of(at)).sum());
        pass
    }

    /// The references of this process.
    fn own(&self) -> Vec<usize> {
        let [index, count] = self.settings.shard.map(|number| number as usize);
        (0..self.plan.len()).filter(|at| at % count.max(1) == index).collect()
    }

    fn cost_of(&self, at: usize) -> f64 {
        self.plan.entries[at].mask.share() + SURFACES_COST
    }

    /// Lights the references that are missing. False where the bake is over before that is done.
    fn run(
        &mut self,
        store: &mut StoreBuilder,
        stop: Stop<'_>,
        report: &mut BakeReport,
        observe: &mut impl FnMut(&BakeProgress),
    ) -> bool {
        let (tracer, plan) = (store.tracer().clone(), self.plan);
        let mut cache = ReferenceCache::new(tracer.scene(), 0);
        cache.prepare_cells(tracer.scene(), &self.settings.trace);
        let empty = LookupSet::without_references(&cache, tracer.epoch());
        let (stored, missing): (Vec<usize>, Vec<usize>) = self.own().into_iter().partition(|&at| {
            let settings = plan.settings(at, &self.settings.trace, self.number);
            store.holds(&plan.entries[at].camera, plan.size, &settings)
        });
        report.already_stored += stored.len();
        stored.into_iter().for_each(|at| self.count(at));
        for at in missing {
            let trace = plan.settings(at, &self.settings.trace, self.number);
            self.progress.samples = trace.samples;
            self.tell(report, observe);
            let (camera, is_lit) = (&plan.entries[at].camera, |pixel| plan.lights(at, pixel));
            let traced =
                ReferenceFrame::trace_where(&tracer, camera, plan.size, &trace, &empty, is_lit, stop);
            let Some(reference) = traced else { return false };
            if reference.lit() > 0
                && let Err(problem) = store.add(&reference)
            {
                report.problem = Some(problem);
                return false;
            }
            report.traced += 1;
            self.error.add(&tracer, &reference, stop);
            self.count(at);
        }
        self.tell(report, observe);
        true
    }

    /// Counts a reference that is stored.
    fn count(&mut self, at: usize) {
        self.cover.add(&self.plan.entries[at].counts);
        self.cost_done += self.cost_of(at);
        self.progress.stored += 1;
    }

    fn tell(&mut self, report: &mut BakeReport, observe: &mut impl FnMut(&BakeProgress)) {
        self.progress.part = if self.cost > 0.0 { self.cost_done / self.cost } else { 1.0 };
        (self.progress.covered, self.progress.error) = (self.cover.share(), self.error.relative());
        // The estimate of a few references has outliers, so that of the last whole pass stays.
        let is_whole = self.progress.stored == self.progress.planned;
        if self.number == 0 || is_whole {
            report.error = self.progress.error.or(report.error);
        }
        self.progress.error = report.error;
        report.covered = self.progress.covered.max(report.covered);
        report.progress = self.progress;
        observe(&self.progress);
    }
}
