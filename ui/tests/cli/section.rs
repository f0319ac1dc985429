//! `--section` and `--outlines`: what they show, and what they say about faults.

use super::{Bench, number, stderr};

/// A crate of 1 m in the open, and one that stands open at one side.
const CRATES: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6
";

fn bench() -> Bench {
    let bench = Bench::new();
    std::fs::write(bench.path("crate.obj"), CRATES).unwrap();
    let open = CRATES.replace("\nf 2 3 7 6", "");
    std::fs::write(bench.path("open.obj"), open).unwrap();
    bench
}

const VIEW: &str = "--eye 4,0.6,0.5 --look-at 0,0.5,0.5 --fov-y 30 --size 48x48 --samples 1 --bounces 0";

fn picture(bench: &Bench, name: &str) -> image::RgbImage {
    image::open(bench.path(name)).unwrap().into_rgb8()
}

#[test]
fn a_section_is_seen_in_every_mode_but_paper_which_refuses_it() {
    let bench = bench();
    for mode in ["full", "exact", "fast"] {
        bench.json(&format!("render crate.obj {VIEW} --mode {mode} --section x=0.5 -o {mode}.png --json"));
        let cap = *picture(&bench, &format!("{mode}.png")).get_pixel(24, 24);
        assert!(cap.0[0] == cap.0[1] && cap.0[1] == cap.0[2], "{mode}: {cap:?}");
        // A cap has the same colour at any exposure.
        let line =
            format!("render crate.obj {VIEW} --mode {mode} --section x=0.5 --exposure 3 -o b.png --json");
        bench.json(&line);
        assert_eq!(*picture(&bench, "b.png").get_pixel(24, 24), cap, "{mode}");
    }
    let refused = bench.run(&format!("render crate.obj {VIEW} --mode paper --section x=0.5 -o p.png"));
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("mode paper"), "{}", stderr(&refused));
    assert!(!bench.path("p.png").exists());
}

#[test]
fn inspect_counts_the_closed_solids_of_a_section() {
    let bench = bench();
    let answer =
        bench.json("inspect crate.obj --section x=0.5,keep=high --section box=-9..9,-9..0.5,-9..9 --json");
    assert_eq!(number(&answer, "/section/closed_solids"), 1.0);
    assert_eq!(answer["section"]["planes"].as_array().unwrap().len(), 7);
    let open = bench.run("inspect open.obj --section x=0.5");
    assert!(stderr(&open).contains("no closed solids"), "{}", stderr(&open));
}

/// One clear line each, and no picture.
#[test]
fn sections_that_show_nothing_are_refused() {
    let bench = bench();
    for (section, code, said) in [
        ("x=7", 1, "x=7 lies outside the model, which reaches from x=0.00 to x=1.00"),
        ("box=2..3,0..1,0..1", 1, "leave nothing of the model"),
        ("box=-2..3,-1..4,-1..4", 1, "cut nothing off"),
        ("x=0.5,keep=left", 2, "neither keep=low nor keep=high"),
        ("w=1", 2, "a section is"),
        ("y=up", 2, "'up' is no number of metres"),
        ("box=0..1,0..1", 2, "a box has three ranges"),
        ("box=1..0,0..1,0..1", 2, "does not ascend"),
        ("z=0.02,keep=low", 1, "leaves nothing of what the camera sees"),
    ] {
        // Looks at the far corner of the crate alone.
        let view = "--eye 4,0.6,0.9 --look-at 0,0.5,0.9 --fov-y 10 --size 16x16 --samples 1 --bounces 0";
        let output = bench.run(&format!("render crate.obj {view} --section {section} -o none.png"));
        assert_eq!(output.status.code(), Some(code), "{section}: {}", stderr(&output));
        assert!(stderr(&output).contains(said), "{section}: {}", stderr(&output));
        assert!(!bench.path("none.png").exists(), "{section}");
    }
}

/// A tour sees the section in every frame.
#[test]
fn a_tour_keeps_its_section() {
    let bench = Bench::new();
    let line = "tour room.obj --path walks.json#short --frames 2 --size 32x24 --samples 1 --bounces 0 --out t --pictures --json";
    bench.json(line);
    let whole = picture(&bench, "t/images/frame_0001.png");
    bench.json(&line.replace("--json", "--section z=-1 --json"));
    assert_ne!(picture(&bench, "t/images/frame_0001.png"), whole);
}

/// The edges of the crate are black, its faces are as without lines.
#[test]
fn outlines_darken_edges_and_nothing_else() {
    let bench = bench();
    let view = "--eye 3,2,2.5 --look-at 0.5,0.5,0.5 --fov-y 40 --size 96x96 --samples 1 --bounces 0";
    bench.json(&format!("render crate.obj {view} -o plain.png --json"));
    bench.json(&format!("render crate.obj {view} --outlines 2 -o lines.png --json"));
    bench.json(&format!("render crate.obj {view} --show clay --outlines -o clay.png --json"));
    let [plain, lines] = ["plain.png", "lines.png"].map(|name| picture(&bench, name));
    let changed = plain.pixels().zip(lines.pixels()).filter(|(a, b)| a != b).count();
    let darker = plain.pixels().zip(lines.pixels()).all(|(a, b)| (0..3).all(|c| b.0[c] <= a.0[c]));
    assert!(darker && changed > 300 && changed < 96 * 96 / 5, "{changed}");
    let black = |picture: &image::RgbImage| picture.pixels().filter(|p| p.0 == [0; 3]).count();
    assert!(black(&lines) > black(&plain) + 150, "{} {}", black(&lines), black(&plain));
    let refused = bench.run(&format!("render crate.obj {view} --show illuminance --outlines -o no.png"));
    assert!(stderr(&refused).contains("--outlines is for"), "{}", stderr(&refused));
}
