//! The arrows between layers and between the files of a layer; the engine links no window library.

mod graph;
mod source;

use graph::{Graph, Import, circles};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// Layers of the engine from top to bottom. A layer may use those on lower lines, not those on its
/// own line.
const LEVELS: [&[&str]; 10] = [
    &["experiment"],
    &["render"],
    &["warp", "lookup", "store"],
    &["reference"],
    &["cells"],
    &["trace"],
    &["bsdf", "import"],
    &["scene"],
    &["raster", "camera"],
    &["math"],
];

fn level(layer: &str) -> usize {
    let found = LEVELS.iter().position(|level| level.contains(&layer));
    found.unwrap_or_else(|| panic!("{layer} is not among the layers"))
}

fn layer(file: &str) -> &str {
    file.split('/').next().unwrap().trim_end_matches(".rs")
}

fn may_use(user: &str, used: &str) -> bool {
    // The engine itself reads no scene files: experiments and the program do.
    let is_below = level(user) < level(used) && (used != "import" || user == "experiment");
    user == used || is_below
}

fn imports_of(sources: &str) -> BTreeSet<Import> {
    Graph::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(sources)).imports()
}

/// Imports from a layer above, or from another layer of the same level.
fn upward(imports: &BTreeSet<Import>) -> BTreeSet<Import> {
    let inner = imports.iter().filter(|import| import.from != "lib.rs");
    let wrong = inner.filter(|i| !i.layers.iter().all(|used| may_use(layer(&i.from), used)));
    wrong.cloned().collect()
}

fn text(imports: &BTreeSet<Import>) -> String {
    imports.iter().map(|i| format!("  {} -> {}\n", i.from, i.to)).collect()
}

/// Imports between files of the same layer.
fn within_layers(imports: &BTreeSet<Import>) -> BTreeSet<Import> {
    imports.iter().filter(|i| layer(&i.from) == layer(&i.to)).cloned().collect()
}

/// Each circle as a list of files, and the arrows that make it.
fn circles_text(imports: &BTreeSet<Import>) -> String {
    let within = |circle: &[String], i: &Import| circle.contains(&i.from) && circle.contains(&i.to);
    let arrows = |circle: &[String]| imports.iter().filter(|i| within(circle, i)).cloned().collect();
    let all = circles(imports);
    let lines =
        all.iter().map(|c| format!("a circle of {} files: {}\n{}", c.len(), c.join(", "), text(&arrows(c))));
    lines.collect()
}

#[test]
fn imports_follow_the_arrows() {
    let wrong = upward(&imports_of("src"));
    assert!(wrong.is_empty(), "against the arrows between layers:\n{}", text(&wrong));
}

#[test]
fn no_layer_has_a_circle_of_files() {
    let engine = circles_text(&within_layers(&imports_of("src")));
    let program = circles_text(&imports_of("ui/src"));
    assert!(engine.is_empty() && program.is_empty(), "in src:\n{engine}in ui/src:\n{program}");
}

/// Two layers and a planted import for each rule.
fn planted() -> BTreeSet<Import> {
    let files = [
        ("lib.rs", "pub mod scene; pub mod trace; pub use scene::Scene;"),
        ("scene/mod.rs", "mod a; mod b; mod c; pub use a::A; pub use crate::scene::b::B as Other;"),
        ("scene/a.rs", "use super::{Other, c::{self, C}}; /* use crate::trace::Tracer; */ pub struct A(c::D);"),
        ("scene/b.rs", "pub struct B; fn f(a: &crate::scene::A) -> &str { \"use super::c::C;\" }"),
        ("scene/c.rs", "// use super::A;\npub struct C; pub struct D; fn g() -> char { '\"' } const T: u8 = crate::trace::N;
            #[cfg(test)]\nmod tests { use super::super::A; }"),
        ("trace/mod.rs", "pub const N: u8 = 1; use crate::scene; fn f(_: scene::A, c: std::fmt::Error) {}"),
    ];
    Graph::new(files).imports()
}

#[test]
fn the_check_finds_a_planted_circle_and_a_planted_upward_arrow() {
    let arrows = |imports: &BTreeSet<Import>| text(imports).replace([' ', '\n'], "").replace(".rs", "");
    let imports = planted();
    let a_to_b_and_c = "scene/a->scene/bscene/a->scene/c";
    assert_eq!(
        arrows(&imports),
        format!("{a_to_b_and_c}scene/b->scene/ascene/c->trace/modtrace/mod->scene/a")
    );
    assert_eq!(arrows(&upward(&imports)), "scene/c->trace/mod");
    let inner = within_layers(&imports);
    let found = circles_text(&inner);
    assert!(found.starts_with("a circle of 2 files: scene/a.rs, scene/b.rs\n"), "{found}");
    assert!(found.ends_with("scene/a.rs -> scene/b.rs\n  scene/b.rs -> scene/a.rs\n"), "{found}");
    assert!(circles_text(&imports).starts_with("a circle of 4 files"));
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
