//! Runs an experiment into a folder, resumes an interrupted run, and merges the folders of shards.

use super::{args::ExperimentArgs, throughput};
use crate::cli::scene::{Loaded, load};
use crate::cli::{
    commit, failure::Failure, flags::Flags, interrupt, output, paths, pose::camera, progress::Progress,
    report as report_files, walk::read_path,
};
use crate::picture::memory;
use afterimage::experiment::run::{
    CellEvent, Effort, Experiment, ExperimentContext, ExperimentSettings, Report, RunFolder, Session, Shard,
    caveats, merge, run_cells,
};
use afterimage::experiment::throughput::{ThroughputSettings, gather_rays};
use afterimage::trace::BounceLimit;
use afterimage::{camera::CameraPath, experiment::registry::find, raster::save::write_atomically};
use anyhow::Context;
use serde_json::json;
use std::path::{Path, PathBuf};

/// The experiments that also run without a folder.
const THROUGHPUT: &str = "throughput";
const AT_REST: &str = "at-rest";

pub(in crate::cli) fn run(args: &ExperimentArgs, flags: &Flags) -> Result<(), Failure> {
    match find(&args.name) {
        Some(_) if args.name == THROUGHPUT && args.out.is_none() => throughput::run(args, flags),
        Some(experiment) => run_one(experiment, args, flags),
        None => merge_shards(args, flags),
    }
}

fn run_one(experiment: &Experiment, args: &ExperimentArgs, flags: &Flags) -> Result<(), Failure> {
    // The guard removes a folder that nobody has asked for.
    let (out, guard) = match &args.out {
        None if experiment.name == AT_REST => {
            let folder = tempfile::tempdir().context("cannot create a temporary folder")?;
            (folder.path().to_owned(), Some(folder))
        }
        _ => (out(args)?, None),
    };
    let shard = Shard::of(args.shard.as_deref(), |name| std::env::var(name).ok())
        .map_err(|e| Failure::Usage(e.to_string()))?;
    let recorded = args.path.as_deref().map(read_path).transpose()?;
    let mut settings = settings(experiment, args, flags);
    memory::check(settings.size.map(u64::from).iter().product(), MAX_REFERENCES)?;
    let loaded = load(Some(args.scene()?), flags)?;
    settings.exposure_ev = loaded.expose(flags)?.exposure_ev();
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
    let finished = run_with_progress(experiment, &context, &mut folder);
    // Finished cells are reported even if others failed.
    let report = write_report(experiment, &mut folder)?;
    let is_complete = finished?;
    print(&folder, &report, guard.is_none(), flags);
    if !is_complete {
        return Err(Failure::Interrupted);
    }
    verdict(&report, Some(&loaded), flags)
}

/// The recorded camera path, or a stationary camera if a pose is given or the experiment has a
/// single view, or the scene's own path.
fn walk(
    experiment: &Experiment,
    recorded: Option<CameraPath>,
    flags: &Flags,
    loaded: &Loaded,
) -> Result<CameraPath, Failure> {
    let is_still =
        [THROUGHPUT, AT_REST].contains(&experiment.name) || flags.eye.is_some() || flags.view.is_some();
    match recorded {
        Some(walk) => Ok(walk),
        None if is_still => Ok(CameraPath::still(&camera(flags, loaded.scene())?)),
        None => Ok(loaded.scene().walk.clone()),
    }
}

/// Writes the timed rays for other programs.
fn dump_rays(
    path: &Path,
    loaded: &Loaded,
    walk: &CameraPath,
    settings: &ExperimentSettings,
) -> Result<(), Failure> {
    let camera =
        walk.camera(0, 2).ok_or_else(|| Failure::Failed("the camera path has no key frames".to_owned()))?;
    let settings = ThroughputSettings { camera, size: settings.size, trace: settings.trace() };
    let rays = gather_rays(&loaded.tracer, &settings);
    Ok(write_atomically(path, &rays.to_bytes(&loaded.tracer))?)
}

/// Maximum number of references that a frame of an experiment uses.
const MAX_REFERENCES: u64 = 8;

fn out(args: &ExperimentArgs) -> Result<PathBuf, Failure> {
    let missing = || Failure::Usage(format!("experiment {} needs a folder; give --out DIR", args.name));
    args.out.clone().ok_or_else(missing)
}

fn session() -> Session {
    Session::now(std::env::args().collect(), commit::COMMIT)
}

/// The experiment's settings, with those replaced that the flags give.
fn settings(experiment: &Experiment, args: &ExperimentArgs, flags: &Flags) -> ExperimentSettings {
    let defaults = (experiment.settings)(if args.quick { Effort::Quick } else { Effort::Usual });
    ExperimentSettings {
        size: flags.given_size.unwrap_or(defaults.size),
        samples: flags.samples.unwrap_or(defaults.samples),
        bounces: bounces(experiment, flags, &defaults),
        seed: flags.seed,
        repetitions: args.repetitions.unwrap_or(defaults.repetitions),
        views: args.views.unwrap_or(defaults.views),
        frames: args.frames.unwrap_or(defaults.frames),
        truth_samples: args.truth_samples.unwrap_or(defaults.truth_samples),
        cache_mb: args.cache_mb.unwrap_or(defaults.cache_mb),
        seconds: seconds(args, &defaults),
        full_samples: defaults.full_samples.map(|usual| args.full_samples.unwrap_or(usual)),
        ..defaults
    }
}

/// The limit of bounces. An experiment on the paper's light has one that flags do not change.
fn bounces(experiment: &Experiment, flags: &Flags, defaults: &ExperimentSettings) -> BounceLimit {
    let Some(fixed) = experiment.fixed_bounces else { return flags.bounces.unwrap_or(defaults.bounces) };
    if let Some(given) = flags.bounces.filter(|given| *given != fixed) {
        output::say(&format!(
            "note: experiment {} has {} (--bounces {fixed}), whatever is set; --bounces {given} is not used",
            experiment.name,
            fixed.light(),
        ));
    }
    fixed
}

/// The checkpoints of an experiment that has some, in rising order.
fn seconds(args: &ExperimentArgs, defaults: &ExperimentSettings) -> Vec<f64> {
    let is_given = !args.seconds.is_empty() && !defaults.seconds.is_empty();
    let mut seconds = if is_given { args.seconds.clone() } else { defaults.seconds.clone() };
    seconds.sort_by(f64::total_cmp);
    seconds.dedup();
    seconds
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

fn write_report(experiment: &Experiment, folder: &mut RunFolder) -> Result<Report, Failure> {
    let records = folder.records();
    let mut report = (experiment.report)(&folder.manifest().identity, &records);
    report.notes.extend(caveats(folder.manifest(), &records));
    folder.export(&report)?;
    report_files::write(folder, &report)?;
    Ok(report)
}

/// Merges the folders of shards into one folder.
fn merge_shards(args: &ExperimentArgs, flags: &Flags) -> Result<(), Failure> {
    let out = out(args)?;
    if args.inputs.is_empty() {
        return Err(Failure::Usage(
            "merge needs the folders of the shards; give them after its name".to_owned(),
        ));
    }
    let folders: Vec<PathBuf> = args.inputs.iter().map(PathBuf::from).collect();
    let mut folder = merge(&folders, &out, session())?;
    let name = folder.manifest().identity.experiment.clone();
    let experiment =
        find(&name).ok_or_else(|| Failure::Failed(format!("this version has no experiment '{name}'")))?;
    let report = write_report(experiment, &mut folder)?;
    print(&folder, &report, true, flags);
    let manifest = folder.manifest();
    if !manifest.is_complete {
        output::say(&format!(
            "warning: {} of {} cells are missing; run the same experiment with --out {} to add them",
            manifest.cells - manifest.cells_done,
            manifest.cells,
            out.display()
        ));
    }
    verdict(&report, None, flags)
}

fn print(folder: &RunFolder, report: &Report, is_kept: bool, flags: &Flags) {
    let manifest = folder.manifest();
    let mut object = json!({
        "experiment": manifest.identity.experiment,
        "scene": manifest.identity.scene,
        "scene_hash": manifest.identity.scene_sha256,
        "version": manifest.identity.version,
        "bounces": manifest.identity.settings.0.get("bounces"),
        "out": is_kept.then(|| folder.path()),
        "cells": manifest.cells,
        "cells_done": manifest.cells_done,
        "is_complete": manifest.is_complete,
    });
    output::extend(&mut object, &report.summary);
    output::result(flags.json, &object, || report_files::text(is_kept.then(|| folder.path()), report));
}

fn verdict(report: &Report, loaded: Option<&Loaded>, flags: &Flags) -> Result<(), Failure> {
    match (&report.failure, loaded) {
        (Some(failure), _) => Err(Failure::Failed(failure.clone())),
        (None, Some(loaded)) => loaded.verdict(flags),
        (None, None) => Ok(()),
    }
}
