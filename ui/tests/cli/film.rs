//! Films: what the command writes, resumes and refuses, and what stays when it is stopped.

use super::{Bench, assert_keys, stderr};
use crate::boxes::Boxes;
use image::AnimationDecoder;
use image::codecs::gif::GifDecoder;
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A film of six small frames.
const FILM: &str = "film room.obj --path walks.json#short --size 64x48 --samples 1 --antialias 1 --json";

fn boxes(bench: &Bench, name: &str) -> Boxes {
    Boxes::read(&std::fs::read(bench.path(name)).unwrap())
}

/// Exit code and messages of a run.
fn outcome(output: &Output) -> (Option<i32>, String) {
    (output.status.code(), stderr(output))
}

#[test]
fn a_film_has_the_frames_of_the_path() {
    let bench = Bench::new();
    let answer = bench.json(&format!("{FILM} -o walk.mp4"));
    let wanted =
        ["film", "frames", "frames_wanted", "frames_found", "is_complete", "fps", "size", "bytes", "secs"];
    assert_keys(&answer, &wanted);
    let [frames, complete, fps] = ["frames", "is_complete", "fps"].map(|key| answer[key].clone());
    assert_eq!([frames, complete, fps], [json!(6), json!(true), json!(30)]);
    let film = boxes(&bench, "walk.mp4");
    assert_eq!((film.size, film.frames(), film.secs(), film.keys), ([64, 48], 6, 0.2, vec![1]));
    assert!(bench.names("").iter().all(|name| !name.starts_with('.')), "nothing half-written is left");
    // Twice as fast, the same time has twice the frames; and one is enough for a film.
    assert_eq!(bench.json(&format!("{FILM} -o fast.mp4 --fps 60"))["frames"], json!(11));
    let one = bench.json(&format!(
        "{} -o one.mp4 --frames 1 --heatmap beside",
        FILM.replace("--antialias 1", "--antialias 4")
    ));
    assert_eq!((&one["frames"], &one["size"]), (&json!(1), &json!([128, 48])));
    assert_eq!(boxes(&bench, "one.mp4").size, [128, 48]);
}

#[test]
fn an_animated_picture_has_all_frames() {
    let bench = Bench::new();
    // Odd sizes are possible here.
    let line = format!("{FILM} -o walk.gif --fps 10 --heatmap over").replace("64x48", "33x25");
    let answer = bench.json(&line);
    let file = std::fs::File::open(bench.path("walk.gif")).unwrap();
    let decoder = GifDecoder::new(std::io::BufReader::new(file)).unwrap();
    let frames = decoder.into_frames().collect_frames().unwrap();
    assert_eq!(answer["frames"], json!(frames.len()));
    assert_eq!(frames[0].buffer().dimensions(), (33, 25));
    assert_eq!(frames[0].delay().numer_denom_ms(), (100, 1));
    let dark = frames[0].buffer().pixels().filter(|pixel| pixel.0[..3].iter().all(|c| *c < 8)).count();
    assert!(dark < 33 * 25 / 2, "the picture shows the room: {dark}");
}

#[test]
fn the_same_film_has_the_same_bits() {
    let bench = Bench::new();
    bench.json(&format!("{FILM} -o a.mp4 --threads 1"));
    bench.json(&format!("{FILM} -o b.mp4 --threads 3"));
    assert!(std::fs::read(bench.path("a.mp4")).unwrap() == std::fs::read(bench.path("b.mp4")).unwrap());
}

#[test]
fn pictures_that_are_there_are_not_rendered_again() {
    let bench = Bench::new();
    let line = format!("{FILM} --pictures all -o walk.mp4");
    bench.json(&line);
    let picture = |n: u32| bench.path(&format!("all/frame_{n:04}.png"));
    let all: Vec<Vec<u8>> = (0..6).map(|n| std::fs::read(picture(n)).unwrap()).collect();
    let film = std::fs::read(bench.path("walk.mp4")).unwrap();
    assert_eq!(bench.names("all").len(), 7, "six pictures and their description");
    let again = bench.json(&line);
    assert_eq!(again["frames_found"], json!(6));
    assert!(std::fs::read(bench.path("walk.mp4")).unwrap() == film, "it is the same film");
    // Holes in the middle and at the end are filled, and the frames stay in order.
    [1, 2, 5].into_iter().for_each(|n| std::fs::remove_file(picture(n)).unwrap());
    let filled = bench.json(&line);
    assert_eq!((&filled["frames_found"], &filled["frames"]), (&json!(3), &json!(6)));
    assert!([0, 3, 4].iter().all(|n| std::fs::read(picture(*n)).unwrap() == all[*n as usize]));
    // Pictures of another film are neither used nor changed.
    for other in ["--samples 2", "--frames 7", "--seed 3", "--exposure 2", "--mode full", "--heatmap over"] {
        let output = bench.run(&format!("{} {other}", line.replace("--samples 1 ", "")));
        let (code, errors) = outcome(&output);
        assert!(code == Some(1) && errors.contains("another film"), "{other}: {errors}");
    }
    assert_eq!(std::fs::read(picture(0)).unwrap(), all[0]);
    std::fs::write(picture(4), b"no picture").unwrap();
    let (code, errors) = outcome(&bench.run(&line));
    assert!(code == Some(1) && errors.contains("frame_0004.png") && errors.contains("delete it"), "{errors}");
    assert!(errors.contains("the first 4 of 6 frames"), "{errors}");
}

#[test]
fn bad_input_ends_in_one_line_and_without_a_file() {
    let bench = Bench::new();
    let before = bench.names("");
    for (line, code, words) in [
        ("--size 65x48 -o a.mp4", 2, "64x48 is"),
        ("--size 8x8 -o a.mp4", 2, "16x16 is"),
        ("--size 16000x16000 -o a.mp4", 2, "8704x8704 is"),
        ("--size 8000x4000 -o a.mp4", 2, "or use fewer rays"),
        ("-o a.avi", 2, "must end in .mp4 or .gif"),
        ("-o a.mp4 --antialias 3", 2, "1, 4, 9 or 16"),
        ("-o a.mp4 --fps 0", 2, "--fps"),
        ("-o a.mp4 --quality fine", 2, "small, good, best"),
        ("-o none/a.mp4", 1, "none/a.mp4"),
        ("-o a.mp4 --path walks.json#long", 1, "short"),
        ("-o a.mp4 --path none.json", 1, "none.json"),
    ] {
        let whole = match line.contains("--path") {
            true => format!("film room.obj --size 64x48 {line}"),
            false => format!("film room.obj --path walks.json#short {line}"),
        };
        let (found, errors) = outcome(&bench.run(&whole));
        assert_eq!(found, Some(code), "{line}: {errors}");
        assert!(errors.contains(words), "{line}: {errors}");
    }
    std::fs::write(bench.path("file"), b"a file").unwrap();
    let (code, errors) = outcome(&bench.run(&format!("{FILM} -o a.mp4 --pictures file")));
    assert!(code == Some(1) && errors.contains("cannot create the folder file"), "{errors}");
    std::fs::remove_file(bench.path("file")).unwrap();
    let cache = |name: &String| name == "cache";
    assert_eq!(bench.names("").into_iter().filter(|name| !cache(name)).collect::<Vec<_>>(), before);
}

/// A command of a shell in the folder; `film` stands for the program and its command.
#[cfg(unix)]
fn shell(bench: &Bench, line: &str) -> Command {
    let mut command = Command::new("sh");
    let line = line.replace("film ", &format!("exec '{}' film ", env!("CARGO_BIN_EXE_afterimage")));
    command.args(["-c", &line]).current_dir(bench.dir.path());
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env("XDG_CACHE_HOME", bench.path("cache"));
    command
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_keeps_what_was_complete() {
    let bench = Bench::new();
    std::os::unix::fs::symlink("/dev/full", bench.path("full.mp4")).unwrap();
    let (code, errors) = outcome(&bench.run(&format!("{FILM} -o full.mp4")));
    assert!(code == Some(1) && errors.contains("No space left"), "{errors}");
    // A limit of the size of files stands for a full disk. Each second frame is a key frame.
    let film = format!("{FILM} --fps 1 --frames 24 --quality best -o walk.mp4").replace("#short", "'#short'");
    let output = shell(&bench, &format!("trap '' XFSZ; ulimit -f 16; {film}")).output().unwrap();
    let (code, errors) = outcome(&output);
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let frames = answer["frames"].as_u64().unwrap();
    assert!(code == Some(1) && errors.contains("File too large"), "{errors}");
    assert!(errors.contains(&format!("the first {frames} of 24 frames")), "{errors}");
    assert_eq!(boxes(&bench, "walk.mp4").frames() as u64, frames);
    assert!((2..24).contains(&frames) && frames.is_multiple_of(2), "{frames}");
    assert!(bench.names("").iter().all(|name| !name.starts_with('.')), "nothing half-written is left");
}

#[test]
#[cfg(unix)]
fn an_interrupted_film_keeps_its_frames_and_is_resumed() {
    let bench = Bench::new();
    let film = format!("{FILM} --frames 4000 --pictures all -o walk.mp4").replace("#short", "'#short'");
    let mut command = shell(&bench, &film);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let started = Instant::now();
    while !bench.path("all/frame_0003.png").exists() {
        assert!(started.elapsed() < Duration::from_secs(240), "no fourth picture");
        std::thread::yield_now();
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    let (code, errors) = outcome(&output);
    assert_eq!(code, Some(130), "{errors}");
    let frames = boxes(&bench, "walk.mp4").frames();
    assert!(frames >= 4 && errors.contains(&format!("the first {frames} of 4000 frames")), "{errors}");
    let pictures = bench
        .names("all")
        .iter()
        .filter(|name| Path::new(name).extension().is_some_and(|e| e == "png"))
        .count();
    assert_eq!(pictures, frames, "each picture is in the film");
}
