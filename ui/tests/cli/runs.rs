//! Experiments that are sharded, killed or interrupted.

use super::{Bench, number, stderr};
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const TABLE1: &str = "experiment table1 room.obj --quick --size 32x32 --samples 2 --truth-samples 8 --json";

/// An experiment that is slow enough to be interrupted.
const SLOW: &str = "experiment table1 room.obj --quick --size 128x128 --samples 16 --truth-samples 64 --json";

fn command(bench: &Bench, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_afterimage"));
    command.args(line.split_whitespace()).current_dir(bench.dir.path());
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env("XDG_CACHE_HOME", bench.path("cache"));
    command
}

/// All files of a folder with their contents.
fn content(folder: &Path) -> Vec<(std::ffi::OsString, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap());
    let mut files: Vec<_> = entries
        .filter(|e| e.path().is_file())
        .map(|e| (e.file_name(), std::fs::read(e.path()).unwrap()))
        .collect();
    files.sort();
    files
}

/// The summary of a run without times.
fn errors(answer: &Value) -> Vec<[f64; 3]> {
    let columns = answer["columns"].as_array().unwrap();
    columns.iter().map(|c| ["/psnr_db", "/flip_mean", "/type1_percent"].map(|name| number(c, name))).collect()
}

fn begin(bench: &Bench, out: &str) -> Child {
    let mut command = command(bench, &format!("{SLOW} --out {out}"));
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let (started, journal) = (Instant::now(), bench.path(out).join("journal.jsonl"));
    let lines = || std::fs::read(&journal).map_or(0, |text| text.iter().filter(|b| **b == b'\n').count());
    while lines() < 2 && child.try_wait().unwrap().is_none() {
        assert!(started.elapsed() < Duration::from_secs(240), "no second cell");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

#[test]
fn a_killed_run_resumes_and_ends_with_the_same_table() {
    let bench = Bench::new();
    let whole = bench.json(&format!("{SLOW} --out whole"));
    let mut child = begin(&bench, "killed");
    child.kill().unwrap();
    child.wait().unwrap();
    let resumed = bench.json(&format!("{SLOW} --out killed"));
    assert_eq!(resumed["is_complete"], json!(true));
    assert_eq!(errors(&resumed), errors(&whole));
    let manifest: Value =
        serde_json::from_slice(&std::fs::read(bench.path("killed/manifest.json")).unwrap()).unwrap();
    assert_eq!(manifest["sessions"].as_array().unwrap().len(), 2, "both are remembered");
}

#[test]
#[cfg(unix)]
fn an_interrupted_run_keeps_its_tables() {
    let bench = Bench::new();
    let mut child = begin(&bench, "run");
    // The standard library cannot send SIGINT.
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let code = child.wait().unwrap().code();
    // The run may have finished before the signal.
    assert!(code == Some(130) || code == Some(0), "{code:?}");
    let lines = std::fs::read_to_string(bench.path("run/records.csv")).unwrap().lines().count();
    assert!(lines > 4, "the cells that were done are in the table: {lines} lines");
    let page = std::fs::read_to_string(bench.path("run/report.html")).unwrap();
    assert!(code == Some(0) || page.contains("Run the same command again to resume"));
}

#[test]
fn array_jobs_take_their_shard_from_the_scheduler() {
    let bench = Bench::new();
    let schedulers: [(&str, &[(&str, &str)]); 3] = [
        (
            "slurm",
            &[("SLURM_ARRAY_TASK_ID", "3"), ("SLURM_ARRAY_TASK_COUNT", "4"), ("SLURM_ARRAY_TASK_MIN", "1")],
        ),
        ("kubernetes", &[("JOB_COMPLETION_INDEX", "2"), ("JOB_COMPLETIONS", "4")]),
        ("aws", &[("AWS_BATCH_JOB_ARRAY_INDEX", "2"), ("AWS_BATCH_JOB_ARRAY_SIZE", "4")]),
    ];
    for (name, variables) in schedulers {
        let mut command = command(&bench, &format!("{TABLE1} --out {name}"));
        let output = command.envs(variables.iter().copied()).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let manifest: Value =
            serde_json::from_slice(&std::fs::read(bench.path(name).join("manifest.json")).unwrap()).unwrap();
        assert_eq!(manifest["shard"], json!({ "index": 2, "count": 4 }), "{name}");
        assert_eq!(manifest["cells_done"], json!(2), "cells 2 and 6 of seven");
    }
}

#[test]
fn folders_of_other_runs_are_refused_and_not_changed() {
    let bench = Bench::new();
    bench.json(&format!("{TABLE1} --out a --shard 0/2"));
    bench.json(&format!("{TABLE1} --out b --shard 1/2 --seed 5"));
    let refused = |line: &str, words: &str| {
        let output: Output = bench.run(line);
        assert_eq!(output.status.code(), Some(1), "{line}: {}", stderr(&output));
        assert!(stderr(&output).contains(words), "'{words}' is not in: {}", stderr(&output));
    };
    let before = content(&bench.path("a"));
    refused("experiment merge a b --out merged", "seed 5 there, 0 here");
    assert!(!bench.path("merged").exists(), "nothing is made of shards that do not belong together");
    refused(&format!("{TABLE1} --out a --shard 1/2"), "shard 0/2 there, 1/2 here");
    refused(&format!("{TABLE1} --out a --shard 0/2 --repetitions 2"), "repetitions 1 there, 2 here");
    refused("experiment error-time room.obj --quick --out a", "table1");
    assert_eq!(content(&bench.path("a")), before);
    let manifest = bench.path("a/manifest.json");
    let text = std::fs::read_to_string(&manifest).unwrap().replace("\"format\": 1", "\"format\": 99");
    std::fs::write(&manifest, text).unwrap();
    let before = content(&bench.path("a"));
    refused(&format!("{TABLE1} --out a --shard 0/2"), "format 99, but this version reads format 1");
    refused("experiment merge a --out merged", "format 99");
    assert_eq!(content(&bench.path("a")), before);
}

#[test]
fn table1_says_that_it_uses_no_bounces() {
    let bench = Bench::new();
    let output = bench.run(&format!("{TABLE1} --out a --bounces all"));
    let said = stderr(&output);
    assert!(output.status.success() && said.contains("--bounces all is not used"), "{said}");
    let manifest = std::fs::read(bench.path("a/manifest.json")).unwrap();
    let manifest: Value = serde_json::from_slice(&manifest).unwrap();
    assert_eq!(manifest["settings"]["bounces"], json!(0));
    assert!(std::fs::read_to_string(bench.path("a/report.html")).unwrap().contains("direct light only"));
    assert!(!stderr(&bench.run(&format!("{TABLE1} --out a --bounces 0"))).contains("not used"));
}
