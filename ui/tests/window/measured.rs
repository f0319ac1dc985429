//! Measurements of the real window, to be run alone on a machine:
//!
//! ```sh
//! cargo build --release
//! AFTERIMAGE_PROGRAM=$PWD/target/release/afterimage cargo test -p afterimage-ui measured -- --ignored --nocapture --test-threads=1
//! ```

use super::desk::Desk;
use super::*;
use std::fmt::Write as _;
use std::thread::sleep;

const PRESSES: usize = 40;

/// Sixteen passes over every pixel of the window, by the processor.
const LONGEST_TO_CONVERGE: Duration = Duration::from_secs(900);

/// Levels of 255 that a pixel differs by.
const VISIBLE: u8 = 16;

/// The share of such pixels from which on the picture has moved.
const MOVED: f64 = 0.02;

/// Says a figure past the test runner.
fn say(text: &str) {
    writeln!(std::io::stderr(), "measured: {text}").expect("stderr");
}

/// The picture's part of the screen, without figures and panels.
fn picture(desk: &Desk) -> Vec<u8> {
    let screen = desk.raw_screen();
    let (row, header) = (1280 * 4, screen.len() - 1280 * 800 * 4);
    (420..700).flat_map(|y| screen[header + y * row + 500 * 4..header + y * row + 800 * 4].to_vec()).collect()
}

/// Milliseconds until something holds.
fn ms_until(since: Instant, mut holds: impl FnMut() -> bool) -> f64 {
    while !holds() {
        assert!(since.elapsed() < DEADLINE, "waited in vain");
    }
    since.elapsed().as_secs_f64() * 1e3
}

/// The share of pixels that look different to a person. What a pass of refinement changes does not.
fn changed(before: &[u8], after: &[u8]) -> f64 {
    let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > VISIBLE);
    let pixels = before.chunks_exact(4).zip(after.chunks_exact(4));
    pixels.filter(differs).count() as f64 / (before.len() / 4) as f64
}

/// The picture once nothing but refinement changes it.
fn still_picture(desk: &Desk) -> Vec<u8> {
    let (start, mut before) = (Instant::now(), picture(desk));
    loop {
        assert!(start.elapsed() < DEADLINE, "the picture changes while nobody moves");
        sleep(Duration::from_millis(300));
        let now = picture(desk);
        if changed(&before, &now) < MOVED / 4.0 {
            return now;
        }
        before = now;
    }
}

/// Presses a key again and again; milliseconds from each press to another picture, sorted.
fn latencies(desk: &Desk, pause: Duration) -> Vec<f64> {
    let mut all: Vec<f64> = (0..PRESSES)
        .map(|i| {
            sleep(pause);
            let before = still_picture(desk);
            let key = if i % 2 == 0 { "d" } else { "a" };
            let start = Instant::now();
            desk.xdotool(&format!("keydown {key}"));
            let ms = ms_until(start, || changed(&before, &picture(desk)) > MOVED);
            desk.xdotool(&format!("keyup {key}"));
            ms
        })
        .collect();
    all.sort_by(f64::total_cmp);
    all
}

fn say_latencies(what: &str, all: &[f64], screenshot_ms: f64) {
    let (median, last) = (all[all.len() / 2], all[all.len() - 1]);
    say(&format!(
        "{what}: key to changed picture {median:.0} ms median, {last:.0} ms longest of {}; a look at the screen takes {screenshot_ms:.0} ms",
        all.len()
    ));
}

fn screenshot_ms(desk: &Desk) -> f64 {
    let start = Instant::now();
    (0..20).for_each(|_| drop(picture(desk)));
    start.elapsed().as_secs_f64() * 1e3 / 20.0
}

#[test]
#[ignore = "a measurement, alone on the machine"]
fn measured_start() {
    let start = Instant::now();
    let Some(desk) = Desk::open_with(&["builtin:gallery"]) else { return };
    let window = start.elapsed().as_secs_f64() * 1e3;
    let ms = ms_until(start, || {
        let pixels = picture(&desk);
        pixels.chunks_exact(4).any(|p| p[..3] != pixels[..3])
    });
    say(&format!(
        "start of Xvfb and program to a window {window:.0} ms, to the first picture of the gallery {ms:.0} ms"
    ));
}

#[test]
#[ignore = "a measurement, alone on the machine"]
fn measured_latency() {
    // At rest the renderer is busy with refining.
    let Some(desk) = Desk::open_with(&["builtin:gallery"]) else { return };
    desk.pose();
    say_latencies(
        "gallery, renderer busy",
        &latencies(&desk, Duration::from_millis(700)),
        screenshot_ms(&desk),
    );
}

#[test]
#[ignore = "a measurement, alone on the machine"]
fn measured_million_triangles() {
    let Some(desk) = Desk::open_with_model(&waves(708)) else { return };
    desk.pose();
    say_latencies("a million triangles", &latencies(&desk, Duration::from_millis(700)), screenshot_ms(&desk));
}

/// A wavy floor of `2 * side * side` triangles.
fn waves(side: usize) -> String {
    let mut text = String::new();
    for (i, j) in (0..=side).flat_map(|i| (0..=side).map(move |j| (i, j))) {
        let (x, z) = (i as f64 * 0.05, j as f64 * 0.05);
        let _ = writeln!(text, "v {x:.3} {:.3} {z:.3}", (x.sin() + z.cos()) * 0.5);
    }
    for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
        let at = i * (side + 1) + j + 1;
        let _ = writeln!(text, "f {} {} {} {}", at, at + 1, at + side + 2, at + side + 1);
    }
    text
}

#[test]
#[ignore = "a measurement, alone on the machine"]
fn measured_rest() {
    let secs: u64 = std::env::var("AFTERIMAGE_SECS").ok().and_then(|s| s.parse().ok()).unwrap_or(60);
    let Some(desk) = Desk::open_with(&["builtin:gallery"]) else { return };
    desk.pose();
    let start = Instant::now();
    let share = |secs| {
        let (busy, from) = (desk.usage().0, Instant::now());
        sleep(Duration::from_secs(secs));
        (desk.usage().0 - busy) / from.elapsed().as_secs_f64()
    };
    // References are added, the picture converges to the last of its passes, notices go away.
    while share(5) > 0.2 {
        assert!(start.elapsed() < LONGEST_TO_CONVERGE, "the picture goes on for ever");
    }
    say(&format!("converged after {:.0} s", start.elapsed().as_secs_f64()));
    say(&format!("at rest: {:.2} % of a core", share(30) * 100.0));
    let kilobytes = desk.usage().1;
    let walk_start = Instant::now();
    let mut minute = 0;
    while walk_start.elapsed() < Duration::from_secs(secs) {
        desk.xdotool("keydown d sleep 1 keyup d keydown a sleep 1 keyup a");
        if walk_start.elapsed().as_secs() / 60 > minute {
            minute = walk_start.elapsed().as_secs() / 60;
            say(&format!("memory after {minute} min of moving: {} MB", desk.usage().1 / 1024));
        }
    }
    let after = desk.usage().1;
    say(&format!("memory: {} MB, after {secs} s of moving {} MB", kilobytes / 1024, after / 1024));
}
