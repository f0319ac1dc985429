//! Loads a model (glTF or OBJ), prints what is in it and what was doubtful.
//!
//! `cargo run --release -p afterimage --example load_gltf -- [MODEL]`; without a model, a triangle
//! that it writes itself.

#![allow(clippy::print_stdout, reason = "an example reports on the terminal")]

use afterimage::import::{ImportOptions, load};
use std::path::{Path, PathBuf};

/// A triangle in a file of its own: the positions are base64 of nine little-endian `f32`.
const TRIANGLE: &str = r#"{
    "asset": {"version": "2.0"},
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 7}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36,
        "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]
}"#;

fn written_triangle() -> std::io::Result<PathBuf> {
    let path = std::env::temp_dir().join("afterimage-triangle.gltf");
    std::fs::write(&path, TRIANGLE)?;
    Ok(path)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args_os().nth(1).map_or_else(written_triangle, |path| Ok(PathBuf::from(path)))?;

    // The defaults ask the file for its unit and its up axis, and open no file outside the model's
    // folder. The closure gets each phase with its progress from 0 to 1; `false` cancels.
    let scene = load(Path::new(&path), &ImportOptions::default(), &|phase, part| {
        if part == 1.0 {
            println!("done: {}", phase.label());
        }
        true
    })?;

    let size_m = scene.bounds_m[1] - scene.bounds_m[0];
    println!("{}: {} triangles, {:.2} m", scene.name, scene.triangles.len(), size_m);
    for material in &scene.materials {
        println!("material '{}': {}", material.name, material.kind_name());
    }
    // Damaged parts never stop an import that leaves something to show. Here the material 7 does
    // not exist.
    for warning in &scene.warnings {
        println!("{}: {}", warning.file, warning.message);
    }
    Ok(())
}
