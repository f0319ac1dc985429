//! What a bug report holds: the log and the version.

use super::{Bench, assert_keys, stderr};

#[test]
fn the_log_is_off_unless_it_is_asked_for() {
    let bench = Bench::new();
    let log = |line: &str, filter: &str| {
        let output = bench.run_with(line, &[("RUST_LOG", filter)]);
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    assert_eq!(log("inspect room.obj", ""), "");
    let steps = log("-v inspect room.obj", "");
    for words in
        ["afterimage 0.1.0", "arguments: [\"-v\", \"inspect\", \"room.obj\"]", "room.obj: 16 triangles"]
    {
        assert!(steps.contains(words), "'{words}' is not in: {steps}");
    }
    assert!(!steps.contains("DEBUG"), "{steps}");
    let details = log("inspect room.obj -vv", "");
    assert!(details.contains("room.mtl"), "{details}");
    let chosen = log("inspect room.obj -v", "afterimage::import=debug");
    assert!(chosen.contains("room.mtl") && !chosen.contains("arguments"), "RUST_LOG decides: {chosen}");
    let graphics = log("doctor -v", "");
    assert!(!graphics.contains("wgpu"), "libraries are silent: {graphics}");
}

#[test]
fn version_and_doctor_name_the_build() {
    let bench = Bench::new();
    let version = String::from_utf8(bench.run("--version").stdout).unwrap();
    let known = ["(commit ", "(debug build)", "(built from a package, commit unknown)"];
    assert!(
        version.starts_with("afterimage 0.1.0 (") && known.iter().any(|words| version.contains(words)),
        "{version}"
    );
    let facts = bench.json("doctor --json");
    assert_keys(&facts, &["version", "commit", "build", "system", "processor", "memory_gb"]);
    assert!(facts["memory_gb"].as_f64().is_none_or(|gb| gb > 0.1), "{facts}");
}
