//! Layers of settings, and the files that are installed with the program.

use super::{Bench, number, stderr};

const TINY: &str = "--size 16x12 --json";

#[test]
fn settings_come_in_layers() {
    let bench = Bench::new();
    let samples = |line: &str| number(&bench.json(line), "/samples");
    std::fs::write(bench.path("mine.toml"), "samples = 3\nbounces = 1\nmode = 'full'\n").unwrap();
    let render = format!("render room.obj {TINY} -o a.png");
    let answer = bench.json(&render);
    assert_eq!((number(&answer, "/samples"), &answer["bounces"]), (16.0, &serde_json::json!("all")));
    let with_file = format!("{render} --config mine.toml");
    let answer = bench.json(&with_file);
    assert_eq!((number(&answer, "/samples"), number(&answer, "/bounces")), (3.0, 1.0));
    assert_eq!(answer["mode"], "full");
    std::fs::write(bench.path("room.afterimage.toml"), "[settings]\nsamples = 2\n").unwrap();
    assert_eq!(samples(&with_file), 2.0);
    assert!(!stderr(&bench.run(&with_file)).contains("warning"), "the importer knows the section");
    let output = bench.run_with(&with_file, &[("AFTERIMAGE_SAMPLES", "5")]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("\"samples\":5"));
    assert_eq!(samples(&format!("{with_file} --samples 1")), 1.0);
    let output = bench.run_with(&render, &[("AFTERIMAGE_CONFIG", "mine.toml")]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("\"mode\":\"full\""));
}

#[test]
fn all_bounces_are_written_and_read_as_a_word() {
    let bench = Bench::new();
    let render = format!("render room.obj {TINY} --mode full --samples 1 -o a.png");
    assert_eq!(bench.json(&format!("{render} --bounces all"))["bounces"], "all");
    let notes = afterimage::raster::load::read_notes(&bench.path("a.png")).unwrap();
    let (_, settings) = notes.iter().find(|(name, _)| name == "Settings").unwrap();
    assert!(settings.contains("--bounces all "), "{settings}");
    let again = format!("render room.obj {settings} --json -o a.png");
    assert_eq!(bench.json(&again)["bounces"], "all", "the metadata are flags of the program");
    let output = bench.run_with(&render, &[("AFTERIMAGE_BOUNCES", "all")]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("\"bounces\":\"all\""));
    let output = bench.run(&format!("{render} --bounces 65"));
    assert!(output.status.code() == Some(2) && stderr(&output).contains("'all' or a whole number"));
}

#[test]
fn invalid_settings_are_warnings_and_the_command_still_runs() {
    let bench = Bench::new();
    std::fs::write(bench.path("mine.toml"), "sampels = 3\n[keys]\nadd-reference = 'K'\n").unwrap();
    let output = bench.run(&format!("render room.obj {TINY} -o a.png --config mine.toml"));
    assert!(output.status.success());
    let errors = stderr(&output);
    assert!(
        errors.contains("did you mean 'samples'?") && errors.contains("the default keys apply"),
        "{errors}"
    );
    let output = bench.run("doctor --config none.toml");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("no such file"));
}

#[test]
fn help_lists_the_keys_as_they_are_bound() {
    let bench = Bench::new();
    std::fs::write(bench.path("mine.toml"), "[keys]\nadd-reference = ['B', 'Ctrl+Shift+B']\n").unwrap();
    let help = |line: &str| String::from_utf8(bench.run(line).stdout).unwrap();
    let line = |text: String| text.lines().find(|l| l.contains("add a reference")).unwrap().trim().to_owned();
    assert!(line(help("--help")).starts_with("N "));
    assert!(line(help("--config mine.toml --help")).starts_with("B, Ctrl+Shift+B "));
}

#[test]
fn doctor_reports_paths_and_simd() {
    let bench = Bench::new();
    std::fs::write(bench.path("mine.toml"), "").unwrap();
    let answer = bench.json("doctor --json --config mine.toml");
    assert_eq!(answer["paths"]["settings"], "mine.toml");
    assert_eq!(answer["paths"]["has_settings"], true);
    for place in ["config", "state", "cache"] {
        assert!(answer["paths"][place].as_str().unwrap().ends_with("afterimage"), "{place}");
    }
    let in_use = answer["simd"]["in_use"][0].as_str().unwrap();
    assert!(!in_use.is_empty() && !in_use.contains('('), "{in_use}");
}

#[test]
fn completions_and_manual_page_list_the_flags() {
    let bench = Bench::new();
    let text = |line: &str| {
        let output = bench.run(line);
        assert!(output.status.success(), "{line}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    for shell in ["bash", "zsh", "fish"] {
        let completions = text(&format!("completions {shell}"));
        assert!(completions.contains("no-background") && completions.contains("tour"), "{shell}");
    }
    let page = text("man");
    assert!(
        page.contains(".TH afterimage 1") && page.contains("COMMAND RENDER") && page.contains("antialias")
    );
    let licences = text("licences");
    assert!(licences.contains("| eframe |") && licences.contains("MIT OR Apache-2.0"));
}

#[test]
fn a_picture_says_which_daylight_it_shows() {
    let bench = Bench::new();
    bench.run(&format!("render room.obj {TINY} --mode full --samples 1 --sky overcast -o a.png"));
    let notes = afterimage::raster::load::read_notes(&bench.path("a.png")).unwrap();
    let (_, daylight) = notes.iter().find(|(name, _)| name == "Daylight").unwrap();
    assert!(daylight.ends_with("sky overcast"), "{daylight}");
}
