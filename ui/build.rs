//! Tells a release build the commit of its source, for the manifests of experiments. Other builds change from minute to
//! minute; a commit would say nothing of them, and finding it would build them anew.

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
