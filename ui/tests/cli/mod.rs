//! Tests that run the program as a user or a script does.

mod bake;
mod data;
mod film;
mod inspect;
mod log;
mod measure;
mod panorama;
mod readme;
mod runs;
mod schema;
mod section;
mod settings;
mod shell;
mod trouble;
mod written;

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A room with a mirror and a lamp, 4 m wide and 8 m long.
const ROOM: &str = "mtllib room.mtl
v -2 0 4\nv 2 0 4\nv 2 0 -4\nv -2 0 -4
v -2 3 4\nv 2 3 4\nv 2 3 -4\nv -2 3 -4
v 1.9 0.5 -2\nv 1.9 0.5 1\nv 1.9 2.5 1\nv 1.9 2.5 -2
v -0.5 2.9 -1\nv 0.5 2.9 -1\nv 0.5 2.9 0\nv -0.5 2.9 0
usemtl wall
f 1 2 3 4\nf 8 7 6 5\nf 4 3 7 8\nf 2 1 5 6\nf 1 4 8 5\nf 3 2 6 7
usemtl mirror\nf 9 10 11 12
usemtl lamp\nf 13 14 15 16
";

const MATERIALS: &str = "newmtl wall\nKd 0.7 0.6 0.5
newmtl mirror\nKd 0 0 0\nKs 0.8 0.8 0.8\nillum 3
newmtl lamp\nKd 0 0 0\nKe 8 8 8
";

/// A camera path from one end of the room to its middle.
const WALKS: &str = r#"{"short": {"fov_y_deg": 60, "frames": 6, "keyframes": [
    {"eye": [0, 1.6, 3], "at": [0.4, 1.4, 0]}, {"eye": [0, 1.6, 1], "at": [0.4, 1.4, -2]}]}}"#;

/// A temporary folder that contains the room.
struct Bench {
    dir: TempDir,
}

impl Bench {
    fn new() -> Self {
        let bench = Self { dir: tempfile::tempdir().unwrap() };
        for (name, text) in [("room.obj", ROOM), ("room.mtl", MATERIALS), ("walks.json", WALKS)] {
            std::fs::write(bench.path(name), text).unwrap();
        }
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn names(&self, folder: impl AsRef<Path>) -> Vec<String> {
        let folder = self.dir.path().join(folder);
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Runs the program in the folder, with arguments separated by spaces, without a display, and
    /// with a cache in the folder.
    fn run(&self, line: &str) -> Output {
        self.run_with(line, &[])
    }

    /// Like [`Self::run`], with additional environment variables.
    fn run_with(&self, line: &str, variables: &[(&str, &str)]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_afterimage"))
            .args(line.split_whitespace())
            .current_dir(self.dir.path())
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .env("XDG_CACHE_HOME", self.path("cache"))
            .env("XDG_CONFIG_HOME", self.path("config"))
            .env_remove("AFTERIMAGE_CONFIG")
            .env_remove("RUST_LOG")
            .envs(variables.iter().copied())
            .output()
            .unwrap()
    }

    /// The JSON object printed by a run that must succeed.
    fn json(&self, line: &str) -> Value {
        let output = self.run(line);
        assert!(output.status.success(), "{line}: {}", stderr(&output));
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(text.trim_end().lines().count(), 1, "stdout is one object: {text}");
        serde_json::from_str(&text).unwrap()
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Names of an object's fields.
fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

fn number(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} in {value}"))
}

/// Checks that every name of `wanted` is a field of `value`.
fn assert_keys(value: &Value, wanted: &[&str]) {
    let found = keys(value);
    let missing: Vec<_> = wanted.iter().filter(|k| !found.contains(k)).collect();
    assert!(missing.is_empty(), "missing {missing:?} in {found:?}");
}

/// Checks the sums of the percentages of types.
fn assert_types(types: &Value) {
    let part = |name: &str| number(types, &format!("/{name}_percent"));
    assert!((part("type1") + part("type2") + part("type3") - 100.0).abs() < 1e-9, "{types}");
    assert!((part("unseen") + part("uncertain") - part("type3")).abs() < 1e-9, "{types}");
}
