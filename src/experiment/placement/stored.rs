//! The rules with a store of references: on a second walk, and on a walk after a bake along it.

use super::policies::POLICIES;
use super::{reference_usage::ReferenceUsage, summary::summary};
use crate::camera::Camera;
use crate::experiment::run::report::{Block, row};
use crate::experiment::run::{Cell, CellOutcome, ExperimentContext, ExperimentError, RunRecord, matching};
use crate::experiment::tour::{TourRecord, TourSettings, fly};
use crate::render::Mode;
use crate::render::bake::{BakeError, BakePlacement, BakePlan, BakeSettings, bake};
use crate::store::{StoreBuilder, StoreError, StoreSettings};
use std::time::Instant;

const MODE: Mode = Mode::Exact;
const WALK: &str = "fast";

/// A walk whose references an earlier walk has stored, and one whose references were baked.
const STORES: [&str; 2] = ["second walk", "bake"];

/// Size of a store at most, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// One walk with each rule and store, at the first percentage of the rule.
pub(super) fn cells() -> impl Iterator<Item = Cell> {
    let of = |store: &'static str| {
        POLICIES.iter().map(move |policy| {
            let record = RunRecord::default().with("mode", MODE.name()).with("walk", WALK);
            let record = record.with("rule", policy.rule).with("percent", policy.percents(MODE)[0]);
            Cell(record.with("store", store))
        })
    };
    STORES.into_iter().flat_map(of)
}

/// Fills a store and walks with it.
pub(super) fn run(
    context: &ExperimentContext<'_>,
    (cameras, settings): (&[Camera], &TourSettings),
    store: &str,
) -> CellOutcome {
    let here = std::env::temp_dir();
    let folder = tempfile::tempdir().map_err(|cause| ExperimentError::at(&here, cause))?;
    let store_settings = StoreSettings { folder: folder.path().to_owned(), max_bytes: MAX_BYTES };
    let start = Instant::now();
    let settings = TourSettings { store: Some(store_settings.clone()), ..settings.clone() };
    if store == "bake" {
        bake_along(context, cameras, (&settings, &store_settings)).map_err(unsuitable)?;
    } else {
        fly(
            context.tracer,
            cameras,
            &TourSettings { measure: None, ..settings.clone() },
            context.stop,
            |_| {},
        )?;
    }
    let filling_secs = start.elapsed().as_secs_f64();
    let tour = fly(context.tracer, cameras, &settings, context.stop, |_| {})?;
    Ok(tour.is_complete.then(|| vec![record(&tour, filling_secs)]))
}

/// Lights what a walk sees, with the samples of the walk.
fn bake_along(
    context: &ExperimentContext<'_>,
    cameras: &[Camera],
    (tour, store): (&TourSettings, &StoreSettings),
) -> Result<(), String> {
    let placement = BakePlacement::Poses(cameras.to_vec());
    let plan = match BakePlan::new(context.tracer, &placement, tour.size, context.stop) {
        Err(BakeError::Stopped) => return Ok(()),
        plan => plan.map_err(|error| error.to_string())?,
    };
    let settings = BakeSettings { trace: tour.walkthrough.render.trace, shard: [0, 1], repeats: false };
    let mut store = StoreBuilder::open(store, context.tracer).map_err(|error| error.to_string())?;
    let report = bake(&plan, &settings, &mut store, context.stop, |_| {});
    report.problem.as_ref().map(StoreError::to_string).map_or(Ok(()), Err)
}

fn unsuitable(problem: String) -> ExperimentError {
    ExperimentError::Unsuitable(problem)
}

fn record(tour: &TourRecord, filling_secs: f64) -> RunRecord {
    summary(tour, &ReferenceUsage::default())
        .with("kind", "stored summary")
        .with("references_from_store", tour.store.references_from_store)
        .with("filling_secs", filling_secs)
        .with("store_secs", tour.store.store_secs)
}

/// Columns of the table: field, title and factor of the unit.
const COLUMNS: [(&str, &str, f64); 8] = [
    ("filling_secs", "filling the store, s", 1.0),
    ("references_from_store", "references read", 1.0),
    ("references", "traced", 1.0),
    ("reference_secs", "seconds on them", 1.0),
    ("traced_mrays", "million rays in all", 1.0),
    ("unseen_percent", "unseen, %", 1.0),
    ("frame_secs", "frame, ms", 1e3),
    ("psnr_db", "PSNR, dB", 1.0),
];

/// The rules without a store, on a second walk and after a bake.
pub(super) fn table(mode: Mode, records: &[RunRecord]) -> Option<Block> {
    let line = |rule: &str, percent: f64, store: Option<&str>| {
        let wanted = RunRecord::default().with("mode", mode.name()).with("walk", WALK);
        let wanted = wanted.with("rule", rule).with("percent", percent);
        let wanted = match store {
            Some(store) => wanted.with("kind", "stored summary").with("store", store),
            None => wanted.with("kind", "summary"),
        };
        let found = matching(records, &wanted).first().copied()?;
        let value = |(name, _, factor): (&str, &str, f64)| factor * found.number(name).unwrap_or(f64::NAN);
        Some(row(format!("{rule}, {}", store.unwrap_or("no store")), COLUMNS.map(value)))
    };
    let stores = || std::iter::once(None).chain(STORES.map(Some));
    let lines = POLICIES.iter().flat_map(|policy| {
        stores().filter_map(move |store| line(policy.rule, policy.percents(mode)[0], store))
    });
    let title = format!("Mode {}, walk {WALK}: with a store of references", mode.name());
    let has_stores =
        !matching(records, &RunRecord::default().with("mode", mode.name()).with("kind", "stored summary"))
            .is_empty();
    has_stores.then(|| Block::table(title, std::iter::once("rule").chain(COLUMNS.map(|c| c.1)), lines))
}
