//! What `measure` answers, and what it says about faults.

use super::{Bench, assert_keys, number, stderr};

#[test]
fn measure_answers_with_the_contract_and_writes_its_table() {
    let bench = Bench::new();
    let line = "measure room.obj --eye 0,1.6,3 --look-at 0,1.6,0 --plane height=0.85 --grid 1 --error 10 \
                --bounces 1 --json --csv lux.csv";
    let answer = bench.json(line);
    let wanted =
        ["mean_lux", "min_lux", "max_lux", "uniformity", "error_percent", "points", "is_photometric"];
    assert_keys(&answer, &wanted);
    let points = answer["points"].as_array().unwrap();
    // Whole metres from the eye, without those on the walls: three across, seven along the room.
    assert_eq!(points.len(), 3 * 7);
    let lux = |point: &serde_json::Value| point[3].as_f64().unwrap();
    let mean = points.iter().map(lux).sum::<f64>() / points.len() as f64;
    assert!((number(&answer, "/mean_lux") / mean - 1.0).abs() < 1e-9);
    assert!(number(&answer, "/min_lux") > 0.0 && number(&answer, "/uniformity") < 1.0);
    assert!(points.iter().all(|p| (p[1].as_f64().unwrap() - 0.85).abs() < 1e-4));
    let table = std::fs::read_to_string(bench.path("lux.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + points.len());
    assert!(table.starts_with("x_m,y_m,z_m,lux,standard_error_lux\n"));
    // Lamps without photometric units give relative numbers, and the command says so.
    let output = bench.run(line);
    assert!(stderr(&output).contains("relative"), "{}", stderr(&output));
}

#[test]
fn a_point_of_a_file_reads_what_the_plane_reads_there() {
    let bench = Bench::new();
    std::fs::write(bench.path("points.txt"), "# desk\n0 0.85 0 0 1 0\n\n0,0.85,-1 0,2,0\n").unwrap();
    let flags = "--error 2 --json";
    let points = bench.json(&format!("measure room.obj --points points.txt {flags}"));
    let plane =
        bench.json(&format!("measure room.obj --plane height=0.85,x=-0.5..0.5,z=-1.5..0.5 --grid 1 {flags}"));
    for place in [0, 1] {
        let from_file = number(&points, &format!("/points/{place}/3"));
        let z = number(&points, &format!("/points/{place}/2"));
        let on_plane = plane["points"].as_array().unwrap().iter().find(|p| p[2].as_f64() == Some(z)).unwrap();
        let ratio = on_plane[3].as_f64().unwrap() / from_file;
        assert!((ratio - 1.0).abs() < 0.1, "{ratio} at {z}");
    }
}

#[test]
fn illuminance_is_shown_in_false_colour_and_written_as_numbers() {
    let bench = Bench::new();
    let view = "--eye 0,1.6,3 --look-at 0.4,1.4,0 --size 48x32 --samples 4 --bounces 1 --json";
    let answer = bench.json(&format!("render room.obj {view} --show illuminance --isolines -o lux.png"));
    assert_eq!((&answer["show"], &answer["unit"]), (&"illuminance".into(), &"lx".into()));
    let max = number(&answer, "/scale_max");
    assert!(number(&answer, "/mean") < max && number(&answer, "/line_step") < max);
    let fixed = bench.json(&format!("render room.obj {view} --show illuminance --scale 50000 -o lux.exr"));
    assert_eq!(number(&fixed, "/scale_max"), 50_000.0);
    let layers = exr::prelude::read_all_flat_layers_from_file(bench.path("lux.exr")).unwrap();
    let channels = &layers.layer_data[0].channel_data.list;
    let values = channels.iter().find(|channel| channel.name.to_string() == "Y").unwrap();
    let sum: f64 = values.sample_data.values_as_f32().map(f64::from).sum();
    let known: f64 = channels[0].sample_data.values_as_f32().map(f64::from).sum();
    assert_eq!(channels[0].name.to_string(), "A");
    assert!((sum / known / number(&fixed, "/mean") - 1.0).abs() < 1e-4);
    for show in ["luminance", "clay"] {
        bench.json(&format!("render room.obj {view} --show {show} -o {show}.png"));
        assert!(bench.path(&format!("{show}.png")).exists());
    }
    for (flags, part) in [
        ("--show illuminance --legend -o lux.exr", "--legend is for"),
        ("--show clay --scale 5", "--scale, --isolines"),
        ("--isolines", "--scale, --isolines"),
        ("--show illuminance --antialias 4", "--antialias is for --show radiance"),
        ("--show illuminance --scale 0", "above 0"),
        ("--show heat", "illuminance"),
    ] {
        let file = if flags.contains("-o") { "" } else { "-o none.png" };
        let output = bench.run(&format!("render room.obj {view} {flags} {file}"));
        assert_eq!(output.status.code(), Some(2), "{flags}");
        assert!(stderr(&output).contains(part), "{flags}: {}", stderr(&output));
    }
}

#[test]
fn a_legend_stands_beside_the_picture() {
    let bench = Bench::new();
    let view = "--eye 0,1.6,3 --look-at 0.4,1.4,0 --size 48x64 --samples 1 --bounces 0 --json";
    bench.json(&format!("render room.obj {view} --show daylight-factor --legend --scale 5 -o factor.png"));
    let size = afterimage::raster::load::Picture::load(&bench.path("factor.png")).unwrap().size;
    assert!(size[0] > 48 && size[1] == 64, "{size:?}");
}

#[test]
fn daylight_factors_are_percent_and_need_no_units() {
    let bench = Bench::new();
    let line = "measure room.obj --eye 0,1.6,3 --look-at 0,1.6,0 --grid 2 --error 50 --bounces 1 --json \
                --daylight-factor --csv factor.csv";
    let output = bench.run(line);
    assert!(!stderr(&output).contains("relative"), "{}", stderr(&output));
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_keys(
        &answer,
        &["mean_percent", "min_percent", "max_percent", "uniformity", "error_percent", "points"],
    );
    assert_eq!(answer["quantity"], "daylight-factor");
    assert!((0.0..=100.5).contains(&number(&answer, "/mean_percent")));
    let table = std::fs::read_to_string(bench.path("factor.csv")).unwrap();
    assert!(table.starts_with("x_m,y_m,z_m,daylight_factor_percent,standard_error_percent\n"));
}

#[test]
fn a_tour_is_drawn_in_false_colour_on_one_scale() {
    let bench = Bench::new();
    let tour = "tour room.obj --frames 2 --size 48x32 --samples 1 --bounces 0 --json --out walk";
    let output = bench.run(&format!("{tour} --pictures --show illuminance --legend"));
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stderr(&output).matches("the scale is from 0").count(), 1, "{}", stderr(&output));
    for number in 0..2 {
        let path = bench.path(&format!("walk/images/frame_{number:04}.png"));
        assert!(afterimage::raster::load::Picture::load(&path).unwrap().size[0] > 48);
    }
    for (flags, part) in [
        ("--show illuminance", "add --pictures"),
        ("--show clay --pictures --mode paper", "mode paper"),
        ("--show luminance --pictures --measure", "--measure is for"),
        ("--pictures --legend", "--scale, --isolines"),
    ] {
        let output = bench.run(&format!("{tour} {flags}"));
        assert_eq!(output.status.code(), Some(2), "{flags}");
        assert!(stderr(&output).contains(part), "{flags}: {}", stderr(&output));
    }
}

#[test]
fn glare_answers_with_its_errors_and_its_validity() {
    let bench = Bench::new();
    let view = "--eye 0,1.6,3 --look-at 0.4,1.4,0 --bounces 1 --directions 40 --rays 4 --json";
    let answer = bench.json(&format!("glare room.obj {view}"));
    assert_keys(
        &answer,
        &["ev_lux", "ev_error_percent", "dgp", "dgp_error", "is_valid", "sources", "threshold_cd_m2"],
    );
    assert!(number(&answer, "/ev_lux") > 0.0 && (0.0..=1.0).contains(&number(&answer, "/dgp")));
    assert_eq!(number(&answer, "/threshold_cd_m2"), 2000.0);
    let relative = bench.json(&format!("glare room.obj {view} --threshold 5x"));
    let ratio = number(&relative, "/threshold_cd_m2") / number(&relative, "/mean_luminance");
    assert!((ratio / 5.0 - 1.0).abs() < 1e-4, "{ratio}");
    let output = bench.run("glare room.obj --threshold -5x");
    assert_eq!(output.status.code(), Some(2));
}

const DAY: &str = "--sun-place 52.52,13.4 --sun-time 2026-06-21T12:00[Europe/Berlin]";

#[test]
fn hours_of_sun_are_counted_for_the_day_of_the_given_time() {
    let bench = Bench::new();
    let plane = "measure room.obj --eye 0,1.6,3 --look-at 0,1.6,0 --grid 2 --sun-hours --json --csv sun.csv";
    let answer = bench.json(&format!("{plane} {DAY}"));
    assert_eq!(answer["quantity"], "sun-hours");
    assert!((0.0..=24.0).contains(&number(&answer, "/mean_hours")));
    let table = std::fs::read_to_string(bench.path("sun.csv")).unwrap();
    assert!(table.starts_with("x_m,y_m,z_m,hours,standard_error_hours\n"));
    let output = bench.run(plane);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("--sun-place"), "{}", stderr(&output));
}

#[test]
fn a_day_is_swept_into_pictures_and_a_table() {
    let bench = Bench::new();
    let sweep = "sun room.obj --size 24x16 --samples 1 --bounces 0 --out day --json";
    let answer = bench.json(&format!("{sweep} --hours 9..10/0.5 {DAY}"));
    assert_eq!(answer["pictures"].as_array().unwrap().len(), 3);
    for file in ["sun_2026-06-21_0900.png", "sun_2026-06-21_0930.png", "sun_2026-06-21_1000.png"] {
        assert!(bench.path(&format!("day/{file}")).exists(), "{file}");
    }
    let heights = [0, 1, 2].map(|i| number(&answer, &format!("/pictures/{i}/height_deg")));
    assert!(heights[0] < heights[1] && heights[1] < heights[2], "the morning sun rises: {heights:?}");
    assert_eq!(std::fs::read_to_string(bench.path("day/sun.csv")).unwrap().lines().count(), 4);
    let year = bench.json(&format!("{sweep} --year {}", DAY.replace("06-21", "01-31")));
    let dates: Vec<&str> =
        year["pictures"].as_array().unwrap().iter().map(|p| p["date"].as_str().unwrap()).collect();
    assert_eq!((dates.len(), dates[1]), (12, "2026-02-28"), "a day that a month lacks is its last");
    for (flags, part) in [("", "--sun-place"), ("--hours 9", "FROM..TO")] {
        let output = bench.run(&format!("{sweep} {flags}"));
        assert_eq!(output.status.code(), Some(2), "{flags}");
        assert!(stderr(&output).contains(part), "{flags}: {}", stderr(&output));
    }
}

#[test]
fn faults_have_one_clear_line() {
    let bench = Bench::new();
    std::fs::write(bench.path("bad.txt"), "0 1 0 0 1 0\n0 1 0 0 0 0\n").unwrap();
    std::fs::write(bench.path("none.txt"), "# nothing\n").unwrap();
    for (flags, code, part) in [
        ("--plane height=0.85,depth=1", 2, "no 'depth'"),
        ("--plane height=0.85,x=0..1", 2, "needs both"),
        ("--grid 0", 2, "metres"),
        ("--points missing.txt", 1, "missing.txt"),
        ("--points bad.txt", 1, "bad.txt, line 2"),
        ("--points none.txt", 1, "no points"),
        ("--eye 50,1,0 --look-at 0,1,0", 1, "no floor"),
        ("--eye 0,1,0 --look-at 0,1,1 --grid 0.001", 1, "more than 100000 points"),
        ("--eye 0,1,0 --look-at 0,1,1 --plane height=4", 1, "no point of the plane is free"),
        ("--error 50 --csv missing/lux.csv", 1, "missing"),
    ] {
        let output = bench.run(&format!("measure room.obj {flags}"));
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{flags}: {said}");
        assert!(said.contains(part), "{flags}: {said}");
        assert!(!bench.path("lux.csv").exists());
    }
}
