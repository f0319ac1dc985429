//! `afterimage experiment NAME`: a run folder, resumed where it was begun, and `merge` for the shards of one.

mod text;

pub(crate) use text::shown;

use crate::cli::failure::Failure;
use crate::cli::flags::Flags;
use crate::cli::pose::camera;
use crate::cli::progress::Progress;
use crate::cli::scene::{Loaded, load};
use crate::cli::tour::read_path;
use crate::cli::{interrupt, output, paths, report as report_files, throughput};
use crate::picture::memory;
use afterimage::camera::CameraPath;
use afterimage::experiment::registry::{EXPERIMENTS, find};
use afterimage::experiment::run::{
    CellEvent, Effort, Experiment, ExperimentContext, ExperimentError, ExperimentSettings, Report, RunFolder,
    Session, Shard, caveats, merge, run_cells,
};
use afterimage::experiment::throughput::{ThroughputSettings, gather_rays};
use afterimage::raster::save::write_atomically;
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub(crate) struct ExperimentArgs {
    /// Which one: table1, error-time, placement, scaling, stability, soak, throughput; or merge, which joins the folders of shards.
    #[arg(value_parser = name)]
    name: String,
    /// A model (.obj, .gltf, .glb) or builtin:NAME, the embedded gallery when absent; for merge, the folders.
    #[arg(value_name = "SCENE")]
    inputs: Vec<String>,
    /// The folder of the run. One in which the same run was begun is gone on with; any other is left alone.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Does every N-th cell only; I or both come from the scheduler's environment in an array job.
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    shard: Option<String>,
    /// Small pictures and few steps: seconds to a few minutes.
    #[arg(long)]
    quick: bool,
    /// Timed repetitions of a frame, after one that does not count.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    repetitions: Option<u32>,
    /// Views along the walk.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    views: Option<u32>,
    /// Frames of a walk that is flown.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: Option<u32>,
    /// A recorded walk (JSON) instead of the scene's own; FILE#NAME takes one of several.
    #[arg(long, value_name = "FILE[#NAME]")]
    path: Option<String>,
    /// Memory for references.
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    cache_mb: Option<u64>,
    /// Shadow rays per light and pixel of the converged pictures that errors are measured against.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    truth_samples: Option<u32>,
    /// Where converged pictures are kept; the user's cache folder when absent.
    #[arg(long, value_name = "DIR")]
    truth_cache: Option<PathBuf>,
    /// throughput: writes the triangles and the rays that were timed, for other programs.
    #[arg(long, value_name = "FILE")]
    pub(crate) dump_rays: Option<PathBuf>,
}

impl ExperimentArgs {
    /// The scene named, if one is.
    pub(crate) fn scene(&self) -> Result<Option<&str>, Failure> {
        match self.inputs.as_slice() {
            [] => Ok(None),
            [scene] => Ok(Some(scene)),
            [_, second, ..] => {
                Err(Failure::Usage(format!("an experiment takes one scene; '{second}' is a second")))
            }
        }
    }
}

const THROUGHPUT: &str = "throughput";
const MERGE: &str = "merge";

fn name(text: &str) -> Result<String, String> {
    let names = || EXPERIMENTS.iter().map(|e| e.name).chain([MERGE]);
    if names().any(|n| n == text) {
        return Ok(text.to_owned());
    }
    Err(format!("there are {}", names().collect::<Vec<_>>().join(", ")))
}

pub(crate) fn run(args: &ExperimentArgs, flags: &Flags) -> Result<(), Failure> {
    match find(&args.name) {
        Some(_) if args.name == THROUGHPUT && args.out.is_none() => throughput::run(args, flags),
        Some(experiment) => run_one(experiment, args, flags),
        None => join(args, flags),
    }
}

fn run_one(experiment: &Experiment, args: &ExperimentArgs, flags: &Flags) -> Result<(), Failure> {
    let out = out(args)?;
    let shard = Shard::of(args.shard.as_deref(), |name| std::env::var(name).ok())
        .map_err(|e| Failure::Usage(e.to_string()))?;
    let recorded = args.path.as_deref().map(read_path).transpose()?;
    let settings = settings(experiment, args, flags);
    memory::check(settings.size.map(u64::from).iter().product(), MAX_REFERENCES).map_err(Failure::Usage)?;
    let loaded = load(args.scene()?, flags)?;
    let truth_folder = args.truth_cache.clone().or_else(|| paths::cache_folder().map(|c| c.join("truth")));
    let images = out.join("images");
    let walk = walk(experiment, recorded, flags, &loaded)?;
    if let Some(path) = &args.dump_rays {
        dump_rays(path, &loaded, &walk, &settings)?;
    }
    let context = ExperimentContext {
        tracer: &loaded.tracer,
        walk: &walk,
        settings: &settings,
        truth_folder: truth_folder.as_deref(),
        images: &images,
        stop: &interrupt::is_cancelled,
    };
    let cells = (experiment.cells)(&context).len();
    let identity = context.identity(experiment.name, &loaded.name);
    let mut folder = RunFolder::open(&out, identity, shard, cells, session())?;
    let done = run_with_progress(experiment, &context, &mut folder);
    // What was done is worth its tables, whatever happened to the rest.
    let report = finish(experiment, &mut folder)?;
    let is_complete = done?;
    print(&folder, &report, flags);
    if !is_complete {
        return Err(Failure::Interrupted);
    }
    verdict(&report, Some(&loaded), flags)
}

/// The walk of a file, or standing at a pose where one is given or only one is asked for, or the scene's own.
fn walk(
    experiment: &Experiment,
    recorded: Option<CameraPath>,
    flags: &Flags,
    loaded: &Loaded,
) -> Result<CameraPath, Failure> {
    let stands = experiment.name == THROUGHPUT || flags.eye.is_some() || flags.view.is_some();
    match recorded {
        Some(walk) => Ok(walk),
        None if stands => Ok(CameraPath::still(&camera(flags, loaded.scene())?)),
        None => Ok(loaded.scene().walk.clone()),
    }
}

/// The rays that are timed, for other programs.
fn dump_rays(
    path: &Path,
    loaded: &Loaded,
    walk: &CameraPath,
    settings: &ExperimentSettings,
) -> Result<(), Failure> {
    let camera = walk.camera(0, 2).ok_or_else(|| Failure::Failed("the walk has no key frames".to_owned()))?;
    let settings = ThroughputSettings { camera, size: settings.size, trace: settings.trace() };
    let rays = gather_rays(&loaded.tracer, &settings);
    Ok(write_atomically(path, &rays.to_bytes(&loaded.tracer))?)
}

/// References a frame of an experiment uses at most.
const MAX_REFERENCES: u64 = 8;

fn out(args: &ExperimentArgs) -> Result<PathBuf, Failure> {
    let missing =
        || Failure::Usage(format!("experiment {} needs --out DIR, the folder of its run", args.name));
    args.out.clone().ok_or_else(missing)
}

fn session() -> Session {
    Session::now(std::env::args().collect(), option_env!("AFTERIMAGE_COMMIT"))
}

/// The experiment's own, but for what was asked for.
fn settings(experiment: &Experiment, args: &ExperimentArgs, flags: &Flags) -> ExperimentSettings {
    let usual = (experiment.settings)(if args.quick { Effort::Quick } else { Effort::Usual });
    ExperimentSettings {
        size: flags.given_size.unwrap_or(usual.size),
        samples: flags.samples.unwrap_or(usual.samples),
        bounces: flags.bounces.unwrap_or(usual.bounces),
        seed: flags.seed,
        repetitions: args.repetitions.unwrap_or(usual.repetitions),
        views: args.views.unwrap_or(usual.views),
        frames: args.frames.unwrap_or(usual.frames),
        truth_samples: args.truth_samples.unwrap_or(usual.truth_samples),
        cache_mb: args.cache_mb.unwrap_or(usual.cache_mb),
        exposure_ev: flags.exposure,
        ..usual
    }
}

fn run_with_progress(
    experiment: &Experiment,
    context: &ExperimentContext<'_>,
    folder: &mut RunFolder,
) -> Result<bool, Failure> {
    let shard = folder.manifest().shard;
    let total = (0..folder.manifest().cells).filter(|&cell| shard.has(cell)).count();
    let mut progress = Progress::new(experiment.name, total as u64);
    let observe = |event: CellEvent<'_>| match event {
        CellEvent::Begins(cell, done) => progress.at(done as u64, &cell.0.label()),
        CellEvent::Done(cell, done) => progress.at(done as u64, &cell.0.label()),
    };
    Ok(run_cells(experiment, context, folder, observe)?)
}

fn finish(experiment: &Experiment, folder: &mut RunFolder) -> Result<Report, Failure> {
    let records = folder.records();
    let mut report = (experiment.report)(&folder.manifest().identity, &records);
    report.notes.extend(caveats(folder.manifest(), &records));
    folder.export(&report)?;
    report_files::write(folder, &report)?;
    Ok(report)
}

/// `merge`: the folders of shards become the folder of the whole.
fn join(args: &ExperimentArgs, flags: &Flags) -> Result<(), Failure> {
    let out = out(args)?;
    if args.inputs.is_empty() {
        return Err(Failure::Usage("merge needs the folders of the shards".to_owned()));
    }
    let folders: Vec<PathBuf> = args.inputs.iter().map(PathBuf::from).collect();
    let mut folder = merge(&folders, &out, session())?;
    let name = folder.manifest().identity.experiment.clone();
    let experiment =
        find(&name).ok_or_else(|| Failure::Failed(format!("this version has no experiment '{name}'")))?;
    let report = finish(experiment, &mut folder)?;
    print(&folder, &report, flags);
    let manifest = folder.manifest();
    if !manifest.is_complete {
        output::say(&format!(
            "warning: {} of {} cells are missing; the same experiment with --out {} does them",
            manifest.cells - manifest.cells_done,
            manifest.cells,
            out.display()
        ));
    }
    verdict(&report, None, flags)
}

fn print(folder: &RunFolder, report: &Report, flags: &Flags) {
    let manifest = folder.manifest();
    let mut object = json!({
        "experiment": manifest.identity.experiment,
        "scene": manifest.identity.scene,
        "scene_hash": manifest.identity.scene_sha256,
        "version": manifest.identity.version,
        "out": folder.path(),
        "cells": manifest.cells,
        "cells_done": manifest.cells_done,
        "is_complete": manifest.is_complete,
    });
    if let Value::Object(object) = &mut object {
        object.extend(report.summary.clone());
    }
    output::result(flags.json, &object, || text::report(folder, report));
}

fn verdict(report: &Report, loaded: Option<&Loaded>, flags: &Flags) -> Result<(), Failure> {
    match (&report.failure, loaded) {
        (Some(failure), _) => Err(Failure::Failed(failure.clone())),
        (None, Some(loaded)) => loaded.verdict(flags),
        (None, None) => Ok(()),
    }
}

impl From<ExperimentError> for Failure {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Scene(error) => error.into(),
            other => Self::Failed(other.to_string()),
        }
    }
}
