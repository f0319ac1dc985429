//! `afterimage render`: one picture.

use super::failure::Failure;
use super::flags::Flags;
use super::pose::{camera, eye_and_target};
use super::scene::{Loaded, load};
use super::{interrupt, memory, output};
use crate::notes::{Made, notes};
use afterimage::camera::Camera;
use afterimage::raster::save::{Channel, save_exr, save_png};
use afterimage::reference::{ReferenceCache, ReferenceFrame};
use afterimage::render::aov::{Aov, display_picture, types_picture};
use afterimage::render::render_antialiased;
use afterimage::reproject::warp::MAX_REFERENCES;
use afterimage::trace::TraceSettings;
use afterimage::{Frame, Mode, Renderer, Tracer};
use clap::Args;
use glam::DVec3;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Args, Debug)]
pub(crate) struct RenderArgs {
    /// A model (.obj, .gltf, .glb) or builtin:NAME; the embedded gallery when absent.
    scene: Option<String>,
    /// The picture: .png (8 bits, display-referred) or .exr (linear, scene-referred).
    #[arg(short, long, value_name = "FILE", value_parser = png_or_exr)]
    output: PathBuf,
    /// Traces a reference image there first; may be repeated.
    #[arg(long = "reference", value_name = "EX,EY,EZ:LX,LY,LZ", value_parser = eye_and_target)]
    #[arg(allow_hyphen_values = true)]
    references: Vec<[DVec3; 2]>,
    /// Traces every pixel in full, with so many rays through different points of it: smooth edges.
    #[arg(long, value_name = "N", conflicts_with = "references")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=4096))]
    antialias: Option<u32>,
    /// Writes the type of every pixel: Type 1 #0072B2, Type 2 #F0E442, Type 3 #D55E00.
    #[arg(long, value_name = "FILE.png", value_parser = png)]
    types: Option<PathBuf>,
    /// Writes linear radiance beside the picture.
    #[arg(long, value_name = "FILE.exr", value_parser = exr)]
    linear: Option<PathBuf>,
    /// Layers added to the EXR: depth, normal, type, reference, primitive.
    #[arg(long, value_name = "LAYERS", value_delimiter = ',', value_parser = aov)]
    aov: Vec<Aov>,
}

pub(super) fn png_or_exr(text: &str) -> Result<PathBuf, String> {
    png(text).or_else(|_| exr(text)).map_err(|_| "the name must end in .png or .exr".to_owned())
}

fn png(text: &str) -> Result<PathBuf, String> {
    with_extension(text, "png")
}

fn exr(text: &str) -> Result<PathBuf, String> {
    with_extension(text, "exr")
}

fn with_extension(text: &str, extension: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let fits = path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    if fits { Ok(path) } else { Err(format!("the name must end in .{extension}")) }
}

fn aov(text: &str) -> Result<Aov, String> {
    Aov::ALL.into_iter().find(|a| a.name() == text).ok_or_else(|| {
        let names: Vec<&str> = Aov::ALL.iter().map(|a| a.name()).collect();
        format!("there are {}", names.join(", "))
    })
}

pub(crate) fn run(args: &RenderArgs, flags: &Flags) -> Result<(), Failure> {
    let mode = if args.antialias.is_some() { Mode::Full } else { flags.mode };
    let flags = &Flags { mode, ..flags.clone() };
    check(args, flags)?;
    let loaded = load(args.scene.as_deref(), flags)?;
    let camera = camera(flags, loaded.scene())?;
    let references = trace_references(args, flags, &loaded, camera.fov_y.to_degrees())?;
    let frame = &render(args, flags, &loaded.tracer, &camera, &references);
    // A picture that was stopped is kept too; its notes and the result say so.
    write_files(args, flags, &loaded, frame)?;
    let object = object(args, flags, &loaded, frame, &references);
    output::result(flags.json, &object, || table(args, frame, &references));
    if frame.stats.is_complete { loaded.verdict(flags) } else { Err(Failure::Interrupted) }
}

/// The picture, in the way its mode makes it.
fn render(
    args: &RenderArgs,
    flags: &Flags,
    tracer: &Tracer,
    camera: &Camera,
    references: &[Arc<ReferenceFrame>],
) -> Frame {
    let (size, settings, stop) = (flags.size(), flags.render(), interrupt::is_cancelled);
    if let Some(rays) = args.antialias {
        return render_antialiased(tracer, camera, size, &settings, rays, &stop);
    }
    let mut renderer = Renderer::default();
    if settings.mode.looks_up() {
        let mut cache = ReferenceCache::new(tracer.scene(), usize::MAX);
        for reference in references {
            cache.insert(Arc::clone(reference));
        }
        renderer.render_by_lookup(tracer, camera, size, &settings, &cache.lookup(tracer.epoch()), &stop);
    } else {
        let references: Vec<&ReferenceFrame> = references.iter().map(|r| &**r).collect();
        renderer.render(tracer, camera, size, &settings, &references, &stop);
    }
    renderer.into_frame()
}

/// What can be refused before the scene is loaded.
fn check(args: &RenderArgs, flags: &Flags) -> Result<(), Failure> {
    memory::check(flags.pixels(), args.references.len() as u64)?;
    if args.references.len() > MAX_REFERENCES {
        return Err(Failure::Usage(format!("at most {MAX_REFERENCES} references can be used at once")));
    }
    if !args.aov.is_empty() && !is_exr(&args.output) && args.linear.is_none() {
        return Err(Failure::Usage("--aov needs an EXR: -o FILE.exr or --linear FILE.exr".to_owned()));
    }
    for path in [Some(&args.output), args.types.as_ref(), args.linear.as_ref()].into_iter().flatten() {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|f| !f.is_dir()) {
            let (path, folder) = (path.display(), folder.display());
            return Err(Failure::Failed(format!("cannot write {path}: there is no folder {folder}")));
        }
    }
    Ok(())
}

fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"))
}

/// Each has a seed of its own, so that the noise of several is independent.
fn trace_references(
    args: &RenderArgs,
    flags: &Flags,
    loaded: &Loaded,
    fov_y: f64,
) -> Result<Vec<Arc<ReferenceFrame>>, Failure> {
    let trace = |(number, [eye, at]): (u64, &[DVec3; 2])| {
        let seed = flags.seed.wrapping_add(number << 32);
        let settings = TraceSettings { seed, ..flags.trace() };
        let camera = Camera::look_at(*eye, *at, fov_y);
        let stop = interrupt::is_cancelled;
        ReferenceFrame::trace(&loaded.tracer, &camera, flags.size(), &settings, &stop).map(Arc::new)
    };
    (1..).zip(&args.references).map(trace).collect::<Option<Vec<_>>>().ok_or(Failure::Interrupted)
}

fn write_files(args: &RenderArgs, flags: &Flags, loaded: &Loaded, frame: &Frame) -> Result<(), Failure> {
    let size = frame.view.size;
    if is_exr(&args.output) {
        save_exr(&args.output, size, channels(args, loaded, frame), &file_notes(flags, loaded, frame))?;
    } else {
        let picture = display_picture(frame, flags.exposure_ev(), flags.tone_map);
        save_png(&args.output, size, &picture, &file_notes(flags, loaded, frame))?;
    }
    if let Some(path) = &args.linear {
        save_exr(path, size, channels(args, loaded, frame), &file_notes(flags, loaded, frame))?;
    }
    if let Some(path) = &args.types {
        save_png(path, size, &types_picture(frame), &file_notes(flags, loaded, frame))?;
    }
    Ok(())
}

fn channels(args: &RenderArgs, loaded: &Loaded, frame: &Frame) -> Vec<Channel> {
    let mut channels = Channel::rgb(&frame.radiance);
    let mut chosen: Vec<Aov> = Vec::new();
    for aov in &args.aov {
        if !chosen.contains(aov) {
            chosen.push(*aov);
            channels.extend(aov.channels(frame, &loaded.tracer));
        }
    }
    channels
}

/// What the file says of itself.
pub(super) fn file_notes(flags: &Flags, loaded: &Loaded, frame: &Frame) -> Vec<(&'static str, String)> {
    notes(&Made {
        scene_name: &loaded.name,
        scene: loaded.scene(),
        camera: &frame.camera,
        settings: &flags.render(),
        is_complete: frame.stats.is_complete,
        refined: frame.stats.refined,
        exposure_ev: flags.exposure_ev(),
        tone_map: flags.tone_map,
    })
}

fn object(
    args: &RenderArgs,
    flags: &Flags,
    loaded: &Loaded,
    frame: &Frame,
    references: &[Arc<ReferenceFrame>],
) -> Value {
    let (stats, secs) = (&frame.stats, &frame.stats.secs);
    let mut rays = stats.rays;
    references.iter().for_each(|r| rays += r.rays);
    json!({
        "scene": loaded.name,
        "mode": flags.mode.name(),
        "size": flags.size(),
        "samples": flags.trace().samples,
        "antialias": args.antialias,
        "bounces": flags.trace().bounces,
        "seed": flags.seed,
        "threads": rayon::current_num_threads(),
        "is_complete": stats.is_complete,
        "types": stats.types.percentages(),
        "secs": {
            "load": loaded.load_secs,
            "build": loaded.tracer.build_secs(),
            "references": total_secs(references),
            "warp": secs.warp,
            "secondary": secs.secondary,
            "trace": secs.trace,
            "frame": secs.frame,
        },
        "rays": stats.rays,
        "rays_with_references": rays,
        "references": references.len(),
        "light_cuts": loaded.light_cuts(),
        "reference_bytes_per_pixel": ReferenceFrame::BYTES_PER_PIXEL,
    })
}

/// Not `sum`, which makes -0 of nothing.
fn total_secs(references: &[Arc<ReferenceFrame>]) -> f64 {
    references.iter().fold(0.0, |sum, r| sum + r.secs)
}

fn table(args: &RenderArgs, frame: &Frame, references: &[Arc<ReferenceFrame>]) -> String {
    let (types, secs) = (frame.stats.types.percentages(), &frame.stats.secs);
    let [w, h] = frame.view.size;
    let reference_secs = total_secs(references);
    output::table(&[
        ("picture", format!("{}, {w}x{h}", args.output.display())),
        ("Type 1", format!("{:.2} % reused", types.type1_percent)),
        ("Type 2", format!("{:.2} % mirror or glass", types.type2_percent)),
        ("Type 3", format!("{:.2} % traced", types.type3_percent)),
        ("frame", format!("{:.3} s", secs.frame)),
        ("references", format!("{} in {reference_secs:.3} s", references.len())),
        ("rays", format!("{}", frame.stats.rays.total())),
    ])
}
