//! Passes the commit of the source to the program.
//!
//! Release builds only: a debug build would be compiled again after each commit.

#![allow(clippy::print_stdout, reason = "cargo reads it")]

#[path = "build/commit.rs"]
mod commit;

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build/commit.rs");
    // A packager who builds from an archive can name the commit.
    println!("cargo::rerun-if-env-changed=AFTERIMAGE_COMMIT");
    if std::env::var("PROFILE").as_deref() != Ok("release") || std::env::var_os("AFTERIMAGE_COMMIT").is_some()
    {
        return;
    }
    let Some(folder) = std::env::var_os("CARGO_MANIFEST_DIR") else { return };
    let (commit, read) = commit::of(Path::new(&folder));
    for file in read {
        println!("cargo::rerun-if-changed={}", file.display());
    }
    if let Some(commit) = commit {
        println!("cargo::rustc-env=AFTERIMAGE_COMMIT={commit}");
    }
}
