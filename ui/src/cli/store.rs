//! `afterimage store`: lists, checks, tidies and joins stores of references.

use super::flags::{Flags, StoreChoice};
use super::{failure::Failure, output};
use afterimage::experiment::tour::Pose;
use afterimage::store::{MaintenanceReport, RecordSummary, StoreIndex, merge, prune, verify};
use clap::{Args, Subcommand};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub(crate) struct StoreArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand, Debug)]
enum Action {
    /// List the references of stores.
    List(Folders),
    /// Read every record and check it; exit with code 1 if any is damaged.
    Verify(Folders),
    /// Remove what is damaged or there twice, then what was not used for longest, down to
    /// --store-mb.
    Prune(Folders),
    /// Add the references of all further stores to the first one.
    Merge(Folders),
}

#[derive(Args, Debug)]
struct Folders {
    /// Folders of stores; `default` is the one in the user's cache folder.
    #[arg(required = true, value_name = "DIR", value_parser = str::parse::<StoreChoice>)]
    folders: Vec<StoreChoice>,
}

impl Folders {
    /// The folders. A store that is named must exist, except the first one of a merge.
    fn paths(&self, may_be_new: bool) -> Result<Vec<PathBuf>, Failure> {
        let folders = self.folders.iter().enumerate().map(|(at, choice)| {
            let folder = choice.folder().ok_or_else(|| Failure::Usage("'off' is no store".to_owned()))?;
            let is_there = folder.is_dir() || (may_be_new && at == 0);
            is_there.then(|| folder.clone()).ok_or_else(|| {
                let why = if folder.exists() { "it is no folder" } else { "no such folder" };
                Failure::Usage(format!("there is no store {}: {why}", folder.display()))
            })
        });
        folders.collect()
    }
}

pub(crate) fn run(args: &StoreArgs, flags: &Flags) -> Result<(), Failure> {
    let (reports, fails) = match &args.action {
        Action::List(folders) => return list(&folders.paths(false)?, flags),
        Action::Verify(folders) => (each(&folders.paths(false)?, verify)?, true),
        Action::Prune(folders) => {
            (each(&folders.paths(false)?, |folder| prune(folder, flags.store_mb << 20))?, false)
        }
        Action::Merge(folders) => {
            let paths = folders.paths(true)?;
            let report = merge(&paths[0], &paths[1..])?;
            (vec![(paths[0].clone(), report)], false)
        }
    };
    let problems: usize = reports.iter().map(|(_, report)| report.problems.len()).sum();
    for problem in reports.iter().flat_map(|(_, report)| &report.problems) {
        output::say(&format!("warning: {problem}"));
    }
    let objects: Vec<Value> = reports.iter().map(|(folder, report)| object(folder, report)).collect();
    output::result(flags.json, &json!({ "stores": objects }), || {
        reports.iter().map(|(folder, report)| words(folder, report)).collect()
    });
    if fails && problems > 0 {
        return Err(Failure::Failed(format!(
            "{problems} problems; what is whole stays usable, `afterimage store prune` removes the rest"
        )));
    }
    Ok(())
}

fn each<E: Into<Failure>>(
    folders: &[PathBuf],
    work: impl Fn(&Path) -> Result<MaintenanceReport, E>,
) -> Result<Vec<(PathBuf, MaintenanceReport)>, Failure> {
    let of = |folder: &PathBuf| Ok((folder.clone(), work(folder).map_err(Into::into)?));
    folders.iter().map(of).collect()
}

fn object(folder: &Path, report: &MaintenanceReport) -> Value {
    json!({
        "folder": folder,
        "references": report.records,
        "bytes": report.bytes,
        "added": report.added,
        "duplicates": report.duplicates,
        "problems": report.problems,
    })
}

fn words(folder: &Path, report: &MaintenanceReport) -> String {
    let MaintenanceReport { records, added, duplicates, problems, .. } = report;
    let folder = folder.display();
    format!(
        "{folder}: {records} references, {:.1} MB; {added} added, {duplicates} held by others, {} problems\n",
        report.bytes as f64 / 1e6,
        problems.len()
    )
}

fn list(folders: &[PathBuf], flags: &Flags) -> Result<(), Failure> {
    let (mut objects, mut lines) = (Vec::new(), String::new());
    for folder in folders {
        let index = StoreIndex::read(folder)?;
        for problem in &index.problems {
            output::say(&format!("warning: {problem}"));
        }
        let records: Vec<Value> = index.records().map(record_object).collect();
        index.records().for_each(|record| lines.push_str(&record_line(record)));
        lines.push_str(&format!(
            "{}: {} references, {:.1} MB\n",
            folder.display(),
            index.len(),
            index.bytes() as f64 / 1e6
        ));
        objects.push(json!({
            "folder": folder,
            "bytes": index.bytes(),
            "problems": index.problems,
            "references": records,
        }));
    }
    output::result(flags.json, &json!({ "stores": objects }), || lines);
    Ok(())
}

fn record_object((segment, summary, bytes): (&Path, &RecordSummary, u64)) -> Value {
    json!({
        "segment": segment,
        "bytes": bytes,
        "pose": Pose::from(&summary.camera),
        "size": summary.size,
        "samples": summary.settings.samples,
        "bounces": summary.settings.bounce_limit(),
        "seed": summary.settings.seed,
        "lit_pixels": summary.lit,
        "depends_on": summary.dependencies.iter().map(|hash| format!("{hash:032x}")).collect::<Vec<_>>(),
    })
}

fn record_line((_, summary, bytes): (&Path, &RecordSummary, u64)) -> String {
    let [x, y, z] = summary.camera.eye.to_array();
    let [width, height] = summary.size;
    let scene = summary.dependencies.first().map_or(0, |hash| hash >> 96);
    format!(
        "scene {scene:08x}  {width}x{height}  at {x:.2},{y:.2},{z:.2}  {} samples  {} pixels lit  {:.2} MB\n",
        summary.settings.samples,
        summary.lit,
        bytes as f64 / 1e6
    )
}
