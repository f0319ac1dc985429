//! Results of the commands: the keys of the contract, and sums that must hold.

use super::{Bench, assert_keys, assert_types, keys, number};
use afterimage::camera::{CameraKey, CameraPath};
use glam::DVec3;
use serde_json::json;

const POSE: &str = "--eye 0,1.6,3 --look-at 0.4,1.4,0";
const SMALL: &str = "--size 64x48 --samples 2 --bounces 0 --json";

fn pixels(path: &std::path::Path) -> Vec<[u8; 3]> {
    image::open(path).unwrap().to_rgb8().pixels().map(|p| p.0).collect()
}

#[test]
fn render_answers_with_the_contract_and_writes_every_file() {
    let bench = Bench::new();
    let line = format!(
        "render room.obj {POSE} {SMALL} -o a.png --types t.png --linear a.exr \
         --aov depth,normal,type,reference,primitive --reference 0,1.6,3.1:0.4,1.4,0 --reference -0.1,1.6,3:0.4,1.4,0"
    );
    let answer = bench.json(&line);
    assert_keys(
        &answer,
        &["scene", "mode", "size", "samples", "seed", "types", "secs", "rays", "references"],
    );
    assert_eq!(answer["size"], json!([64, 48]));
    assert_eq!((&answer["references"], &answer["mode"]), (&json!(2), &json!("exact")));
    assert!(number(&answer, "/reference_bytes_per_pixel") <= 24.0);
    let secs = ["load", "build", "references", "warp", "secondary", "trace", "frame"];
    assert_eq!(keys(&answer["secs"]), secs);
    assert!(number(&answer, "/secs/references") > 0.0);
    assert_eq!(keys(&answer["rays"]), ["primary", "shadow", "secondary", "indirect", "clamped", "bounded"]);
    assert_types(&answer["types"]);
    let colors = pixels(&bench.path("t.png"));
    let share = |c: [u8; 3]| 100.0 * colors.iter().filter(|p| **p == c).count() as f64 / colors.len() as f64;
    for (color, key) in [
        ([0x00, 0x72, 0xb2], "/types/type1_percent"),
        ([0xf0, 0xe4, 0x42], "/types/type2_percent"),
        ([0xd5, 0x5e, 0x00], "/types/type3_percent"),
    ] {
        assert!((share(color) - number(&answer, key)).abs() < 1e-9, "{key}");
        assert!(share(color) > 0.0, "{key}");
    }
    assert_eq!(bench.names(""), ["a.exr", "a.png", "room.mtl", "room.obj", "t.png", "walks.json"]);
}

#[test]
fn a_name_that_ends_in_jpg_makes_a_jpeg_close_to_the_png() {
    let bench = Bench::new();
    for (name, flags) in [("a.png", ""), ("a.jpg", ""), ("b.JPEG", "--jpeg-quality 20")] {
        bench.json(&format!("render room.obj {POSE} --size 64x48 --samples 4 --json -o {name} {flags}"));
    }
    let size = |name: &str| std::fs::metadata(bench.path(name)).unwrap().len();
    assert!(size("b.JPEG") < size("a.jpg"));
    let notes = afterimage::raster::load::read_notes(&bench.path("a.jpg")).unwrap();
    assert!(notes.iter().any(|(name, text)| name == "Scene" && text.starts_with("room.obj")), "{notes:?}");
    let db = |name: &str| bench.json(&format!("compare a.png {name} --json"))["psnr_db"].as_f64().unwrap();
    assert!(db("a.jpg") > 25.0 && db("a.jpg") > db("b.JPEG"), "{} {}", db("a.jpg"), db("b.JPEG"));
    bench.json(&format!("render room.obj {POSE} --size 16x12 --show clay --json -o clay.jpg"));
    let magic = std::fs::read(bench.path("clay.jpg")).unwrap();
    assert!(magic.starts_with(&[0xFF, 0xD8, 0xFF]));
    for line in
        ["-o c.jpg --no-background", "-o c.png --jpeg-quality 50", "-o c.jpg --jpeg-quality 0", "-o c.bmp"]
    {
        let output = bench.run(&format!("render room.obj {line}"));
        assert_eq!(output.status.code(), Some(2), "{line}");
    }
    assert!(!bench.path("c.jpg").exists());
}

#[test]
fn models_have_the_automatic_exposure_unless_one_is_given() {
    let bench = Bench::new();
    let ev = |flags: &str| {
        let answer = bench.json(&format!("render room.obj {POSE} --size 8x6 --json -o a.png {flags}"));
        number(&answer, "/exposure_ev")
    };
    let automatic = ev("");
    assert!(
        automatic != 0.0 && automatic == ev("--exposure auto --samples 3 --bounces 2 --seed 5 --threads 1")
    );
    assert_eq!(ev("--exposure=-1.5"), -1.5);
    std::fs::write(bench.path("room.afterimage.toml"), "[settings]\nexposure = 2\n").unwrap();
    assert_eq!((ev(""), ev("--exposure auto")), (2.0, automatic));
    let embedded = bench.json("render builtin:cornell --size 8x6 --samples 1 --json -o a.png");
    assert_eq!(number(&embedded, "/exposure_ev"), 0.0);
    let tour =
        bench.json(&format!("tour room.obj --path walks.json#short {SMALL} --exposure auto --out run"));
    assert_eq!(number(&tour, "/exposure_ev"), automatic);
}

#[test]
fn full_and_paper_without_references_are_one_picture() {
    let bench = Bench::new();
    for mode in ["full", "paper"] {
        let answer = bench.json(&format!("render room.obj {POSE} {SMALL} --mode {mode} -o {mode}.exr"));
        assert_eq!(number(&answer, "/types/type3_percent"), 100.0);
    }
    let answer = bench.json("compare full.exr paper.exr --json");
    assert_keys(&answer, &["psnr_db", "rel_mse", "ssim", "flip_mean", "flip_p95", "max_abs"]);
    assert_eq!((number(&answer, "/max_abs"), number(&answer, "/psnr_db")), (0.0, 999.0));
}

#[test]
fn compare_fails_below_the_given_psnr() {
    let bench = Bench::new();
    for seed in [1, 2] {
        bench.json(&format!("render room.obj {POSE} {SMALL} --seed {seed} -o {seed}.png"));
    }
    let answer = bench.json("compare 1.png 2.png --json");
    let psnr = number(&answer, "/psnr_db");
    assert!(psnr > 10.0 && psnr < 80.0, "{psnr}");
    assert!(bench.run(&format!("compare 1.png 2.png --fail-under-db {}", psnr - 0.1)).status.success());
    let output = bench.run(&format!("compare 1.png 2.png --json --fail-under-db {}", psnr + 0.1));
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn tour_records_its_walk() {
    let bench = Bench::new();
    let line = format!(
        "tour room.obj --path walks.json#short {SMALL} --mode paper --out run --pictures --measure --truth-samples 16"
    );
    let answer = bench.json(&line);
    assert_keys(
        &answer,
        &["scene", "mode", "size", "frames", "references_added", "reference_secs_total", "summary"],
    );
    let frames = answer["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 6);
    for frame in frames {
        let wanted = ["frame", "types", "references_used", "references_held", "frame_secs", "warp_secs"];
        assert_keys(frame, &wanted);
        assert_keys(frame, &["secondary_secs", "trace_secs"]);
        assert_types(&frame["types"]);
    }
    assert_eq!(number(&answer, "/frames/0/types/type3_percent"), 100.0);
    assert_keys(
        &answer["summary"],
        &[
            "frame_secs_median",
            "frame_secs_p99",
            "type3_percent_median",
            "type3_percent_max",
            "full_frame_secs_median",
            "speedup",
            "speedup_with_references",
            "equal_error_speedup",
            "exposure_ev",
            "psnr_db_median",
            "psnr_db_min",
            "full_psnr_db_median",
            "flip_mean_median",
            "full_flip_mean_median",
            "see_through_percent_median",
        ],
    );
    assert_eq!(bench.names("run"), ["frames.csv", "images", "references.csv", "summary.json"]);
    assert_eq!(bench.names("run/images").len(), 12);
    assert_eq!(bench.names("cache/afterimage/truth").len(), 6);
    let table = std::fs::read_to_string(bench.path("run/frames.csv")).unwrap();
    assert_eq!(table.lines().count(), 7);
    let summary = std::fs::read_to_string(bench.path("run/summary.json")).unwrap();
    assert_eq!(serde_json::from_str::<serde_json::Value>(&summary).unwrap(), answer);
}

#[test]
fn without_a_display_the_program_runs_the_tour() {
    let bench = Bench::new();
    let output = bench.run("room.obj --size 32x24 --samples 1 --json");
    assert!(output.status.success(), "{}", super::stderr(&output));
    let errors = super::stderr(&output);
    let about_display: Vec<&str> = errors.lines().filter(|l| l.contains("display")).collect();
    assert_eq!(about_display.len(), 1, "{errors}");
    let names = ["frames.csv", "images", "references.csv", "report.html", "summary.json"];
    assert_eq!(bench.names("afterimage-out"), names);
    let pictures = bench.names("afterimage-out/images");
    assert_eq!(pictures.len(), 24, "a dozen frames and their types: {pictures:?}");
    let page = std::fs::read_to_string(bench.path("afterimage-out/report.html")).unwrap();
    let links: Vec<&str> =
        ["href=\"", "src=\""].iter().flat_map(|attribute| page.split(attribute).skip(1)).collect();
    assert_eq!(links.len(), 4 * 12 + 3, "every picture is shown and linked");
    for link in links {
        let link = link.split('"').next().unwrap();
        assert!(bench.path("afterimage-out").join(link).exists(), "{link}");
    }
    assert!(!page.contains("<script") && errors.contains("report.html"), "{errors}");
}

#[test]
fn without_a_display_a_picture_runs_the_tour_of_its_scene() {
    let bench = Bench::new();
    assert!(bench.run("render room.obj --size 16x12 --samples 1 -o a.png").status.success());
    let output = bench.run("a.png --size 32x24 --samples 1 --json");
    assert!(output.status.success(), "{}", super::stderr(&output));
    assert!(bench.names("afterimage-out").contains(&"summary.json".to_owned()));
}

#[test]
fn throughput_answers_with_the_contract() {
    let bench = Bench::new();
    let answer =
        bench.json(&format!("experiment throughput room.obj {POSE} {SMALL} --dump-rays rays.bin --out run"));
    let wanted = ["triangles", "primary_mrays_per_sec", "shadow_mrays_per_sec", "diffuse_mrays_per_sec"];
    assert_keys(&answer, &wanted);
    let wanted =
        ["warp_ns_per_reference_pixel", "warp_over_memory_floor", "shade_us_per_pixel", "build_secs"];
    assert_keys(&answer, &wanted);
    assert!(number(&answer, "/bvh_bytes") > 0.0);
    assert_eq!(&std::fs::read(bench.path("rays.bin")).unwrap()[..8], b"RAYS0001");
    assert_keys(&answer, &["experiment", "scene", "scene_hash", "version", "size", "samples", "seed"]);
    for name in ["manifest.json", "records.csv", "summary.json", "report.html"] {
        assert!(bench.path("run").join(name).exists(), "{name}");
    }
}

#[test]
fn one_recorded_walk_serves_tours_and_experiments() {
    let bench = Bench::new();
    // The window saves a camera path in the same format.
    let at = |z: f64| CameraKey::new(DVec3::new(0.0, 1.6, z), DVec3::new(0.4, 1.4, z - 3.0));
    let walk = CameraPath { fov_y_deg: 60.0, frames: 4, keyframes: vec![at(3.0), at(1.0)] };
    std::fs::write(bench.path("mine.json"), serde_json::to_string_pretty(&walk).unwrap()).unwrap();
    for file in ["mine.json", "walks.json#short"] {
        let tour =
            bench.json(&format!("tour room.obj --path {file} --size 32x18 --samples 1 --out tour --json"));
        assert_eq!(tour["frames"].as_array().unwrap().len(), if file == "mine.json" { 4 } else { 6 });
        let line = "experiment placement room.obj --quick --size 32x18 --samples 1 --truth-samples 2 --frames 4 --json";
        let context = bench.json(&format!("{line} --path {file} --out lab-{}", file.replace('#', "-")));
        // Two modes, six camera paths, five rules; and each rule again with a store and after a
        // bake.
        assert_eq!((&context["cells"], &context["is_complete"]), (&json!(70), &json!(true)));
        let policies = context.pointer("/exact/policies").unwrap().as_array().unwrap();
        let none = policies.iter().find(|p| p["rule"] == "none" && p["walk"] == "slow").unwrap();
        assert_eq!(
            (number(none, "/references"), number(none, "/unseen_percent")),
            (0.0, number(none, "/type3_percent"))
        );
    }
}

#[test]
fn shards_of_an_experiment_are_joined_to_the_whole() {
    let bench = Bench::new();
    let line = "experiment table1 room.obj --quick --size 32x32 --samples 2 --truth-samples 8 --json";
    let whole = bench.json(&format!("{line} --out whole"));
    assert_eq!((&whole["cells"], &whole["is_complete"]), (&json!(7), &json!(true)));
    assert_eq!(whole["columns"].as_array().unwrap().len(), 7);
    for shard in ["0/2", "1/2"] {
        bench.json(&format!("{line} --out {} --shard {shard}", shard.replace('/', "of")));
    }
    let merged = bench.json("experiment merge 0of2 1of2 --out merged --json");
    assert_eq!(merged["is_complete"], json!(true));
    for column in 0..7 {
        for name in ["type1_percent", "psnr_db", "flip_mean"] {
            let pointer = format!("/columns/{column}/{name}");
            assert_eq!(number(&whole, &pointer), number(&merged, &pointer), "{pointer}");
        }
    }
    for name in [
        "manifest.json",
        "config.toml",
        "records.csv",
        "summary.json",
        "report.html",
        "images/paper-2-types.png",
    ] {
        assert!(bench.path("merged").join(name).exists(), "{name}");
    }
}

#[test]
fn doctor_always_succeeds() {
    let bench = Bench::new();
    let answer = bench.json("doctor --json --threads 2");
    assert_keys(&answer, &["version", "threads", "simd", "adapters", "display", "paths"]);
    assert_eq!(answer["threads"], json!(2));
}

#[test]
fn one_thread_and_many_make_the_same_file() {
    let bench = Bench::new();
    for threads in [1, 3] {
        bench.json(&format!(
            "render room.obj {POSE} {SMALL} --threads {threads} --reference 0,1.6,3.1:0.4,1.4,0 -o {threads}.png"
        ));
    }
    assert_eq!(std::fs::read(bench.path("1.png")).unwrap(), std::fs::read(bench.path("3.png")).unwrap());
}

#[test]
fn help_lists_the_keys_of_the_window() {
    let output = Bench::new().run("--help");
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    for words in ["fly forward", "E, PgUp", "Files and pictures:", "save a picture", "Exit codes"] {
        assert!(text.contains(words), "'{words}' is not in: {text}");
    }
}

#[test]
fn an_antialiased_picture_is_full_and_says_so() {
    let bench = Bench::new();
    let render = |flags: &str| bench.json(&format!("render room.obj {POSE} {SMALL} {flags}"));
    let answer = render("--antialias 4 -o a.exr");
    assert_eq!((&answer["mode"], &answer["antialias"]), (&json!("full"), &json!(4)));
    assert_eq!(number(&answer, "/rays/primary"), 64.0 * 48.0 * 4.0);
    render("--antialias 1 -o one.exr");
    render("--mode full -o full.exr");
    assert_eq!(number(&bench.json("compare one.exr full.exr --json"), "/max_abs"), 0.0);
    assert!(number(&bench.json("compare a.exr full.exr --json"), "/max_abs") > 0.0, "edges are smooth");
    render("--antialias 4 --no-background -o a.png");
    let picture = image::open(bench.path("a.png")).unwrap().to_rgba8();
    assert!(picture.pixels().all(|p| p.0[3] == 255), "the room is closed");
    let notes = afterimage::raster::load::read_notes(&bench.path("a.png")).unwrap();
    let settings = notes.iter().find(|(name, _)| name == "Settings").unwrap();
    assert!(settings.1.contains("--antialias 4 --no-background"), "{settings:?}");
}

#[test]
fn an_audited_tour_records_what_was_checked() {
    let bench = Bench::new();
    let line = "tour room.obj --path walks.json#short --size 64x48 --samples 2 --bounces 0 --mode exact --audit --json --out run";
    let audited = |answer: &serde_json::Value| {
        answer["frames"].as_array().unwrap().iter().filter(|f| f["audit"].is_object()).count()
    };
    assert!(audited(&bench.json(line)) > 0);
    assert_eq!(audited(&bench.json(&line.replace("--audit ", ""))), 0);
}

#[test]
fn a_picture_is_rendered_for_a_given_time() {
    let bench = Bench::new();
    for mode in ["exact", "full"] {
        let line =
            format!("render room.obj {POSE} --size 64x48 --mode {mode} --seconds 0.25 --json -o {mode}.png");
        let answer = bench.json(&line);
        assert!(number(&answer, "/samples") > 0.0 && number(&answer, "/passes") > 0.0, "{answer}");
        assert!(number(&answer, "/seconds_used") > 0.0 && answer["is_complete"] == json!(true), "{answer}");
        assert_eq!(pixels(&bench.path(&format!("{mode}.png"))).len(), 64 * 48);
        let notes = afterimage::raster::load::read_notes(&bench.path(&format!("{mode}.png"))).unwrap();
        let settings = notes.iter().find(|(name, _)| name == "Settings").unwrap();
        assert!(settings.1.ends_with(" --seconds 0.25"), "{settings:?}");
    }
    // More passes than one refinement has: the picture goes on getting better.
    let answer =
        bench.json("render room.obj --size 8x6 --samples 1 --mode full --seconds 0.25 --json -o a.png");
    assert!(number(&answer, "/passes") > 16.0 && number(&answer, "/estimated_psnr_db") > 0.0, "{answer}");
    for (flags, words) in [("--antialias 4", "cannot be used with"), ("--mode paper", "mode paper does not")]
    {
        let output = bench.run(&format!("render room.obj --seconds 1 {flags} -o b.png"));
        assert_eq!(output.status.code(), Some(2));
        assert!(super::stderr(&output).contains(words), "{}", super::stderr(&output));
    }
}

#[test]
fn a_view_at_rest_is_measured_without_a_folder() {
    let bench = Bench::new();
    let line = "experiment at-rest builtin:cornell --size 64x36 --seconds 0.1,0.05 --truth-samples 32 --full-samples 16";
    let answer = bench.json(&format!("{line} --json"));
    let checkpoints = answer["checkpoints"].as_array().unwrap();
    assert_eq!((checkpoints.len(), &answer["out"]), (2, &json!(null)));
    for checkpoint in checkpoints {
        assert_keys(checkpoint, &["seconds", "passes", "samples", "mse", "psnr_db", "flip_mean"]);
        assert!(number(checkpoint, "/mse").is_finite() && number(checkpoint, "/flip_mean") <= 1.0);
    }
    assert_eq!((number(&answer, "/checkpoints/0/seconds"), number(&answer, "/full/samples")), (0.05, 16.0));
    assert_eq!(bench.names(""), ["cache", "room.mtl", "room.obj", "walks.json"]);
    bench.json(&format!("{line} --json --out run"));
    for name in ["report.html", "plots/at-rest-flip-mean.svg", "images/at-0.1s.png"] {
        assert!(bench.path("run").join(name).exists(), "{name}");
    }
}
