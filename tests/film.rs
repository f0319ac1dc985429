//! Films: the colours are exact, the boxes of the file agree with each other, and what was complete
//! stays. Where ffmpeg is installed, it plays them.

mod boxes;

use afterimage::raster::film::{FilmFile, FilmQuality, FilmSettings, Yuv420};
use afterimage::raster::metrics::flip;
use afterimage::raster::save::Target;
use boxes::Boxes;
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Twin of the conversion, in fractions: the value is `numerator / denominator` of a step, and the
/// sample is the nearest integer, half up. Source: ITU-R BT.709-6, items 3.2 to 3.5.
fn nearest(numerator: i128, denominator: i128, offset: i128) -> u8 {
    // The nearest integer n of x is the one with n - 1/2 <= x < n + 1/2.
    let near = |n: &i128| {
        let twice = 2 * (numerator - (n - offset) * denominator);
        -denominator <= twice && twice < denominator
    };
    (0..=255).find(near).unwrap() as u8
}

/// Luma and differences of a colour, which is the sum of `count` colours of 8 bits.
fn slow(sum: [i128; 3], count: i128) -> [u8; 3] {
    let [red, green, blue] = sum;
    // E'Y = 0.2126 E'R + 0.7152 E'G + 0.0722 E'B; E'CB = (E'B - E'Y) / 1.8556; E'CR = (E'R - E'Y) /
    // 1.5748. DY = 219 E'Y + 16; DC = 224 E'C + 128. All times 10,000.
    let luma = 2126 * red + 7152 * green + 722 * blue;
    let white = 255 * count;
    [
        nearest(219 * luma, 10_000 * white, 16),
        nearest(224 * (10_000 * blue - luma), 18_556 * white, 128),
        nearest(224 * (10_000 * red - luma), 15_748 * white, 128),
    ]
}

fn sum_around(picture: &[[u8; 3]], width: usize, column: usize, row: usize) -> [i128; 3] {
    let mut sum = [0; 3];
    for (dx, weight) in [(-1_i32, 1), (0, 2), (1, 1)] {
        for dy in 0..2 {
            let x = (2 * column as i32 + dx).max(0) as usize;
            for (sum, channel) in sum.iter_mut().zip(picture[(2 * row + dy) * width + x]) {
                *sum += weight * i128::from(channel);
            }
        }
    }
    sum
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn luma_and_chroma_are_the_nearest_integers(
        (half, colors) in (1_usize..9).prop_flat_map(|half| {
            (Just(half), prop::collection::vec(any::<[u8; 3]>(), 2 * half * 6))
        })
    ) {
        let width = 2 * half;
        let yuv = Yuv420::of_srgb([width as u32, 6], &colors);
        for (luma, color) in yuv.luma.iter().zip(&colors) {
            prop_assert_eq!(*luma, slow(color.map(i128::from), 1)[0]);
        }
        for row in 0..3 {
            for column in 0..half {
                let [_, blue, red] = slow(sum_around(&colors, width, column, row), 8);
                prop_assert_eq!(yuv.blue[row * half + column], blue);
                prop_assert_eq!(yuv.red[row * half + column], red);
            }
        }
    }
}

#[test]
fn greys_have_no_colour_and_primaries_reach_the_ends() {
    for grey in 0..=255 {
        let yuv = Yuv420::of_srgb([2, 2], &[[grey; 3]; 4]);
        assert_eq!((yuv.blue[0], yuv.red[0]), (128, 128), "{grey}");
    }
    let of = |color| {
        let yuv = Yuv420::of_srgb([2, 2], &[color; 4]);
        [yuv.luma[0], yuv.blue[0], yuv.red[0]]
    };
    assert_eq!(of([0; 3]), [16, 128, 128]);
    assert_eq!(of([255; 3]), [235, 128, 128]);
    // The colour bars of BT.709, as everybody has them.
    assert_eq!(of([255, 0, 0]), [63, 102, 240]);
    assert_eq!(of([0, 255, 0]), [173, 42, 26]);
    assert_eq!(of([0, 0, 255]), [32, 240, 118]);
}

const SIZE: [u32; 2] = [96, 64];

fn settings(rate: u32, threads: usize) -> FilmSettings {
    FilmSettings { size: SIZE, rate, quality: FilmQuality::Good, threads }
}

/// A picture with smooth and hard edges that moves.
fn picture(size: [u32; 2], frame: u32) -> Vec<[u8; 3]> {
    let pixel = |i: u32| {
        let (x, y) = (i % size[0] + frame, i / size[0]);
        let square = if (x / 24 + y / 24).is_multiple_of(2) { 60 } else { 0 };
        [(2 * x % 256) as u8, (3 * y % 190 + square) as u8, 120]
    };
    (0..size[0] * size[1]).map(pixel).collect()
}

fn film(path: &Path, settings: FilmSettings, frames: u32) -> u64 {
    let mut file = FilmFile::begin(Target::File(path.to_owned()), settings).unwrap();
    (0..frames).for_each(|frame| file.write(&picture(settings.size, frame)).unwrap());
    let film = file.finish().unwrap().unwrap();
    assert_eq!(film.frames, frames);
    film.bytes
}

fn names(folder: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn boxes_agree_with_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.mp4");
    // A key frame every two seconds: three groups, the last of them with one frame.
    let bytes = film(&path, settings(4, 2), 17);
    let file = std::fs::read(&path).unwrap();
    assert_eq!(file.len() as u64, bytes);
    let boxes = Boxes::read(&file);
    assert_eq!((boxes.size, boxes.frames(), boxes.keys.clone()), (SIZE, 17, vec![1, 9, 17]));
    assert_eq!(boxes.chunks.iter().map(|chunk| chunk.1).collect::<Vec<_>>(), [8, 8, 1]);
    assert_eq!(boxes.secs(), 17.0 / 4.0);
    assert_eq!(boxes.colour, *b"nclx\x00\x01\x00\x01\x00\x01\x00");
    // The samples fill the data, one after the other, and each chunk begins with a key frame.
    assert_eq!(boxes.chunks[0].0, boxes.data.start);
    let mut at = boxes.data.start;
    let mut sample = 0;
    for (offset, count) in &boxes.chunks {
        assert_eq!(*offset, at);
        assert!(boxes.keys.contains(&(sample as u32 + 1)));
        // The first part of a key frame is the sequence header that the decoder was configured with.
        let header = &boxes.sequence_header;
        assert_eq!(&file[at..at + header.len()], &header[..]);
        at += boxes.sizes[sample..sample + count].iter().sum::<u32>() as usize;
        sample += count;
    }
    assert_eq!(at, boxes.data.end);
    assert_eq!(names(folder.path()), [path]);
}

#[test]
fn one_frame_is_a_film_and_none_is_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.mp4");
    let none = FilmFile::begin(Target::File(path.clone()), settings(30, 1)).unwrap();
    assert!(none.finish().unwrap().is_none());
    drop(FilmFile::begin(Target::File(path.clone()), settings(30, 1)).unwrap());
    assert!(names(folder.path()).is_empty());
    film(&path, settings(30, 1), 1);
    let boxes = Boxes::read(&std::fs::read(&path).unwrap());
    assert_eq!((boxes.frames(), boxes.keys), (1, vec![1]));
}

#[test]
fn a_film_has_the_same_bits_at_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let films = [1, 2, 5].map(|threads| {
        let path = folder.path().join(format!("{threads}.mp4"));
        film(&path, settings(3, threads), 20);
        std::fs::read(path).unwrap()
    });
    assert!(films[0] == films[1] && films[1] == films[2]);
}

#[test]
fn sizes_that_cannot_be_encoded_are_refused_with_one_that_can() {
    for (size, words) in
        [([321, 240], "320x240 is"), ([320, 8], "320x16 is"), ([20_000, 2000], "8704x2000 is")]
    {
        let error = FilmSettings { size, ..settings(30, 1) }.check().unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    for size in [[16, 16], [18, 8704], [1280, 720]] {
        FilmSettings { size, ..settings(30, 1) }.check().unwrap();
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_an_error_of_the_system() {
    let mut file = FilmFile::begin(Target::File("/dev/full".into()), settings(30, 1)).unwrap();
    file.write(&picture(SIZE, 0)).unwrap();
    let error = file.finish().unwrap_err().to_string();
    assert!(error.contains("/dev/full") && error.contains("No space left"), "{error}");
}

/// Runs a program of ffmpeg and returns what it prints; `None` where it is not installed.
fn ffmpeg(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(["-v", "error"]).args(arguments).output().ok()?;
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    Some(String::from_utf8(output.stdout).unwrap())
}

#[test]
fn ffmpeg_reads_the_film_and_decodes_its_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.mp4");
    let size = [320, 180];
    film(&path, FilmSettings { size, ..settings(25, 2) }, 60);
    let name = path.to_str().unwrap();
    let entries = "stream=codec_name,profile,level,width,height,pix_fmt,color_range,color_space,\
                   color_transfer,color_primaries,chroma_location,r_frame_rate,avg_frame_rate,duration,\
                   nb_frames,nb_read_frames";
    let Some(found) = ffmpeg("ffprobe", &["-count_frames", "-show_entries", entries, name]) else {
        eprintln!("skipped: ffmpeg is not installed");
        return;
    };
    for line in [
        "codec_name=av1",
        "profile=Main",
        "level=0",
        "width=320",
        "height=180",
        "pix_fmt=yuv420p",
        "color_range=tv",
        "color_space=bt709",
        "color_transfer=bt709",
        "color_primaries=bt709",
        "chroma_location=left",
        "r_frame_rate=25/1",
        "avg_frame_rate=25/1",
        "duration=2.400000",
        "nb_frames=60",
        "nb_read_frames=60",
    ] {
        assert!(found.lines().any(|found| found == line), "{line} is not in {found}");
    }
    let pattern = folder.path().join("%d.rgb");
    let filter = "scale=flags=accurate_rnd+full_chroma_int:in_color_matrix=bt709";
    let raw = ["-i", name, "-vf", filter, "-f", "image2", "-c:v", "rawvideo", "-pix_fmt", "rgb24"];
    ffmpeg("ffmpeg", &[&raw[..], &[pattern.to_str().unwrap()]].concat()).unwrap();
    for frame in [0, 1, 30, 49, 50, 59] {
        let decoded = std::fs::read(folder.path().join(format!("{}.rgb", frame + 1))).unwrap();
        let shown = |bytes: &[u8]| {
            bytes
                .chunks(3)
                .map(|c| glam::Vec3::from([c[0], c[1], c[2]].map(|c| f32::from(c) / 255.0)))
                .collect::<Vec<_>>()
        };
        let truth = shown(picture(size, frame).as_flattened());
        let flip_mean = flip(&shown(&decoded), &truth, size).unwrap().mean;
        assert!(flip_mean <= 0.08, "frame {frame}: {flip_mean}");
    }
}
