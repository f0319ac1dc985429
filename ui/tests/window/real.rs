//! A real window on a virtual display, driven as a person would: keys, drags, clicks. What it did is read from the
//! clipboard, from files and from the screen; screenshots are left in the build folder to be looked at.

use super::*;
use afterimage::Camera;
use afterimage_ui::window::pose_text::pose_of_flags;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;

const PROGRAM: &str = env!("CARGO_BIN_EXE_afterimage");
const SCREEN: [u32; 2] = [1280, 800];

/// Another process decides when it is done; it is asked so often.
pub(super) const POLL: Duration = Duration::from_millis(40);

/// A floor with two blocks; the importer gives it a sun and a sky.
const COURTYARD: &str = "\
v -6 0 -6\nv 6 0 -6\nv 6 0 6\nv -6 0 6
v -2 0 -2\nv 0 0 -2\nv 0 2 -2\nv -2 2 -2\nv -2 0 -4\nv 0 0 -4\nv 0 2 -4\nv -2 2 -4
v 2 0 0\nv 3 0 0\nv 3 1 0\nv 2 1 0\nv 2 0 -1\nv 3 0 -1\nv 3 1 -1\nv 2 1 -1
f 1 4 3 2\nf 5 6 7 8\nf 10 9 12 11\nf 9 5 8 12\nf 6 10 11 7\nf 8 7 11 12
f 13 14 15 16\nf 18 17 20 19\nf 17 13 16 20\nf 14 18 19 15\nf 16 15 19 20
";

struct Display {
    server: Child,
    name: String,
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A display of our own; `None`, said aloud, where a tool is missing.
fn display() -> Option<Display> {
    let has = |tool: &str| {
        let found = Command::new("sh").args(["-c", &format!("command -v {tool}")]).output();
        found.is_ok_and(|found| found.status.success())
    };
    let missing: Vec<&str> =
        ["Xvfb", "xdotool", "xclip", "import"].into_iter().filter(|tool| !has(tool)).collect();
    if !missing.is_empty() || !has_adapter() {
        let is_required = std::env::var("AFTERIMAGE_REQUIRE_GRAPHICS").is_ok_and(|v| v == "1");
        assert!(!is_required, "missing: {missing:?}, or a graphics adapter");
        writeln!(std::io::stderr(), "skipped: a real window needs {missing:?} and a graphics adapter")
            .expect("stderr");
        return None;
    }
    let screen = format!("{}x{}x24", SCREEN[0], SCREEN[1]);
    let mut server = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", &screen, "-nolisten", "tcp"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("Xvfb starts");
    let mut number = String::new();
    BufReader::new(server.stdout.take().expect("its output")).read_line(&mut number).expect("its number");
    Some(Display { server, name: format!(":{}", number.trim()) })
}

/// Programs that draw by the processor take every core: two beside each other waited a minute for their windows.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

pub(super) struct Desk {
    app: Child,
    display: Display,
    window: String,
    folder: tempfile::TempDir,
    _turn: MutexGuard<'static, ()>,
}

/// What the program said, in its folder.
const SAID: &str = "said.txt";

impl Drop for Desk {
    fn drop(&mut self) {
        let _ = self.app.kill();
        let _ = self.app.wait();
    }
}

/// The program on a display, with nothing of the user's own settings.
fn program(display: &str, folder: &Path) -> Command {
    let path = std::env::var("AFTERIMAGE_PROGRAM").unwrap_or_else(|_| PROGRAM.to_owned());
    let mut command = Command::new(path);
    command.current_dir(folder).env("DISPLAY", display).env("HOME", folder).env("XDG_RUNTIME_DIR", folder);
    for name in ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_PICTURES_DIR"]
    {
        command.env_remove(name);
    }
    command
}

impl Desk {
    pub(super) fn open() -> Option<Self> {
        Self::open_with_model(COURTYARD)
    }

    /// A window on a model, by its text.
    pub(super) fn open_with_model(model: &str) -> Option<Self> {
        Self::start(Some(model), &["model.obj", "--samples", "1"], &[])
    }

    /// A window on the courtyard, with variables of the environment.
    pub(super) fn open_in(variables: &[(&str, &str)]) -> Option<Self> {
        Self::start(Some(COURTYARD), &["model.obj", "--samples", "1"], variables)
    }

    /// A window opened with arguments.
    pub(super) fn open_with(arguments: &[&str]) -> Option<Self> {
        Self::start(None, arguments, &[])
    }

    fn start(model: Option<&str>, arguments: &[&str], variables: &[(&str, &str)]) -> Option<Self> {
        let turn = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        let display = display()?;
        let folder = tempfile::tempdir().expect("a folder");
        if let Some(text) = model {
            std::fs::write(folder.path().join("model.obj"), text).expect("a model");
        }
        let app = program(&display.name, folder.path())
            .args(arguments)
            .envs(variables.iter().copied())
            .stderr(std::fs::File::create(folder.path().join(SAID)).expect("a file"))
            .spawn()
            .expect("the program starts");
        let mut desk = Self { app, display, window: String::new(), folder, _turn: turn };
        desk.window = desk.wait_for("a window", || {
            let found = desk.run("xdotool", &["search", "--onlyvisible", "--name", "^Afterimage"]);
            found.lines().last().map(str::to_owned)
        });
        // Without a window manager nobody else gives the keys to it.
        desk.run("xdotool", &["windowfocus", "--sync", &desk.window]);
        Some(desk)
    }

    pub(super) fn display(&self) -> &str {
        &self.display.name
    }

    /// The window's number.
    pub(super) fn window(&self) -> u32 {
        self.window.parse().expect("a number")
    }

    /// Where the program was started.
    pub(super) fn folder(&self) -> &Path {
        self.folder.path()
    }

    fn run(&self, tool: &str, arguments: &[&str]) -> String {
        let mut command = Command::new(tool);
        let Output { stdout, .. } =
            command.args(arguments).env("DISPLAY", &self.display.name).output().expect("the tool runs");
        String::from_utf8_lossy(&stdout).into_owned()
    }

    pub(super) fn xdotool(&self, line: &str) {
        self.run("xdotool", &line.split_whitespace().collect::<Vec<_>>());
    }

    pub(super) fn wait_for<T>(&self, what: &str, mut look: impl FnMut() -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            if let Some(found) = look() {
                return found;
            }
            assert!(start.elapsed() < DEADLINE, "waited in vain: {what}; {}", self.evidence());
            sleep(POLL);
        }
    }

    fn evidence(&self) -> String {
        let said = std::fs::read_to_string(self.folder.path().join(SAID)).unwrap_or_default();
        format!("see {}; the program said: {said}", self.shoot("in-vain"))
    }

    /// The pose that the program copies, once it no longer changes.
    pub(super) fn pose(&self) -> Camera {
        let mut before = None;
        self.wait_for("a pose at rest", || {
            let now = self.copied_pose();
            let is_still = before == Some(now);
            before = Some(now);
            is_still.then_some(now)
        })
    }

    fn copied_pose(&self) -> Camera {
        // The old pose would look like an answer.
        let clear = "printf nothing | xclip -selection clipboard >/dev/null 2>&1";
        self.run("sh", &["-c", clear]);
        self.xdotool("key ctrl+c");
        let any = Camera::look_at(glam::DVec3::ZERO, glam::DVec3::NEG_Z, 60.0);
        self.wait_for("the pose in the clipboard", || {
            let text = self.run("timeout", &["2", "xclip", "-o", "-selection", "clipboard"]);
            text.starts_with("--eye").then(|| pose_of_flags(&text, &any).expect("a pose"))
        })
    }

    /// The screen as the server keeps it: a header, then four bytes a pixel.
    pub(super) fn raw_screen(&self) -> Vec<u8> {
        let mut command = Command::new("xwd");
        command
            .args(["-root", "-silent"])
            .env("DISPLAY", &self.display.name)
            .output()
            .expect("xwd runs")
            .stdout
    }

    /// Seconds of processor that the program has taken, and the memory it holds, KiB.
    pub(super) fn usage(&self) -> (f64, u64) {
        const TICKS_PER_SEC: f64 = 100.0;
        let read =
            |name: &str| std::fs::read_to_string(format!("/proc/{}/{name}", self.app.id())).expect("proc");
        let stat = read("stat");
        let fields: Vec<&str> = stat.rsplit(')').next().expect("fields").split_whitespace().collect();
        let ticks: f64 = [fields[11], fields[12]].iter().map(|t| t.parse::<f64>().expect("ticks")).sum();
        let status = read("status");
        let line = status.lines().find(|line| line.starts_with("VmRSS")).expect("memory");
        let kilobytes = line.split_whitespace().nth(1).and_then(|word| word.parse().ok()).expect("a number");
        (ticks / TICKS_PER_SEC, kilobytes)
    }

    /// Saves the screen for people to look at; returns where.
    fn shoot(&self, name: &str) -> String {
        let path = format!("{}/window-{name}.png", env!("CARGO_TARGET_TMPDIR"));
        self.run("import", &["-window", "root", &path]);
        path
    }

    fn screen(&self, name: &str) -> image::RgbImage {
        image::open(self.shoot(name)).expect("a screenshot").to_rgb8()
    }

    /// The share of the screen in a colour.
    fn share(&self, name: &str, color: [u8; 3]) -> f64 {
        let screen = self.screen(name);
        screen.pixels().filter(|p| p.0 == color).count() as f64 / f64::from(SCREEN[0] * SCREEN[1])
    }

    pub(super) fn wait_for_share(&self, name: &str, color: [u8; 3], least: f64) {
        self.wait_for(name, || (self.share(name, color) >= least).then_some(()));
    }

    pub(super) fn saved(&self, extension: &str) -> Option<PathBuf> {
        let files = std::fs::read_dir(self.folder.path()).expect("the folder");
        let paths = files.filter_map(|file| Some(file.ok()?.path()));
        paths.into_iter().find(|path| path.extension().is_some_and(|e| e == extension))
    }
}

pub(super) const TYPE1: [u8; 3] = [0x00, 0x72, 0xB2];
/// The ground of panels: a fifth of the window, half of it with the help.
const PANEL: [u8; 3] = [0x1B, 0x1B, 0x1B];
/// A point of the picture, away from panels and figures.
pub(super) const MIDDLE: &str = "600 500";

#[test]
fn a_person_walks_looks_and_saves() {
    let Some(desk) = Desk::open() else { return };
    let start = desk.pose();
    desk.shoot("start");

    desk.xdotool("keydown w sleep 0.6 keyup w");
    let ahead = desk.pose();
    let way = ahead.eye - start.eye;
    assert!(
        way.length() > 0.3 && way.normalize_or_zero().dot(start.forward()) > 0.99,
        "W flies ahead: {way}"
    );

    desk.xdotool(&format!("mousemove {MIDDLE} sleep 0.3 mousedown 1 sleep 0.6"));
    // Slowly: within one frame of a busy machine, press and release are a click.
    for _ in 0..4 {
        desk.xdotool("mousemove_relative 25 0 sleep 0.4");
    }
    desk.xdotool("sleep 0.4 mouseup 1");
    let turned = desk.pose();
    let is_there = turned.eye.distance(ahead.eye) < 1e-3;
    assert!(
        turned.yaw < ahead.yaw - 0.1 && is_there,
        "a drag to the right looks right: {ahead:?} {turned:?}"
    );

    desk.xdotool("click --delay 100 4");
    let nearer = desk.pose();
    assert!(nearer.eye.distance(turned.eye) > 0.1, "the wheel flies to the cursor");

    desk.xdotool("key 1");
    let back = desk.pose();
    assert!(back.eye.distance(start.eye) < 1e-3, "1 goes to the first saved view");

    // A key pressed again within the time of one frame counts as held down.
    desk.xdotool("key t sleep 1 key t");
    desk.wait_for_share("types", TYPE1, 0.2);

    desk.xdotool("key F1");
    desk.wait_for_share("help", PANEL, 0.35);
    // Both keys in one frame would find the help still open.
    desk.xdotool("key Escape");
    desk.wait_for("the help to close", || (desk.share("closed", PANEL) < 0.3).then_some(()));
    desk.xdotool("key F2");
    desk.wait_for("a window without panels", || (desk.share("bare", PANEL) < 0.02).then_some(()));
    desk.xdotool("key F2");
    desk.wait_for_share("panels", PANEL, 0.15);

    desk.xdotool("key F12");
    let picture = desk.wait_for("a picture", || desk.saved("png"));
    let picture = image::open(picture).expect("a whole picture").to_rgb8();
    assert!(picture.width() > 200 && picture.pixels().any(|p| p.0 != picture.get_pixel(0, 0).0));
    desk.shoot("end");
}

#[test]
fn drawing_again_and_again_takes_no_memory() {
    // In the other modes the picture at rest grows, and its memory with it.
    let arguments = ["model.obj", "--samples", "1", "--mode", "paper"];
    let Some(desk) = Desk::start(Some(COURTYARD), &arguments, &[]) else { return };
    let wander = |steps: u32| {
        let moves: String = (0..steps)
            .map(|i| format!("mousemove {} {} sleep 0.03 ", 100 + i % 50, 300 + i * 7 % 90))
            .collect();
        desk.xdotool(&moves);
    };
    // What is made once is made by then.
    wander(40);
    let (_, before) = desk.usage();
    wander(120);
    let (_, after) = desk.usage();
    // Shaders compiled at every draw took 0.5 MB a step.
    assert!(after < before + 16 * 1024, "{before} KiB grew to {after} KiB; {}", desk.evidence());
}

/// Every file that the program syncs takes so long.
const SLOW_DISK: Duration = Duration::from_secs(10);

/// Makes the disk slow for a program; `None`, said aloud, where `strace` is missing or not allowed to.
fn slow_disk(program: u32) -> Option<Child> {
    let slow = format!("inject=fsync,fdatasync:delay_enter={}", SLOW_DISK.as_micros());
    let arguments = ["-f", "-p", &program.to_string(), "-e", "trace=fsync,fdatasync", "-e", &slow];
    let tracer = Command::new("strace").args(arguments).stderr(Stdio::null()).spawn();
    let status = || std::fs::read_to_string(format!("/proc/{program}/status")).unwrap_or_default();
    let is_traced = |tracer: &mut Child| loop {
        if status().lines().any(|line| line.starts_with("TracerPid") && !line.ends_with("\t0")) {
            return true;
        }
        if tracer.try_wait().is_ok_and(|ended| ended.is_some()) {
            return false;
        }
        sleep(POLL);
    };
    let found = tracer.ok().and_then(|mut tracer| is_traced(&mut tracer).then_some(tracer));
    if found.is_none() {
        let is_required = std::env::var("AFTERIMAGE_REQUIRE_GRAPHICS").is_ok_and(|v| v == "1");
        assert!(!is_required, "strace is missing or not allowed to trace");
        writeln!(std::io::stderr(), "skipped: a slow disk needs strace, and leave to trace").expect("stderr");
    }
    found
}

#[test]
fn a_slow_disk_holds_nothing_up() {
    let Some(desk) = Desk::open() else { return };
    let start = desk.pose();
    let Some(mut tracer) = slow_disk(desk.app.id()) else { return };
    desk.xdotool("key F12");
    let asked = Instant::now();
    desk.xdotool("keydown w sleep 0.6 keyup w");
    let ahead = desk.pose();
    let took = asked.elapsed();
    assert!(ahead.eye.distance(start.eye) > 0.3 && took < SLOW_DISK, "it walks on: {ahead:?}, {took:?}");
    assert!(desk.saved("png").is_none(), "the picture cannot be there yet");
    desk.wait_for("a picture", || desk.saved("png"));
    assert!(asked.elapsed() >= SLOW_DISK, "the disk was not slow");
    let _ = tracer.kill();
    let _ = tracer.wait();
}

#[test]
fn what_is_missing_is_said_in_one_sentence() {
    let Some(display) = display() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let told = |command: &mut Command| {
        let Output { status, stderr, .. } = command.output().expect("the program runs");
        (status.code(), String::from_utf8_lossy(&stderr).into_owned())
    };
    let mut no_driver = program(&display.name, folder.path());
    no_driver.envs([
        ("VK_ICD_FILENAMES", "/nonexistent"),
        ("VK_DRIVER_FILES", "/nonexistent"),
        ("WGPU_BACKEND", "vulkan"),
    ]);
    let mut no_server = program(":987", folder.path());
    for (what, command) in [("no driver", &mut no_driver), ("no server", &mut no_server)] {
        let (code, text) = told(command);
        assert_eq!(code, Some(1), "{what}: {text}");
        assert!(
            text.contains("the window cannot be opened") && text.contains("mesa-vulkan-drivers"),
            "{what}: {text}"
        );
        assert!(!text.contains("panicked") && text.trim().lines().count() == 1, "{what}: {text}");
    }
}
