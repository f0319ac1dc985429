//! `afterimage tour-export`: the views of a scene as panoramas in one HTML file that needs nothing
//! else: no network, no library, no server.

mod page;
mod plan;
mod session_views;

use super::flags::Flags;
use super::scene::{Loaded, load};
use super::{failure::Failure, interrupt, output, progress::SharedProgress};
use crate::picture::panorama::{OtherProjection, PanoramaJob, looked_up_points};
use afterimage::Mode;
use afterimage::raster::exposure::decimal;
use afterimage::raster::save::{Target, write_atomically};
use afterimage::render::aov::display_rows;
use afterimage::render::panorama::{Panorama, PanoramaBand};
use afterimage::scene::NamedView;
use anyhow::Context;
use clap::Args;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use page::{TourView, html};
use serde_json::json;
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Size of a panorama in pixels where none is given: the largest that every graphics card takes.
const DEFAULT_SIZE: [u32; 2] = [4096, 2048];

/// Largest width that browsers show on most graphics cards, pixels.
const MAX_WIDTH: u32 = 16384;

#[derive(Args, Clone, Debug)]
pub(crate) struct TourExportArgs {
    /// A model (.obj, .gltf, .glb) or builtin:NAME [default: the embedded gallery].
    pub(super) scene: Option<String>,
    /// Views to show, by name, of the scene and of the session next to the model.
    #[arg(long, value_name = "all|NAME,...", value_delimiter = ',', default_value = "all")]
    views: Vec<String>,
    /// File to write.
    #[arg(short, long, value_name = "FILE.html", value_parser = html_file)]
    output: PathBuf,
    /// Quality of the panoramas, which are JPEG pictures, from 1 to 100.
    #[arg(long, value_name = "N", default_value_t = 88, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
}

fn html_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let fits =
        path.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm"));
    if fits { Ok(path) } else { Err("the name must end in .html".to_owned()) }
}

pub(crate) fn run(args: &TourExportArgs, flags: &Flags) -> Result<(), Failure> {
    let start = Instant::now();
    let size = flags.given_size.unwrap_or(DEFAULT_SIZE);
    check(args, flags, size)?;
    let loaded = load(args.scene.as_deref(), flags)?;
    let flags = &Flags { given_size: Some(size), ..loaded.expose(flags)? };
    let views = chosen(args, &loaded)?;
    let mut pictures = Vec::new();
    let progress = SharedProgress::new("rendering");
    for (number, view) in views.iter().enumerate() {
        let note = |part: f64| progress.note((number as f64 + part) / views.len() as f64, &view.name);
        pictures.push(jpeg(&job(flags, &loaded, view), &loaded, args.quality, &note)?);
    }
    drop(progress);
    let shown: Vec<TourView> = views
        .iter()
        .zip(pictures)
        .map(|(view, jpeg)| TourView::new(view, jpeg, &views, &loaded.tracer))
        .collect();
    let page = html(&loaded.name, &shown)?;
    write_atomically(&args.output, page.as_bytes())?;
    loaded.say_bounds();
    answer(args, flags, &loaded, (&shown, page.len()), start);
    loaded.verdict(flags)
}

/// Checks the arguments before the scene is loaded.
fn check(args: &TourExportArgs, flags: &Flags, size: [u32; 2]) -> Result<(), Failure> {
    Panorama::check(size).map_err(|error| Failure::Usage(error.to_string()))?;
    if size[0] > MAX_WIDTH {
        let message =
            format!("browsers show no panoramas wider than {MAX_WIDTH} pixels; make --size smaller");
        return Err(Failure::Usage(message));
    }
    if flags.mode == Mode::Paper {
        let message =
            "mode paper reprojects pinhole pictures, which panoramas are not; use exact, fast or full";
        return Err(Failure::Usage(message.to_owned()));
    }
    Ok(Target::File(args.output.clone()).probe()?)
}

/// The views of the scene, and those of its session whose names are new, as far as they are wanted.
fn chosen(args: &TourExportArgs, loaded: &Loaded) -> Result<Vec<NamedView>, Failure> {
    let mut known = loaded.scene().views.clone();
    let model = Path::new(&loaded.name);
    let of_session =
        if loaded.name.starts_with("builtin:") { Vec::new() } else { session_views::beside(model) };
    for view in of_session {
        match known.iter_mut().find(|k| k.name == view.name) {
            Some(same) => *same = view,
            None => known.push(view),
        }
    }
    if args.views.iter().any(|name| name == "all") {
        return Ok(known);
    }
    let found =
        args.views.iter().map(|name| known.iter().find(|view| view.name == *name).cloned().ok_or(name));
    found.collect::<Result<Vec<_>, _>>().map_err(|name| {
        let names: Vec<&str> = known.iter().map(|view| view.name.as_str()).collect();
        Failure::Usage(format!("{} has no view '{name}'; it has: {}", loaded.name, names.join(", ")))
    })
}

fn job(flags: &Flags, loaded: &Loaded, view: &NamedView) -> PanoramaJob {
    PanoramaJob {
        projection: OtherProjection::Equirectangular,
        scene_name: loaded.name.clone(),
        camera: view.camera,
        size: flags.size(),
        settings: flags.render(),
        points: if flags.mode == Mode::Full { 1 } else { looked_up_points(flags.size()) },
        exposure_ev: flags.exposure_ev(),
        tone_map: flags.tone_map,
        document: None,
    }
}

/// Renders a panorama as the bytes of a JPEG file.
fn jpeg(
    job: &PanoramaJob,
    loaded: &Loaded,
    quality: u8,
    note: &(dyn Fn(f64) + Sync),
) -> Result<Vec<u8>, Failure> {
    let mut pixels = Vec::new();
    let stats =
        job.panorama(&loaded.tracer).render(&interrupt::is_cancelled, note, &mut |band: PanoramaBand| {
            pixels.extend(display_rows(&band.radiance, job.exposure_ev, job.tone_map));
            Ok::<(), Infallible>(())
        });
    if !stats.is_ok_and(|stats| stats.is_complete) {
        return Err(Failure::Interrupted);
    }
    let mut bytes = Vec::new();
    let [width, height] = job.size;
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode(bytemuck::cast_slice(&pixels), width, height, ExtendedColorType::Rgb8)
        .context("a panorama cannot be encoded as JPEG")?;
    Ok(bytes)
}

fn answer(
    args: &TourExportArgs,
    flags: &Flags,
    loaded: &Loaded,
    (views, bytes): (&[TourView], usize),
    start: Instant,
) {
    let secs = start.elapsed().as_secs_f64();
    let object = json!({
        "scene": loaded.name,
        "output": args.output.display().to_string(),
        "bytes": bytes,
        "mode": flags.mode.name(),
        "size": flags.size(),
        "samples": flags.trace().samples,
        "bounces": flags.trace().bounce_limit(),
        "exposure_ev": decimal(flags.exposure_ev()),
        "views": views.iter().map(TourView::record).collect::<Vec<_>>(),
        "secs": secs,
    });
    let [w, h] = flags.size();
    output::result(flags.json, &object, || {
        output::table(&[
            ("tour", format!("{}, {:.1} MB", args.output.display(), bytes as f64 / 1e6)),
            ("views", format!("{}, {w}x{h} each", views.len())),
            ("time", format!("{secs:.1} s")),
        ])
    });
}
