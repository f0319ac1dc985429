//! The arrows between the layers, and that the engine links no window and never prints.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Left may use right, never back.
const LAYERS: [&str; 9] =
    ["experiment", "render", "reproject", "reference", "trace", "scene", "camera", "raster", "math"];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found
}

/// The layer of a module; a walk is part of the camera.
fn rank(module: &str) -> Option<usize> {
    let module = if module == "camera_path" { "camera" } else { module };
    LAYERS.iter().position(|l| *l == module)
}

/// Modules named by `crate::` on a line, a list in braces included; comments name what they like.
fn modules_used(line: &str) -> Vec<&str> {
    let code = line.split("//").next().unwrap_or("");
    let word = |text: &str| text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    code.split("crate::").skip(1).map(|rest| &rest[..word(rest)]).collect()
}

#[test]
fn imports_follow_the_arrows() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut wrong = Vec::new();
    for path in sources(&src) {
        let inner = path.strip_prefix(&src).unwrap().to_owned();
        let first = inner.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs");
        if first == "lib" {
            continue;
        }
        let own = rank(first).unwrap_or_else(|| panic!("{first} has no place among the layers"));
        for (number, line) in std::fs::read_to_string(&path).unwrap().lines().enumerate() {
            for module in modules_used(line) {
                if rank(module).is_none_or(|used| used < own) {
                    wrong.push(format!("{}:{}: crate::{module}", inner.display(), number + 1));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "against the arrows, or not by its module:\n{}", wrong.join("\n"));
}

#[test]
fn the_check_itself_finds_what_it_should() {
    assert_eq!(modules_used("use crate::trace::{Hit, Tracer};"), ["trace"]);
    assert_eq!(modules_used("let x = crate::scene::Scene::new(crate::math::Ray);"), ["scene", "math"]);
    assert!(modules_used("/// See [`crate::render`].").is_empty());
}

#[test]
fn the_engine_links_no_window() {
    let tree = Command::new(env!("CARGO"))
        .args(["tree", "-p", "afterimage", "-e", "normal", "--prefix", "none", "--offline", "--locked"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&tree.stdout);
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    for line in text.lines() {
        let name = line.split(' ').next().unwrap_or("");
        let is_window = ["egui", "eframe", "wgpu", "winit"].iter().any(|w| name.starts_with(w));
        assert!(!is_window, "the engine depends on {name}");
    }
}
