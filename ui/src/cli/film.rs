//! `afterimage film`: renders a camera path as a film.

use super::flags::{Flags, StoreChoice};
use super::scene::{Loaded, load};
use super::{failure::Failure, interrupt, output, progress::Progress, walk::read_path};
use crate::picture::PictureJob;
use crate::picture::film::{Film, FilmEvent, FilmFormat, FilmHeatmap, MadeFilm, RAYS, is_size_error};
use crate::window::input::playback::film_frames;
use afterimage::camera::CameraPath;
use afterimage::raster::{exposure::decimal, film::FilmQuality, save::Target};
use afterimage::{Camera, WalkthroughSettings, render::bands::Background};
use clap::{Args, builder::PossibleValuesParser, builder::TypedValueParser};
use glam::DVec3;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Args, Clone, Debug)]
pub(crate) struct FilmArgs {
    /// A model (.obj, .gltf, .glb) or builtin:NAME [default: the embedded gallery].
    pub(super) scene: Option<String>,
    /// Film to write: .mp4 (AV1), or .gif for pages that show no films.
    #[arg(short, long, value_name = "FILE", value_parser = mp4_or_gif)]
    output: PathBuf,
    /// A recorded camera path (JSON) [default: the scene's own]; FILE#NAME selects one of several.
    #[arg(long, value_name = "FILE[#NAME]")]
    path: Option<String>,
    /// Number of frames [default: the camera path's own time].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(CameraPath::MAX_FRAMES)))]
    frames: Option<u32>,
    /// Frames per second.
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=240))]
    fps: u32,
    /// How coarsely the film is coded.
    #[arg(long, value_name = "small|good|best", default_value = "good")]
    #[arg(value_parser = names(&FilmQuality::ALL), hide_possible_values = true)]
    quality: FilmQuality,
    /// Rays through different points of each pixel, for smooth edges.
    #[arg(long, value_name = "1|4|9|16", default_value_t = 4, value_parser = rays)]
    antialias: u32,
    /// Show the types of the pixels: blended with the picture, or in a right half of the film.
    #[arg(long, value_name = "off|over|beside", default_value = "off")]
    #[arg(value_parser = names(&FilmHeatmap::ALL), hide_possible_values = true)]
    heatmap: FilmHeatmap,
    /// Keep every frame as a numbered picture in this folder, and use those that an interrupted run
    /// of the same film left there.
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// Memory for references, MB.
    #[arg(long, value_name = "MB", default_value_t = 1024)]
    #[arg(value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    cache_mb: u64,
}

fn mp4_or_gif(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    format_of(&path).map(|_| path).ok_or_else(|| "the name must end in .mp4 or .gif".to_owned())
}

fn format_of(path: &Path) -> Option<FilmFormat> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "mp4" => Some(FilmFormat::Mp4),
        "gif" => Some(FilmFormat::Gif),
        _ => None,
    }
}

/// A parser of values by their names.
fn names<T: Copy + Send + Sync + 'static>(
    all: &'static [(T, &'static str)],
) -> impl TypedValueParser<Value = T> {
    let named = move |name: String| {
        all.iter().find(|(_, known)| *known == name).map(|(value, _)| *value).ok_or("unknown name")
    };
    PossibleValuesParser::new(all.iter().map(|(_, name)| *name)).try_map(named)
}

fn rays(text: &str) -> Result<u32, String> {
    let number = text.parse().ok().filter(|n| RAYS.contains(n));
    number.ok_or_else(|| "it must be 1, 4, 9 or 16".to_owned())
}

pub(crate) fn run(args: &FilmArgs, flags: &Flags) -> Result<(), Failure> {
    let recorded = args.path.as_deref().map(read_path).transpose()?;
    let target = Target::File(args.output.clone());
    film(args, flags, None, &CameraPath::default()).check().map_err(usage)?;
    target.probe()?;
    let loaded = load(args.scene.as_deref(), flags)?;
    let flags = &loaded.expose(flags)?;
    let walk = recorded.unwrap_or_else(|| loaded.scene().walk.clone());
    let film = film(args, flags, Some(&loaded), &walk);
    let start = Instant::now();
    let made = make(&film, target, &loaded)?.ok_or(Failure::Interrupted)?;
    let secs = start.elapsed().as_secs_f64();
    loaded.say_bounds();
    output::result(flags.json, &object(&film, &made, flags, &loaded, secs), || table(&film, &made, secs));
    conclude(made, &loaded, flags)
}

/// The film that the flags describe. Before the scene is loaded, it serves to check its size.
fn film(args: &FilmArgs, flags: &Flags, loaded: Option<&Loaded>, walk: &CameraPath) -> Film {
    let frames = args.frames.unwrap_or_else(|| film_frames(walk, args.fps));
    Film {
        job: PictureJob {
            outlines: None,
            scene_name: loaded.map_or_else(String::new, |loaded| loaded.name.clone()),
            camera: walk.camera(0, 1).unwrap_or(Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0)),
            size: flags.size(),
            settings: flags.render(),
            antialias: (args.antialias > 1).then_some(args.antialias),
            background: Background::Shown,
            exposure_ev: flags.exposure_ev(),
            tone_map: flags.tone_map,
            document: None,
        },
        walk: CameraPath { frames, ..walk.clone() },
        walkthrough: WalkthroughSettings {
            cache_bytes: usize::try_from(args.cache_mb << 20).unwrap_or(usize::MAX),
            ..WalkthroughSettings::default()
        },
        rate: args.fps,
        format: format_of(&args.output).unwrap_or_default(),
        quality: args.quality,
        heatmap: args.heatmap,
        pictures: args.pictures.clone(),
        store: flags.store(&StoreChoice::Off),
    }
}

fn usage(error: anyhow::Error) -> Failure {
    if is_size_error(&error) { Failure::Usage(error.to_string()) } else { error.into() }
}

fn make(film: &Film, target: Target, loaded: &Loaded) -> Result<Option<MadeFilm>, Failure> {
    let (mut progress, start) = (Progress::new(&loaded.name, film.walk.frames.into()), Instant::now());
    let made = film.make(&loaded.tracer, target, &interrupt::is_cancelled, &mut |event| match event {
        FilmEvent::Frames(done) => {
            let rate = f64::from(done) / start.elapsed().as_secs_f64();
            let note = if done < film.walk.frames { "" } else { ", encoding the last ones" };
            progress.at(done.into(), &format!("{rate:.1} frames/s{note}"));
        }
        FilmEvent::Ending(frames) if interrupt::is_cancelled() => {
            progress.say(&format!("completing the first {frames} frames; Ctrl+C again discards them"));
        }
        FilmEvent::Ending(_) => {}
        FilmEvent::StoreProblem(problem) => progress.say(&format!("warning: {problem}")),
    });
    Ok(made?)
}

fn object(film: &Film, made: &MadeFilm, flags: &Flags, loaded: &Loaded, secs: f64) -> Value {
    json!({
        "scene": loaded.name,
        "scene_hash": loaded.scene().hash,
        "film": made.path,
        "frames": made.frames,
        "frames_wanted": made.wanted,
        "frames_found": made.found,
        "is_complete": made.is_complete(),
        "fps": film.rate,
        "size": film.size(),
        "mode": flags.mode.name(),
        "samples": flags.trace().samples,
        "bounces": flags.trace().bounce_limit(),
        "seed": flags.seed,
        "antialias": film.job.antialias.unwrap_or(1),
        "exposure_ev": decimal(flags.exposure_ev()),
        "bytes": made.bytes,
        "secs": { "load": loaded.load_secs, "build": loaded.tracer.build_secs(), "film": secs },
    })
}

fn table(film: &Film, made: &MadeFilm, secs: f64) -> String {
    let rate = f64::from(made.frames) / secs;
    output::table(&[
        ("film", made.path.display().to_string()),
        ("frames", format!("{} of {}, {} in a second", made.frames, made.wanted, film.rate)),
        ("size", format!("{:.1} MB", made.bytes as f64 / 1e6)),
        ("time", format!("{secs:.1} s, {rate:.1} frames/s")),
    ])
}

/// A film that ends early is kept, and says so.
fn conclude(made: MadeFilm, loaded: &Loaded, flags: &Flags) -> Result<(), Failure> {
    if made.is_complete() {
        return loaded.verdict(flags);
    }
    let kept = made.text();
    match made.problem {
        Some(problem) => Err(Failure::Failed(format!("{problem}; {kept}"))),
        None => {
            output::say(&kept);
            Err(Failure::Interrupted)
        }
    }
}
