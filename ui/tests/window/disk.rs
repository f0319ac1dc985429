//! A real window whose disk is slow or full.

use super::desk::{COURTYARD, Desk, POLL};
use super::*;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;

/// Time that each sync of a file takes.
const SLOW_DISK: Duration = Duration::from_secs(10);

/// Error of a full disk from a thread's fourth file on: systems that allocate late report it when a
/// file is synced.
const FULL_DISK: &str = "error=ENOSPC:when=4+";

/// Background of a message that something failed.
const ERROR: [u8; 3] = [130, 28, 28];

/// Injects the results of a program's syncs; ends when dropped.
struct Disk(Child);

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Injects results by `strace`. `None`, with a message, where that is missing or not allowed to
/// trace.
fn disk(program: u32, does: &str) -> Option<Disk> {
    let inject = format!("inject=fsync,fdatasync:{does}");
    let arguments = ["-f", "-p", &program.to_string(), "-e", "trace=fsync,fdatasync", "-e", &inject];
    let tracer = Command::new("strace").args(arguments).stderr(Stdio::null()).spawn();
    let found = tracer.ok().map(Disk).and_then(|mut disk| is_traced(program, &mut disk.0).then_some(disk));
    if found.is_none() {
        let is_required = std::env::var("AFTERIMAGE_REQUIRE_GRAPHICS").is_ok_and(|v| v == "1");
        assert!(!is_required, "strace is missing or not allowed to trace");
        writeln!(std::io::stderr(), "skipped: another disk needs strace, and leave to trace")
            .expect("stderr");
    }
    found
}

/// Waits until every thread of a program is traced; false where the tracer gave up.
fn is_traced(program: u32, tracer: &mut Child) -> bool {
    let tasks = || std::fs::read_dir(format!("/proc/{program}/task")).into_iter().flatten().flatten();
    let is_free = |task: std::fs::DirEntry| {
        let status = std::fs::read_to_string(task.path().join("status")).unwrap_or_default();
        status.lines().any(|line| line.starts_with("TracerPid") && line.ends_with("\t0"))
    };
    while tasks().any(is_free) {
        if tracer.try_wait().is_ok_and(|ended| ended.is_some()) {
            return false;
        }
        sleep(POLL);
    }
    true
}

#[test]
fn a_slow_disk_holds_nothing_up() {
    let Some(desk) = Desk::open() else { return };
    let start = desk.pose();
    let slow = format!("delay_enter={}", SLOW_DISK.as_micros());
    let Some(disk) = disk(desk.app.id(), &slow) else { return };
    desk.xdotool("key F12");
    let asked = Instant::now();
    let ahead = desk.fly("w", start.eye);
    let took = asked.elapsed();
    assert!(took < SLOW_DISK, "it walks on: {ahead:?}, {took:?}");
    assert!(desk.saved("png").is_none(), "the picture cannot be there yet");
    desk.wait_for("a picture", || desk.saved("png"));
    assert!(asked.elapsed() >= SLOW_DISK, "the disk was not slow");
    drop(disk);
}

/// Returns the names in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = files.map(|file| file.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_disk_that_fills_up_loses_no_picture_of_a_sequence_and_it_goes_on() {
    // A metered exposure may change between the two sequences, and another exposure is another
    // sequence with a folder of its own.
    let arguments = ["model.obj", "--samples", "1", "--bounces", "1", "--exposure", "0"];
    let Some(desk) = Desk::start(Some(COURTYARD), &arguments, &[]) else { return };
    desk.pose();
    desk.xdotool("key k keydown w sleep 0.4 keyup w sleep 0.4 key k");
    let Some(disk) = disk(desk.app.id(), FULL_DISK) else { return };
    desk.xdotool("key shift+F12");
    desk.wait_for_share("full-disk", ERROR, 0.005);
    let folder = desk.folder().join("afterimage-model-sequence-0001");
    let is_picture = |name: &str| image::open(folder.join(name)).is_ok();
    let (pictures, others): (Vec<String>, Vec<String>) =
        names(&folder).into_iter().partition(|n| is_picture(n));
    assert!(!pictures.is_empty() && others == ["sequence.json"], "half-written: {others:?}");
    let written =
        |name: &str| std::fs::metadata(folder.join(name)).and_then(|m| m.modified()).expect("a time");
    let first = written(&pictures[0]);
    let next = format!("frame_{:04}.png", pictures.len());
    drop(disk);
    desk.xdotool("key shift+F12");
    desk.wait_for("the next picture", || folder.join(&next).exists().then_some(()));
    assert_eq!(written(&pictures[0]), first, "a picture that exists is not rendered again");
}
