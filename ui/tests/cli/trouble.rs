//! Invalid input: the exit code, one sentence on stderr, and nothing on stdout.

use super::{Bench, stderr};
use std::time::{Duration, Instant};

/// Runs a command line that must fail with `code`, a message that contains `words`, and no data.
fn assert_fails(bench: &Bench, line: &str, code: i32, words: &str) {
    let output = bench.run(line);
    let errors = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{line}: {errors}");
    assert!(errors.contains(words), "{line}: '{words}' is not in: {errors}");
    assert!(!errors.contains("panicked"), "{line}: {errors}");
    assert!(output.stdout.is_empty(), "{line}");
}

#[test]
fn usage_errors_end_with_two() {
    let bench = Bench::new();
    for (line, words) in [
        ("render room.obj --size 0x0 -o a.png", "like 1280x720"),
        ("render room.obj --size 1e9x1e9 -o a.png", "like 1280x720"),
        ("render room.obj --size 60000x60000 -o a.png", "16384x16384"),
        ("render room.obj --size 60000x60000 --mode fast -o a.png", "GB of memory"),
        ("render room.obj --no-background --reference 1,1,1:0,0,0 -o a.png", "cannot be used with"),
        ("render room.obj --samples 0 -o a.png", "--samples"),
        ("render room.obj --mode slow -o a.png", "possible values: full, paper, fast, exact"),
        ("rendr", "did you mean 'render'?"),
        ("house", "there is no command and no file 'house'; there are render, tour"),
        ("render room.obj --eye nan,0,0 --look-at 0,0,0 -o a.png", "three finite numbers"),
        ("render room.obj --eye 1,2 --look-at 0,0,0 -o a.png", "three finite numbers"),
        ("render room.obj --eye -1,2,3 -o a.png", "--look-at"),
        ("render room.obj --eye 1,2,3 --look-at 1,2,3 -o a.png", "same point"),
        ("render room.obj --fov-y 180 -o a.png", "1 to 170"),
        ("render room.obj --exposure bright -o a.png", "'auto' or from -64 to 64 stops"),
        ("render room.obj --view kitchen -o a.png", "it has: start"),
        ("render room.obj -o a.gif", ".jpg or .exr"),
        ("render room.obj -o a.png --aov depth", "needs an EXR"),
        ("render room.obj -o a.exr --aov warmth", "primitive"),
        ("render room.obj -o a.png --reference 1,1,1", "EX,EY,EZ:LX,LY,LZ"),
        ("render room.obj", "--output"),
        ("inspect room.obj --sun-place 52.5,13.4", "need each other"),
        ("inspect room.obj --sun-time 2026-06-21T12:00Z", "need each other"),
        ("inspect room.obj --sun-place 91,0 --sun-time 2026-06-21T12:00Z", "latitude from -90 to 90"),
        ("inspect room.obj --sun-place 0,0 --sun-time noon", "like 2026-06-21T12:00[Europe/Berlin]"),
        ("inspect room.obj --north 400", "-360 to 360"),
        ("tour room.obj --out run --placement gird", "greedy, grid, none"),
        ("tour room.obj --out run --threshold 101", "0 to 100"),
        ("tour room.obj", "--out"),
        ("experiment table2 room.obj --out run", "possible values: table1"),
        ("experiment table1 room.obj", "--out DIR"),
        ("experiment table1 room.obj sofa.obj --out run", "sofa.obj"),
        ("experiment table1 room.obj --out run --shard 5/4", "out of range"),
        ("experiment merge --out run", "folders of the shards"),
        ("room.obj render -o a.png", "after"),
        ("inspect", "SCENE"),
    ] {
        assert_fails(&bench, line, 2, words);
    }
    assert_eq!(bench.names(""), ["room.mtl", "room.obj", "walks.json"]);
}

#[test]
fn scenes_that_cannot_be_imported_end_with_three() {
    let bench = Bench::new();
    std::fs::write(bench.path("empty.obj"), "# nothing\n").unwrap();
    for (line, words) in [
        ("inspect none.obj", "none.obj"),
        ("render empty.obj -o a.png", "empty.obj"),
        ("render builtin:nowhere -o a.png", "gallery"),
        ("inspect .", "folder"),
    ] {
        assert_fails(&bench, line, 3, words);
    }
}

#[test]
fn failures_end_with_one() {
    let bench = Bench::new();
    std::fs::write(bench.path("broken.json"), "{").unwrap();
    std::fs::write(bench.path("empty.json"), r#"{"fov_y_deg": 60, "keyframes": []}"#).unwrap();
    let keyframe = r#"{"eye": [0, 1, 3], "at": [0, 1, 0]}"#;
    for (file, frames) in [("still.json", "0"), ("endless.json", "4000000000")] {
        let text = format!(r#"{{"fov_y_deg": 60, "frames": {frames}, "keyframes": [{keyframe}]}}"#);
        std::fs::write(bench.path(file), text).unwrap();
    }
    for (line, words) in [
        ("tour room.obj --out run --path still.json", "from 1 to 1000000"),
        ("tour room.obj --out run --path endless.json", "from 1 to 1000000"),
        ("render room.obj -o nowhere/a.png", "nowhere"),
        ("compare room.obj room.obj", "neither PNG, JPEG nor OpenEXR"),
        ("compare a.png b.png", "a.png"),
        ("tour room.obj --out run --path none.json", "none.json"),
        ("tour room.obj --out run --path broken.json", "broken.json"),
        ("tour room.obj --out run --path empty.json", "keyframes"),
        ("tour room.obj --out run --path walks.json#long", "it has: short"),
        ("tour room.obj --out room.mtl", "room.mtl"),
        ("experiment table1 room.obj --out .", "not a run folder"),
        ("experiment table1 room.obj --out run --path broken.json", "broken.json"),
        ("experiment merge cache --out run", "not a run folder"),
    ] {
        assert_fails(&bench, line, 1, words);
    }
}

#[test]
fn a_sky_that_cannot_be_read_is_a_warning_and_one_that_can_is_named() {
    let bench = Bench::new();
    std::fs::write(bench.path("square.hdr"), "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 8\n").unwrap();
    for (sky, words) in [("square.hdr", "twice as wide as high"), ("sunny", "or name a kind of sky")] {
        let output = bench.run(&format!("inspect room.obj --sky {sky} --json --strict"));
        let errors = stderr(&output);
        assert_eq!(output.status.code(), Some(4), "{errors}");
        assert_eq!(errors.lines().filter(|line| line.contains(words)).count(), 1, "{errors}");
        assert!(String::from_utf8_lossy(&output.stdout).contains("\"sky\":null"), "the room has none");
    }
    let place = "--sun-place 52.52,13.40 --sun-time 2026-06-21T12:00[Europe/Berlin]";
    for (sky, name, suns) in [("overcast", "CIE overcast", 0.0), ("physical", "physical, turbidity 3.0", 1.0)]
    {
        let object = bench.json(&format!("inspect room.obj --sky {sky} {place} --json"));
        assert_eq!(object["sky"], name);
        assert_eq!(super::number(&object, "/light_kinds/sun"), suns);
    }
}

#[test]
fn warnings_end_with_four_when_strict() {
    let bench = Bench::new();
    let doubtful = std::fs::read_to_string(bench.path("room.obj")).unwrap() + "f 1 1 2\n";
    std::fs::write(bench.path("room.obj"), doubtful).unwrap();
    let answer = bench.json("inspect room.obj --json");
    assert!(!answer["warnings"].as_array().unwrap().is_empty());
    let output = bench.run("inspect room.obj --json --strict");
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    assert!(!output.stdout.is_empty(), "the answer is given all the same");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_reported() {
    if !std::path::Path::new("/dev/full").exists() {
        eprintln!("skipped: there is no /dev/full");
        return;
    }
    let bench = Bench::new();
    std::os::unix::fs::symlink("/dev/full", bench.path("full.png")).unwrap();
    assert_fails(&bench, "render room.obj --size 64x48 --samples 1 -o full.png", 1, "No space");
}

#[test]
#[cfg(unix)]
fn an_interrupted_tour_keeps_its_records() {
    let bench = Bench::new();
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_afterimage"))
        .args(
            "tour room.obj --path walks.json#short --frames 100000 --size 64x48 --samples 2 --pictures --out run"
                .split(' '),
        )
        .current_dir(bench.dir.path())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let (started, third) = (Instant::now(), bench.path("run/images/types_0002.png"));
    while !third.exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        assert!(started.elapsed() < Duration::from_secs(240), "no third frame");
        std::thread::sleep(Duration::from_millis(5));
    }
    let killed = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let table = std::fs::read_to_string(bench.path("run/frames.csv")).unwrap();
    assert!(table.lines().count() > 2);
}
