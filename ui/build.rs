//! Passes the commit of its source to a release build, for the manifests of experiments. Other
//! builds contain no commit: their source changes more often than it is committed, and each commit
//! would cause another build.

use std::process::Command;

fn main() {
    println!("cargo:rerun-if-env-changed=AFTERIMAGE_COMMIT");
    if std::env::var("PROFILE").as_deref() != Ok("release") || std::env::var_os("AFTERIMAGE_COMMIT").is_some()
    {
        println!("cargo:rerun-if-changed=build.rs");
        return;
    }
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok().filter(|o| o.status.success())?;
        Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
    };
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo:rerun-if-changed={log}");
    }
    if let Some(commit) = git(&["describe", "--always", "--dirty", "--abbrev=12"]) {
        println!("cargo:rustc-env=AFTERIMAGE_COMMIT={commit}");
    }
}
