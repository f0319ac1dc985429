//! `afterimage bake`: fills a store with references of the whole scene.

use super::flags::{Flags, StoreChoice, number_in};
use super::scene::{Loaded, load};
use super::{failure::Failure, interrupt, output, progress::SharedProgress, walk::read_path};
use crate::picture::memory;
use afterimage::experiment::run::Shard;
use afterimage::render::bake::{BakePlacement, BakePlan, BakeProgress, BakeReport, BakeSettings, bake};
use afterimage::store::{StoreBuilder, StoreSettings};
use clap::{Args, builder::PossibleValuesParser};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

#[derive(Args, Clone, Debug)]
pub(crate) struct BakeArgs {
    /// A model (.obj, .gltf, .glb) or builtin:NAME [default: the embedded gallery].
    pub(super) scene: Option<String>,
    /// Where references are placed: where they add most to what can be seen from the walkable
    /// space, on a grid over it, or along a camera path.
    #[arg(long, value_name = "greedy|grid|path", default_value = "greedy")]
    #[arg(value_parser = PossibleValuesParser::new(["greedy", "grid", "path"]), hide_possible_values = true)]
    placement: String,
    /// A recorded camera path (JSON) for --placement path [default: the scene's own]; FILE#NAME
    /// selects one of several.
    #[arg(long, value_name = "FILE[#NAME]")]
    path: Option<String>,
    /// Stop after this time. What is done then is kept, and the same command continues it. A plan
    /// that is done earlier is lit again with twice the samples, seconds.
    #[arg(long, value_name = "S", value_parser = number_in(0.001..=3.2e7, " seconds"))]
    #[arg(conflicts_with = "hours")]
    seconds: Option<f64>,
    /// The same in hours.
    #[arg(long, value_name = "H", value_parser = number_in(0.000_001..=8766.0, " hours"))]
    hours: Option<f64>,
    /// Trace every N-th reference of the plan, from I on; in an array job, the scheduler's
    /// environment gives I or both.
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    shard: Option<String>,
}

/// What a bake is given besides the scene.
struct Job {
    store: StoreSettings,
    placement: Option<BakePlacement>,
    shard: Shard,
    limit: Option<Duration>,
    start: Instant,
}

pub(crate) fn run(args: &BakeArgs, flags: &Flags) -> Result<(), Failure> {
    let job = Job::of(args, flags)?;
    memory::check(flags.pixels(), 1)?;
    let loaded = load(args.scene.as_deref(), flags)?;
    let mut store = StoreBuilder::open(&job.store, &loaded.tracer)?;
    for problem in store.problems() {
        output::say(&format!("warning: {problem}"));
    }
    let plan = plan(&job, flags, &loaded)?;
    let plan_secs = job.start.elapsed().as_secs_f64();
    let report = light(&job, flags, &plan, &mut store);
    loaded.say_bounds();
    let object = object(args, flags, &loaded, &job, (&report, plan_secs, store.bytes()));
    output::result(flags.json, &object, || table(&job, &report, store.bytes()));
    match report.problem {
        Some(problem) => Err(problem.into()),
        None if interrupt::is_cancelled() => Err(Failure::Interrupted),
        None => loaded.verdict(flags),
    }
}

impl Job {
    fn of(args: &BakeArgs, flags: &Flags) -> Result<Self, Failure> {
        let start = Instant::now();
        if !flags.mode.looks_up() {
            return Err(Failure::Usage(format!(
                "a bake is for the modes 'exact' and 'fast'; mode '{}' does not look light up",
                flags.mode.name()
            )));
        }
        let store = flags.store(&StoreChoice::Off).ok_or_else(|| {
            Failure::Usage("a bake needs a store: --store DIR, or --store default".to_owned())
        })?;
        let placement = match (args.placement.as_str(), &args.path) {
            ("path", Some(path)) => Some(BakePlacement::along(&read_path(path)?)),
            ("path", None) => None,
            (_, Some(_)) => return Err(Failure::Usage("--path needs --placement path".to_owned())),
            ("grid", None) => Some(BakePlacement::Grid),
            _ => Some(BakePlacement::Greedy),
        };
        let shard = Shard::of(args.shard.as_deref(), |name| std::env::var(name).ok())
            .map_err(|error| Failure::Usage(format!("--shard: {error}")))?;
        let secs = args.seconds.or(args.hours.map(|hours| hours * 3600.0));
        Ok(Self { store, placement, shard, limit: secs.map(Duration::from_secs_f64), start })
    }

    fn is_over(&self) -> bool {
        self.limit.is_some_and(|limit| self.start.elapsed() >= limit)
    }

    /// The part of the time or of the work that is done, whichever ends the bake, 0..1.
    fn part(&self, progress: &BakeProgress) -> f64 {
        match self.limit {
            Some(limit) => (self.start.elapsed().as_secs_f64() / limit.as_secs_f64()).min(1.0),
            None => progress.part,
        }
    }
}

/// Plans the bake.
fn plan(job: &Job, flags: &Flags, loaded: &Loaded) -> Result<BakePlan, Failure> {
    let placement = job.placement.clone();
    let placement = placement.unwrap_or_else(|| BakePlacement::along(&loaded.scene().walk));
    let stop = || interrupt::is_cancelled() || job.is_over();
    let plan = BakePlan::new(&loaded.tracer, &placement, flags.size(), &stop);
    if plan.is_err() && !interrupt::is_cancelled() && job.is_over() {
        return Err(Failure::Failed(
            "the time was over before the plan was made; nothing was baked".to_owned(),
        ));
    }
    Ok(plan?)
}

/// Lights the references of a plan, with progress on stderr.
fn light(job: &Job, flags: &Flags, plan: &BakePlan, store: &mut StoreBuilder) -> BakeReport {
    let settings = BakeSettings {
        trace: flags.trace(),
        shard: [job.shard.index, job.shard.count],
        repeats: job.limit.is_some(),
    };
    let progress = SharedProgress::new("baking");
    let stop = || interrupt::is_cancelled() || job.is_over();
    bake(plan, &settings, store, &stop, |now| progress.note(job.part(now), &note(now)))
}

/// The line of progress of a bake: pass, references, coverage and error.
fn note(now: &BakeProgress) -> String {
    let error = now.error.map_or(String::new(), |error| format!(", error {:.1} %", 100.0 * error));
    let pass = if now.pass > 0 { format!("pass {}, ", now.pass + 1) } else { String::new() };
    format!("{pass}{} of {} references, {:.1} % covered{error}", now.stored, now.planned, 100.0 * now.covered)
}

fn object(
    args: &BakeArgs,
    flags: &Flags,
    loaded: &Loaded,
    job: &Job,
    (report, plan_secs, store_bytes): (&BakeReport, f64, u64),
) -> Value {
    let now = &report.progress;
    json!({
        "scene": loaded.name,
        "scene_hash": loaded.scene().hash,
        "version": env!("CARGO_PKG_VERSION"),
        "size": flags.size(),
        "samples": flags.trace().samples,
        "bounces": flags.trace().bounce_limit(),
        "seed": flags.seed,
        "threads": rayon::current_num_threads(),
        "placement": args.placement,
        "shard": format!("{}/{}", job.shard.index, job.shard.count),
        "planned": now.planned,
        "already_stored": report.already_stored,
        "traced": report.traced,
        "is_complete": report.passes > 0,
        "passes": report.passes,
        "coverage_percent": 100.0 * report.covered,
        "estimated_error_percent": report.error.map(|error| 100.0 * error),
        "store_bytes": store_bytes,
        "secs": job.start.elapsed().as_secs_f64(),
        "plan_secs": plan_secs,
    })
}

fn table(job: &Job, report: &BakeReport, store_bytes: u64) -> String {
    let now = &report.progress;
    let error = report.error.map_or("-".to_owned(), |error| {
        format!("{:.1} % of the light, root mean square, estimated", 100.0 * error)
    });
    output::table(&[
        ("store", job.store.folder.display().to_string()),
        ("references", format!("{} traced, {} stored before", report.traced, report.already_stored)),
        ("plan", format!("{} references, {} whole passes", now.planned, report.passes)),
        ("covered", format!("{:.1} % of what can be seen", 100.0 * report.covered)),
        ("error", error),
        ("size", format!("{:.1} MB", store_bytes as f64 / 1e6)),
        ("time", format!("{:.1} s", job.start.elapsed().as_secs_f64())),
    ])
}
