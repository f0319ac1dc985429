//! Measurements of the real window, to be run alone on a machine:
//!
//! ```sh
//! cargo build --release
//! export AFTERIMAGE_PROGRAM=$PWD/target/release/afterimage
//! cargo test -p afterimage-ui measured -- --ignored --nocapture --test-threads=1
//! ```

use super::desk::Desk;
use super::*;
use std::fmt::Write as _;
use std::thread::sleep;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat, KEY_PRESS_EVENT, KEY_RELEASE_EVENT};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

const PRESSES: usize = 40;

/// Time between the release of a key and the next look.
const PAUSE: Duration = Duration::from_millis(700);

/// Time limit of sixteen passes over every pixel of the window, on the processor.
const LONGEST_TO_CONVERGE: Duration = Duration::from_secs(900);

/// Left, top, width and height of the region that is compared.
const PART: [i16; 4] = [500, 420, 300, 280];

/// Difference, in levels of 255, from which a pixel has changed.
const VISIBLE: u8 = 16;

/// Share of changed pixels from which a picture has moved: while it is refined, and while it is
/// not.
const MOVED: f64 = 0.02;
const MOVED_AT_ALL: f64 = 1e-4;

/// Prints a figure past the test runner.
pub(super) fn say(text: &str) {
    writeln!(std::io::stderr(), "measured: {text}").expect("stderr");
}

/// Presses keys and reads the picture without another program in between: a look takes a
/// millisecond.
pub(super) struct Person {
    connection: RustConnection,
    root: u32,
}

impl Person {
    pub(super) fn at(desk: &Desk) -> Self {
        let (connection, screen) = x11rb::connect(Some(desk.display())).expect("the display");
        let root = connection.setup().roots[screen].root;
        Self { connection, root }
    }

    /// Returns the picture's part of the screen, without figures and panels; four bytes per pixel.
    fn picture(&self) -> Vec<u8> {
        let [x, y, width, height] = PART;
        let image = self.connection.get_image(
            ImageFormat::Z_PIXMAP,
            self.root,
            x,
            y,
            width as u16,
            height as u16,
            !0,
        );
        image.expect("the display").reply().expect("a picture").data
    }

    /// Presses or releases a letter.
    fn key(&self, letter: u8, is_down: bool) {
        let setup = self.connection.setup();
        let (least, most) = (setup.min_keycode, setup.max_keycode);
        let map = self.connection.get_keyboard_mapping(least, most - least + 1).expect("the display");
        let map = map.reply().expect("the keys");
        let rows = map.keysyms.chunks(map.keysyms_per_keycode.into());
        let code = rows.zip(least..).find(|(row, _)| row[0] == u32::from(letter)).expect("the letter").1;
        let event = if is_down { KEY_PRESS_EVENT } else { KEY_RELEASE_EVENT };
        self.connection.xtest_fake_input(event, code, 0, self.root, 0, 0, 0).expect("a key");
        self.connection.flush().expect("the display");
    }
}

/// Returns the milliseconds until a condition holds.
fn ms_until(since: Instant, mut holds: impl FnMut() -> bool) -> f64 {
    while !holds() {
        assert!(since.elapsed() < DEADLINE, "timed out");
    }
    since.elapsed().as_secs_f64() * 1e3
}

/// Returns the share of pixels that look different to a person. A pass of refinement changes fewer.
fn changed(before: &[u8], after: &[u8]) -> f64 {
    let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > VISIBLE);
    let pixels = before.chunks_exact(4).zip(after.chunks_exact(4));
    pixels.filter(differs).count() as f64 / (before.len() / 4) as f64
}

/// Returns the picture once only refinement changes it.
fn still_picture(person: &Person, most: f64) -> Vec<u8> {
    let (start, mut before) = (Instant::now(), person.picture());
    loop {
        assert!(start.elapsed() < DEADLINE, "the picture changes without motion");
        sleep(Duration::from_millis(300));
        let now = person.picture();
        if changed(&before, &now) < most {
            return now;
        }
        before = now;
    }
}

/// Presses a key repeatedly; returns the sorted milliseconds from each press to a picture that has
/// moved.
fn latencies(person: &Person, moved: f64) -> Vec<f64> {
    let mut all: Vec<f64> = (0..PRESSES)
        .map(|i| {
            sleep(PAUSE);
            let before = still_picture(person, moved / 4.0);
            let key = if i % 2 == 0 { b'd' } else { b'a' };
            let start = Instant::now();
            person.key(key, true);
            let ms = ms_until(start, || changed(&before, &person.picture()) > moved);
            person.key(key, false);
            ms
        })
        .collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Returns the milliseconds between pictures that differ, over a time.
fn ms_between_pictures(person: &Person, time: Duration) -> f64 {
    let (start, mut last, mut pictures) = (Instant::now(), person.picture(), 0);
    while start.elapsed() < time {
        let now = person.picture();
        pictures += u32::from(now != last);
        last = now;
    }
    start.elapsed().as_secs_f64() * 1e3 / f64::from(pictures.max(1))
}

/// Returns the milliseconds between pictures while a key is held: the frame time of the display on
/// this machine.
fn frame_ms(person: &Person) -> f64 {
    person.key(b'd', true);
    let ms = ms_between_pictures(person, Duration::from_secs(2));
    person.key(b'd', false);
    ms
}

/// Returns the milliseconds that a number of pictures take while the camera moves, each of them
/// moved against the one before. The camera turns back with each of them, so the model stays in
/// view however slow the machine is.
pub(super) fn ms_of_pictures(person: &Person, count: u32) -> f64 {
    let (start, mut last) = (Instant::now(), person.picture());
    for i in 0..count {
        let key = if i % 2 == 0 { b'd' } else { b'a' };
        person.key(key, true);
        let mut now = Vec::new();
        ms_until(start, || {
            now = person.picture();
            changed(&last, &now) > MOVED
        });
        person.key(key, false);
        last = now;
    }
    start.elapsed().as_secs_f64() * 1e3
}

fn say_latencies(what: &str, person: &Person, moved: f64) {
    let all = latencies(person, moved);
    let (median, last) = (all[all.len() / 2], all[all.len() - 1]);
    let frame = frame_ms(person);
    say(&format!(
        "{what}: key to changed picture {median:.0} ms median, {last:.0} ms longest of {}; a frame of the window takes {frame:.0} ms",
        all.len()
    ));
}

#[test]
#[ignore = "a measurement, alone on the machine"]
fn measured_start() {
    let start = Instant::now();
    let Some(desk) = Desk::open_with(&["builtin:gallery-bench"]) else { return };
    let (window, person) = (start.elapsed().as_secs_f64() * 1e3, Person::at(&desk));
    let ms = ms_until(start, || {
        let pixels = person.picture();
        pixels.chunks_exact(4).any(|p| p[..3] != pixels[..3])
    });
    say(&format!(
        "start of Xvfb and program to a window {window:.0} ms, to the first picture of the gallery {ms:.0} ms"
    ));
}

#[test]
#[ignore = "a measurement, alone on the machine"]
fn measured_latency() {
    // At rest the renderer refines the picture.
    let Some(desk) = Desk::open_with(&["builtin:gallery-bench"]) else { return };
    desk.pose();
    say_latencies("gallery, renderer busy", &Person::at(&desk), MOVED);
}

#[test]
#[ignore = "a measurement, alone on the machine"]
fn measured_million_triangles() {
    // In this mode nothing changes at rest.
    let arguments = ["model.obj", "--samples", "1", "--bounces", "1", "--mode", "paper"];
    let Some(desk) = Desk::start(Some(&waves(708)), &arguments, &[]) else { return };
    desk.pose();
    say_latencies("a million triangles", &Person::at(&desk), MOVED_AT_ALL);
}

#[test]
#[ignore = "a measurement, alone on the machine"]
fn measured_flight() {
    let Some(desk) = Desk::open_with(&["builtin:gallery"]) else { return };
    desk.pose();
    let person = Person::at(&desk);
    sleep(Duration::from_secs(5));
    // Space plays the walk of the scene.
    person.key(b' ', true);
    person.key(b' ', false);
    let ms = ms_between_pictures(&person, Duration::from_secs(8));
    say(&format!("flying through the gallery: {:.1} pictures per second", 1e3 / ms));
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
    let Some(desk) = Desk::open_with(&["builtin:gallery-bench"]) else { return };
    desk.pose();
    let start = Instant::now();
    let share = |secs| {
        let (busy, from) = (desk.usage().0, Instant::now());
        sleep(Duration::from_secs(secs));
        (desk.usage().0 - busy) / from.elapsed().as_secs_f64()
    };
    // References are added, the picture converges, messages disappear.
    while share(5) > 0.2 {
        assert!(start.elapsed() < LONGEST_TO_CONVERGE, "the picture does not converge");
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
