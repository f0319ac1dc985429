//! A real window on a virtual display, and what a user can do and see there.

use super::*;
use afterimage::Camera;
use afterimage_ui::picture::pose_text::pose_of_flags;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;

const PROGRAM: &str = env!("CARGO_BIN_EXE_afterimage");
const SCREEN: [u32; 2] = [1280, 800];

/// Interval at which another process is polled.
pub(super) const POLL: Duration = Duration::from_millis(40);

/// A floor with two blocks. The importer adds a sun and a sky.
pub(super) const COURTYARD: &str = "\
v -6 0 -6\nv 6 0 -6\nv 6 0 6\nv -6 0 6
v -2 0 -2\nv 0 0 -2\nv 0 2 -2\nv -2 2 -2\nv -2 0 -4\nv 0 0 -4\nv 0 2 -4\nv -2 2 -4
v 2 0 0\nv 3 0 0\nv 3 1 0\nv 2 1 0\nv 2 0 -1\nv 3 0 -1\nv 3 1 -1\nv 2 1 -1
f 1 4 3 2\nf 5 6 7 8\nf 10 9 12 11\nf 9 5 8 12\nf 6 10 11 7\nf 8 7 11 12
f 13 14 15 16\nf 18 17 20 19\nf 17 13 16 20\nf 14 18 19 15\nf 16 15 19 20
";

pub(super) struct Display {
    server: Child,
    pub(super) name: String,
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

static STARTING: Mutex<()> = Mutex::new(());

/// A display of the test's own. It does not restart when its last client leaves: a client that
/// connects meanwhile would be refused. `None`, with a message, where a tool is missing.
pub(super) fn display() -> Option<Display> {
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
    // Two servers that search for a free number at once may choose the same.
    let _starting = STARTING.lock().unwrap_or_else(PoisonError::into_inner);
    let mut server = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", &screen, "-nolisten", "tcp", "-noreset"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("Xvfb starts");
    let mut number = String::new();
    BufReader::new(server.stdout.take().expect("its output")).read_line(&mut number).expect("its number");
    Some(Display { server, name: format!(":{}", number.trim()) })
}

/// A software rasteriser uses every core: two windows at once took a minute to open.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

pub(super) struct Desk {
    pub(super) app: Child,
    display: Display,
    window: String,
    folder: tempfile::TempDir,
    _turn: MutexGuard<'static, ()>,
}

/// The program's output, in its folder.
const SAID: &str = "said.txt";

impl Drop for Desk {
    fn drop(&mut self) {
        let _ = self.app.kill();
        let _ = self.app.wait();
    }
}

/// The program on a display, without any settings of the user.
pub(super) fn program(display: &str, folder: &Path) -> Command {
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

    /// Opens a window on a model given as text.
    pub(super) fn open_with_model(model: &str) -> Option<Self> {
        Self::start(Some(model), &["model.obj", "--samples", "1", "--bounces", "1"], &[])
    }

    /// Opens a window on the courtyard with environment variables.
    pub(super) fn open_in(variables: &[(&str, &str)]) -> Option<Self> {
        Self::start(Some(COURTYARD), &["model.obj", "--samples", "1", "--bounces", "1"], variables)
    }

    /// Opens a window with arguments.
    pub(super) fn open_with(arguments: &[&str]) -> Option<Self> {
        Self::start(None, arguments, &[])
    }

    pub(super) fn start(model: Option<&str>, arguments: &[&str], variables: &[(&str, &str)]) -> Option<Self> {
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
            let found = desk.run("xdotool", &["search", "--onlyvisible", "--name", "Afterimage$"]);
            found.lines().last().map(str::to_owned)
        });
        // Without a window manager, nothing else gives it the keyboard.
        desk.run("xdotool", &["windowfocus", "--sync", &desk.window]);
        Some(desk)
    }

    pub(super) fn display(&self) -> &str {
        &self.display.name
    }

    /// Returns the window's identity.
    pub(super) fn window(&self) -> u32 {
        self.window.parse().expect("a number")
    }

    /// Returns the folder in which the program was started.
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
            assert!(start.elapsed() < DEADLINE, "timed out waiting for: {what}; {}", self.evidence());
            sleep(POLL);
        }
    }

    pub(super) fn evidence(&self) -> String {
        let said = std::fs::read_to_string(self.folder.path().join(SAID)).unwrap_or_default();
        format!("see {}; the program said: {said}", self.shoot("in-vain"))
    }

    /// Returns the pose that the program copies, once it no longer changes.
    pub(super) fn pose(&self) -> Camera {
        let mut before = None;
        self.wait_for("a pose at rest", || {
            let now = self.copied_pose();
            let is_still = before == Some(now);
            before = Some(now);
            is_still.then_some(now)
        })
    }

    /// Holds a key until the camera is at least 0.3 m away from a place, and returns its pose: a
    /// busy machine may see the press and the release within one frame.
    pub(super) fn fly(&self, key: &str, from: glam::DVec3) -> Camera {
        self.wait_for("a flight", || {
            self.xdotool(&format!("keydown {key} sleep 0.6 keyup {key}"));
            let pose = self.pose();
            (pose.eye.distance(from) > 0.3).then_some(pose)
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

    /// Returns the processor seconds that the program has used, and its memory in KiB.
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

    /// Saves the screen as a picture for people, and returns its path.
    pub(super) fn shoot(&self, name: &str) -> String {
        let path = format!("{}/window-{name}.png", env!("CARGO_TARGET_TMPDIR"));
        self.run("import", &["-window", "root", &path]);
        path
    }

    fn screen(&self, name: &str) -> image::RgbImage {
        image::open(self.shoot(name)).expect("a screenshot").to_rgb8()
    }

    /// Returns the share of the screen that has a colour.
    pub(super) fn share(&self, name: &str, color: [u8; 3]) -> f64 {
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
