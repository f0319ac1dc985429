//! Run folders: the records are the same whether a run was whole, interrupted, killed or in shards,
//! and foreign folders are left alone.

use crate::rooms::{dvec, room_tracer};
use afterimage::Tracer;
use afterimage::camera::{CameraKey, CameraPath};
use afterimage::experiment::registry::find;
use afterimage::experiment::run::{
    CellEvent, Effort, Experiment, ExperimentContext, ExperimentSettings, Identity, Journal, RunFolder,
    RunRecord, Session, Shard, merge, run_cells,
};
use afterimage::trace::BounceLimit;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A room, and small settings of an experiment.
struct Bench {
    experiment: &'static Experiment,
    tracer: Arc<Tracer>,
    settings: ExperimentSettings,
    walk: CameraPath,
    dir: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let bench = Self::of("table1");
        Self { settings: ExperimentSettings { samples: 2, truth_samples: 8, ..bench.settings }, ..bench }
    }

    fn of(experiment: &str) -> Self {
        let experiment = find(experiment).unwrap();
        let usual = (experiment.settings)(Effort::Quick);
        // Direct light: run folders are the subject, and many cells are run.
        let bounces = BounceLimit::NONE;
        let settings =
            ExperimentSettings { size: [32, 32], frames: 20, truth_samples: 256, bounces, ..usual };
        Self {
            experiment,
            tracer: Arc::new(room_tracer(true, false)),
            settings,
            walk: walk(),
            dir: tempfile::tempdir().unwrap(),
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// Starts or continues a run and stops after `max_cells` cells. Returns whether all are
    /// finished, and the records.
    fn run(&self, name: &str, shard: Shard, max_cells: usize) -> (bool, Vec<RunRecord>) {
        let (stopped, images) = (AtomicBool::new(max_cells == 0), self.path(name).join("images"));
        let stop = || stopped.load(Ordering::Relaxed);
        let context = self.context(&images, &stop);
        let mut folder = self.open(name, &context, shard).unwrap();
        let mut left = max_cells;
        let observe = |event: CellEvent<'_>| {
            if matches!(event, CellEvent::Done(..)) {
                left -= 1;
                stopped.store(left == 0, Ordering::Relaxed);
            }
        };
        let is_complete = run_cells(self.experiment, &context, &mut folder, observe).unwrap();
        let records = folder.records();
        let report = (self.experiment.report)(&folder.manifest().identity, &records);
        folder.export(&report).unwrap();
        (is_complete, records)
    }

    fn identity(&self) -> Identity {
        self.context(&self.path("none"), &|| false).identity(self.experiment.name, "room")
    }

    fn context<'a>(&'a self, images: &'a Path, stop: &'a (dyn Fn() -> bool + Sync)) -> ExperimentContext<'a> {
        let (tracer, settings) = (&self.tracer, &self.settings);
        ExperimentContext { tracer, walk: &self.walk, settings, truth_folder: None, images, stop }
    }

    fn open(&self, name: &str, context: &ExperimentContext<'_>, shard: Shard) -> Result<RunFolder, String> {
        let cells = (self.experiment.cells)(context).len();
        let opened = RunFolder::open(
            &self.path(name),
            context.identity(self.experiment.name, "room"),
            shard,
            cells,
            session(),
        );
        opened.map_err(|e| e.to_string())
    }
}

/// A walk through the room with a turn of the head.
fn walk() -> CameraPath {
    let key = |z: f64, x: f64| CameraKey::new(dvec(0.2, 1.5, z), dvec(x, 1.2, -4.0));
    CameraPath { fov_y_deg: 65.0, frames: 20, keyframes: vec![key(3.5, -0.2), key(1.0, 0.8)] }
}

fn session() -> Session {
    Session::now(vec!["afterimage".to_owned()], None)
}

fn timeless(records: &[RunRecord]) -> Vec<RunRecord> {
    records.iter().map(RunRecord::without_times).collect()
}

/// More cells than any experiment has here.
const ALL_CELLS: usize = 1000;

#[test]
fn interrupted_killed_and_sharded_runs_have_the_same_records() {
    let bench = Bench::new();
    let (is_complete, whole) = bench.run("whole", Shard::ALL, ALL_CELLS);
    assert!(
        is_complete && whole.len() == 14,
        "seven cells of one warm-up and one repetition: {}",
        whole.len()
    );
    assert!(whole.iter().all(|r| r.number("psnr_db").unwrap() > 10.0));
    let expected = timeless(&whole);

    // Interrupted after three cells, then continued.
    let (is_complete, part) = bench.run("resumed", Shard::ALL, 3);
    assert!(!is_complete && part.len() == 6);
    // Killed while it wrote a line.
    let journal = bench.path("resumed").join(Journal::NAME);
    let text = std::fs::read(&journal).unwrap();
    std::fs::write(&journal, &text[..text.len() - 20]).unwrap();
    let (is_complete, resumed) = bench.run("resumed", Shard::ALL, ALL_CELLS);
    assert!(is_complete);
    assert_eq!(timeless(&resumed), expected);

    // In three shards, merged in another order.
    for index in 0..3 {
        bench.run(&format!("shard{index}"), Shard { index, count: 3 }, ALL_CELLS);
    }
    let shards = [2, 0, 1].map(|i| bench.path(&format!("shard{i}")));
    let merged = merge(&shards, &bench.path("merged"), session()).unwrap();
    assert_eq!(timeless(&merged.records()), expected);
    assert!(bench.path("merged/images/full-0.png").exists());
}

#[test]
fn a_finished_run_is_not_repeated_and_missing_cells_are_completed() {
    let bench = Bench::new();
    bench.run("one", Shard { index: 0, count: 2 }, ALL_CELLS);
    let again = bench.run("one", Shard { index: 0, count: 2 }, ALL_CELLS).1;
    let first = merge(&[bench.path("one")], &bench.path("merged"), session()).unwrap();
    // The times are equal too: nothing was run a second time.
    assert_eq!(first.records(), again);
    drop(first);
    let (is_complete, all) = bench.run("merged", Shard::ALL, ALL_CELLS);
    assert!(is_complete && all.len() == 14);
}

#[test]
fn a_folder_with_other_content_is_left_alone() {
    let mut bench = Bench::new();
    bench.run("run", Shard::ALL, 1);
    let images = bench.path("run/images");
    let before = std::fs::read(bench.path("run").join(Journal::NAME)).unwrap();
    let refused = |bench: &Bench, name: &str, shard, words: &str| {
        let error = bench.open(name, &bench.context(&images, &|| false), shard).map(drop).unwrap_err();
        assert!(error.contains(words), "'{words}' is not in: {error}");
    };
    refused(&bench, "run", Shard { index: 0, count: 2 }, "shard 0/1 there, 0/2 here");
    bench.settings.samples = 5;
    refused(&bench, "run", Shard::ALL, "samples 2 there, 5 here");
    std::fs::create_dir(bench.path("notes")).unwrap();
    std::fs::write(bench.path("notes/diary.txt"), "mine").unwrap();
    refused(&bench, "notes", Shard::ALL, "not a run folder");
    let manifest = bench.path("run/manifest.json");
    let text = std::fs::read_to_string(&manifest).unwrap();
    std::fs::write(&manifest, text.replace("\"version\": \"", "\"version\": \"9")).unwrap();
    bench.settings.samples = 2;
    refused(&bench, "run", Shard::ALL, "version 9");
    std::fs::write(&manifest, text.replace("\"format\": 1", "\"format\": 7")).unwrap();
    refused(&bench, "run", Shard::ALL, "format 7");
    assert_eq!(std::fs::read(bench.path("run").join(Journal::NAME)).unwrap(), before);
    assert_eq!(std::fs::read_dir(bench.path("notes")).unwrap().count(), 1);
}

#[test]
fn two_writers_and_shards_of_different_runs_are_refused() {
    let mut bench = Bench::new();
    bench.run("a", Shard { index: 0, count: 2 }, ALL_CELLS);
    let images = bench.path("a/images");
    let held = bench.open("a", &bench.context(&images, &|| false), Shard { index: 0, count: 2 }).unwrap();
    let second = bench.open("a", &bench.context(&images, &|| false), Shard { index: 0, count: 2 });
    assert!(second.unwrap_err().contains("another process"));
    drop(held);
    bench.settings.seed = 7;
    bench.run("b", Shard { index: 1, count: 2 }, ALL_CELLS);
    let error =
        merge(&[bench.path("a"), bench.path("b")], &bench.path("ab"), session()).unwrap_err().to_string();
    assert!(error.contains("another run") && error.contains("seed"), "{error}");
    assert!(!bench.path("ab").exists());
}

#[test]
fn shards_come_from_flags_or_from_the_scheduler() {
    let shard = |text: Option<&str>, variables: &[(&str, &str)]| {
        let variable = |name: &str| variables.iter().find(|v| v.0 == name).map(|v| v.1.to_owned());
        Shard::of(text, variable).map(|s| (s.index, s.count)).map_err(|e| e.to_string())
    };
    assert_eq!(shard(None, &[]), Ok((0, 1)));
    assert_eq!(shard(Some("1/4"), &[]), Ok((1, 4)));
    // Counted from 1, the last shard is the first one counted from 0.
    assert_eq!(shard(Some("4/4"), &[]), Ok((0, 4)));
    let slurm =
        [("SLURM_ARRAY_TASK_ID", "14"), ("SLURM_ARRAY_TASK_MIN", "10"), ("SLURM_ARRAY_TASK_STEP", "2")];
    assert_eq!(shard(None, &[&slurm[..], &[("SLURM_ARRAY_TASK_COUNT", "5")]].concat()), Ok((2, 5)));
    assert_eq!(shard(Some("0/3"), &slurm), Ok((0, 3)), "the flag has precedence");
    assert_eq!(shard(Some("/8"), &[("JOB_COMPLETION_INDEX", "3")]), Ok((3, 8)));
    let batch = [("AWS_BATCH_JOB_ARRAY_INDEX", "1"), ("AWS_BATCH_JOB_ARRAY_SIZE", "2")];
    assert_eq!(shard(None, &batch), Ok((1, 2)));
    for (text, variables, words) in [
        (Some("5/4"), &[][..], "out of range"),
        (Some("1/0"), &[], "I/N"),
        (Some("one"), &[], "I/N"),
        (Some("-1/4"), &[], "I/N"),
        (Some("/4"), &[], "SLURM_ARRAY_TASK_ID"),
        (None, &[("JOB_COMPLETION_INDEX", "3")], "--shard /N"),
        (None, &[("JOB_COMPLETION_INDEX", "x")], "whole number"),
    ] {
        let error = shard(text, variables).unwrap_err();
        assert!(error.contains(words), "'{words}' is not in: {error}");
    }
}

#[test]
fn error_against_time_is_reproducible_and_compares_modes() {
    let bench = Bench::of("error-time");
    let (is_complete, first) = bench.run("first", Shard::ALL, ALL_CELLS);
    assert!(is_complete);
    let (_, second) = bench.run("second", Shard { index: 0, count: 1 }, ALL_CELLS);
    assert_eq!(timeless(&first), timeless(&second), "errors of one seed, to the bit");
    let report = (bench.experiment.report)(&bench.identity(), &first);
    assert!(
        report.headline[0].starts_with("Against full ray tracing at equal FLIP error"),
        "{:?}",
        report.headline
    );
    assert!(report.headline[1].starts_with("Best in its time"), "{:?}", report.headline);
    let setups = report.summary["setups"].as_array().unwrap();
    let setup = |mode: &str, samples: u32| {
        setups.iter().find(|s| s["mode"] == mode && s["samples"] == samples && s["references"] != 1).unwrap()
    };
    let flip = |mode: &str, samples: u32| setup(mode, samples)["flip_mean"].as_f64().unwrap();
    let [few, many, paper, exact] =
        [("full", 1), ("full", 64), ("paper", 16), ("exact", 16)].map(|(mode, samples)| flip(mode, samples));
    assert!(many < few, "more samples, less error: {many} {few}");
    assert!(exact < paper, "{exact} {paper}");
    let counted =
        |s: &serde_json::Value| s["frame_secs_references_counted"].as_f64() > s["frame_secs"].as_f64();
    assert!(counted(setup("exact", 16)) && !counted(setup("full", 16)), "only references cost anything");
    assert!(bench.path("first/images/exact-error-part.png").exists());
}

#[test]
fn a_view_at_rest_is_measured_at_every_checkpoint() {
    let mut bench = Bench::of("at-rest");
    bench.settings =
        ExperimentSettings { seconds: vec![0.05, 0.1, 0.5], truth_samples: 64, ..bench.settings.clone() };
    let (is_complete, records) = bench.run("run", Shard::ALL, ALL_CELLS);
    assert!(is_complete && records.len() == 4, "three checkpoints and mode full: {records:?}");
    for record in &records {
        for name in ["mse", "psnr_db", "flip_mean", "samples"] {
            assert!(record.number(name).unwrap().is_finite(), "{name}: {record:?}");
        }
    }
    let last = &records[2];
    assert!(last.number("first_frame_secs").unwrap() > 0.0 && last.number("samples").unwrap() > 0.0);
    let report = (bench.experiment.report)(&bench.identity(), &records);
    assert_eq!(report.summary["checkpoints"].as_array().unwrap().len(), 3);
    assert_eq!(report.summary["full"]["samples"], 64);
    for name in ["truth.png", "at-0.05s.png", "at-0.1s-error.png", "full.png"] {
        assert!(bench.path("run/images").join(name).exists(), "{name}");
    }
}

#[test]
fn table1_is_direct_light_and_error_time_and_placement_have_all_bounces() {
    for (name, limit, word) in [
        ("table1", BounceLimit::NONE, "direct light only"),
        ("error-time", BounceLimit::ALL, "all bounces"),
        ("placement", BounceLimit::ALL, "all bounces"),
    ] {
        let usual = (find(name).unwrap().settings)(Effort::Quick);
        let bench = Bench::of(name);
        let bench = Bench { settings: usual, ..bench };
        assert_eq!(bench.settings.bounces, limit, "{name}");
        let identity = bench.identity();
        assert_eq!(identity.settings.0["bounces"], serde_json::to_value(limit).unwrap());
        let report = (bench.experiment.report)(&identity, &[]);
        assert!(report.notes[0].contains(word), "{name}: {:?}", report.notes);
        // The manifest is read back.
        let text = serde_json::to_string(&identity).unwrap();
        assert_eq!(serde_json::from_str::<Identity>(&text).unwrap(), identity);
    }
    assert_eq!(find("table1").unwrap().fixed_bounces, Some(BounceLimit::NONE));
    for name in ["scaling", "throughput", "stability", "soak"] {
        assert_eq!((find(name).unwrap().settings)(Effort::Usual).bounces, BounceLimit::NONE, "{name}");
    }
}
