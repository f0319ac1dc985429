//! `afterimage render`: renders one picture.

use super::jpeg::JpegArgs;
use super::panorama::PanoramaRun;
use super::pose::{camera, eye_and_target};
use super::projection::{Projection, ProjectionArgs};
use super::render_store::PictureStore;
use super::scene::{Loaded, load};
use super::section::SectionFlags;
use super::show::Shown;
use super::show_flags::{Show, ShowArgs};
use super::{
    failure::Failure,
    flags::{Flags, number_in},
    interrupt, output,
    progress::SharedProgress,
    section,
};
use crate::picture::restore::{is_jpeg, is_picture};
use crate::picture::{MadePicture, Output, PictureJob, Shows, TimedState, check_timed, memory};
use afterimage::{
    Mode, camera::Camera, raster::exposure::decimal, raster::save::Target, reference::ReferenceFrame,
    render::aov::Aov, render::bands::Background, render::outlines::MAX_OUTLINE_WIDTH,
    render::schedule::WINDOW_SAMPLES, trace::TraceSettings, warp::MAX_REFERENCES,
};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use glam::DVec3;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

#[derive(Args, Debug)]
pub(crate) struct RenderArgs {
    /// A model (.obj, .gltf, .glb) or builtin:NAME [default: the embedded gallery].
    pub(super) scene: Option<String>,
    /// Picture to write: .png or .jpg (8 bits, display-referred) or .exr (linear, scene-referred).
    #[arg(short, long, value_name = "FILE", value_parser = picture_file)]
    output: PathBuf,
    #[command(flatten)]
    jpeg: JpegArgs,
    /// Trace a reference image at this pose first; may be repeated.
    #[arg(long = "reference", value_name = "EX,EY,EZ:LX,LY,LZ", value_parser = eye_and_target)]
    #[arg(allow_hyphen_values = true)]
    references: Vec<[DVec3; 2]>,
    /// Trace every pixel in full, with N primary rays through different points of it, for smooth
    /// edges.
    #[arg(long, value_name = "N", conflicts_with = "references")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=4096))]
    antialias: Option<u32>,
    /// Render the best picture that this time allows, instead of one with a fixed number of
    /// samples; importing the scene is not counted, Ctrl+C keeps the picture so far, seconds.
    #[arg(long, value_name = "S", conflicts_with_all = ["antialias", "no_background", "references"])]
    #[arg(value_parser = number_in(0.001..=604_800.0, " seconds"))]
    seconds: Option<f64>,
    /// Omit the sky: a PNG is transparent where rays leave the scene, an EXR has a channel A.
    #[arg(long, conflicts_with = "references")]
    no_background: bool,
    /// Write the type of every pixel: Type 1 #0072B2, Type 2 #F0E442, Type 3 #D55E00.
    #[arg(long, value_name = "FILE.png", value_parser = png)]
    types: Option<PathBuf>,
    /// Write linear radiance in addition to the picture.
    #[arg(long, value_name = "FILE.exr", value_parser = exr)]
    linear: Option<PathBuf>,
    #[command(flatten)]
    shown: ShowArgs,
    /// Layers added to the EXR: depth, normal, type, reference, primitive.
    #[arg(long, value_name = "LAYERS", value_delimiter = ',')]
    #[arg(value_parser = aov_parser(), hide_possible_values = true)]
    aov: Vec<Aov>,
    /// Draw the edges of surfaces as dark lines, this many pixels wide.
    #[arg(long, value_name = "PIXELS", num_args = 0..=1, default_missing_value = "1")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_OUTLINE_WIDTH)))]
    outlines: Option<u32>,
    #[command(flatten)]
    section: SectionFlags,
    #[command(flatten)]
    projection: ProjectionArgs,
}

fn picture_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if is_picture(&path) { Ok(path) } else { Err("the name must end in .png, .jpg or .exr".to_owned()) }
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

fn aov_parser() -> impl TypedValueParser<Value = Aov> {
    let named = |name: String| Aov::ALL.into_iter().find(|aov| aov.name() == name).ok_or("unknown layer");
    PossibleValuesParser::new(Aov::ALL.map(|aov| aov.name())).try_map(named)
}

pub(crate) fn run(args: &RenderArgs, flags: &Flags) -> Result<(), Failure> {
    let is_full = args.antialias.is_some() || args.no_background;
    let flags = &Flags { mode: if is_full { Mode::Full } else { flags.mode }, ..flags.clone() };
    if args.projection.projection != Projection::Perspective {
        return run_panorama(args, flags);
    }
    if args.projection.width.is_some() {
        return Err(Failure::Usage("--width is for --projection orthographic".to_owned()));
    }
    check(args, flags)?;
    let loaded = load(args.scene.as_deref(), flags)?;
    let flags = &loaded.expose(flags)?;
    let camera = camera(flags, loaded.scene())?;
    let loaded = args.section.cut(loaded, &camera, flags)?;
    args.section.check_view(&loaded, &camera, flags.size())?;
    if args.shown.show != Show::Radiance {
        let shown = Shown { args: args.shown, outlines: args.outlines };
        return shown.run((&args.output, &camera), flags, &loaded);
    }
    let samples = flags.samples.or(args.seconds.map(|_| WINDOW_SAMPLES));
    let flags = &Flags { samples, ..flags.clone() };
    let job = job(args, flags, &loaded, camera);
    if let Some(seconds) = args.seconds {
        return run_timed(&job, args, flags, &loaded, seconds);
    }
    let mut store = PictureStore::open(flags, &loaded, &camera)?;
    let traced = trace_references(args, flags, &loaded, camera.fov_y.to_degrees())?;
    let references = store.exchange(traced, flags);
    // An interrupted picture is kept too; its metadata and the result say that it is incomplete.
    let progress = SharedProgress::new("rendering");
    let (stop, note) = (interrupt::is_cancelled, |part| progress.at(part));
    let made = job.make(&loaded.tracer, &references, &outputs(args), &stop, &note)?;
    drop(progress);
    store.finish();
    let mut object = object(args, flags, &loaded, &made, &references);
    output::extend(&mut object, store.record);
    output::extend(&mut object, section::record(&loaded));
    loaded.say_bounds();
    output::result(flags.json, &object, || table(args, flags, &made, &references));
    if made.stats.is_complete { loaded.verdict(flags) } else { Err(Failure::Interrupted) }
}

/// Renders a panorama.
fn run_panorama(args: &RenderArgs, flags: &Flags) -> Result<(), Failure> {
    let others = [
        ("--show", args.shown.show != Show::Radiance),
        ("--seconds", args.seconds.is_some()),
        ("--no-background", args.no_background),
        ("--types", args.types.is_some()),
        ("--aov", !args.aov.is_empty()),
        ("--reference", !args.references.is_empty()),
        ("--outlines", args.outlines.is_some()),
        ("--section", args.section.is_given()),
        ("--jpeg-quality", args.jpeg.is_given()),
    ];
    if let Some((flag, _)) = others.into_iter().find(|(_, is_given)| *is_given) {
        return Err(Failure::Usage(format!("{flag} is for --projection perspective")));
    }
    check_folders(args)?;
    check_shown(args)?;
    let (scene, antialias) = (args.scene.as_deref(), args.antialias);
    PanoramaRun {
        scene,
        output: &args.output,
        linear: args.linear.as_ref(),
        antialias,
        projection: &args.projection,
    }
    .run(flags)
}

/// Renders for a time.
fn run_timed(
    job: &PictureJob,
    args: &RenderArgs,
    flags: &Flags,
    loaded: &Loaded,
    seconds: f64,
) -> Result<(), Failure> {
    let progress = SharedProgress::new("rendering");
    let note = |state: &TimedState| progress.note((state.secs / seconds).min(1.0), &words(state));
    let (limit, stop) = (Duration::from_secs_f64(seconds), interrupt::is_cancelled);
    let (made, state) = job.make_timed(&loaded.tracer, &outputs(args), limit, &stop, &note)?;
    drop(progress);
    let mut object = object(args, flags, loaded, &made, &[]);
    output::extend(
        &mut object,
        json!({
            "samples": state.samples,
            "samples_per_pass": flags.trace().samples,
            "passes": state.passes,
            "seconds": seconds,
            "seconds_used": state.secs,
            "estimated_psnr_db": state.estimated_psnr_db,
        }),
    );
    output::extend(&mut object, section::record(loaded));
    loaded.say_bounds();
    output::result(flags.json, &object, || {
        table(args, flags, &made, &[]) + &output::table(&[("samples", words(&state))])
    });
    if interrupt::is_cancelled() { Err(Failure::Interrupted) } else { loaded.verdict(flags) }
}

/// Samples and estimated error so far.
fn words(state: &TimedState) -> String {
    let error = state.estimated_psnr_db.map(|db| format!(", about {db:.1} dB"));
    format!("{} per pixel{}", state.samples, error.unwrap_or_default())
}

fn job(args: &RenderArgs, flags: &Flags, loaded: &Loaded, camera: Camera) -> PictureJob {
    PictureJob {
        document: None,
        scene_name: loaded.name.clone(),
        camera,
        size: flags.size(),
        settings: flags.render(),
        antialias: args.antialias,
        background: if args.no_background { Background::LeftOut } else { Background::Shown },
        exposure_ev: flags.exposure_ev(),
        tone_map: flags.tone_map,
        outlines: args.outlines,
    }
}

fn outputs(args: &RenderArgs) -> Vec<Output> {
    let mut layers: Vec<Aov> = Vec::new();
    for layer in &args.aov {
        if !layers.contains(layer) {
            layers.push(*layer);
        }
    }
    let main = match &args.output {
        path if is_exr(path) => Shows::Linear(layers.clone()),
        path if is_jpeg(path) => Shows::Jpeg(args.jpeg.quality()),
        _ => Shows::Display,
    };
    let to = |path: &PathBuf, shows| Output { target: Target::File(path.clone()), shows };
    let linear = args.linear.as_ref().map(|path| to(path, Shows::Linear(layers)));
    let types = args.types.as_ref().map(|path| to(path, Shows::Types));
    [to(&args.output, main)].into_iter().chain(linear).chain(types).collect()
}

/// Checks what `--show` does not go with.
fn check_shown(args: &RenderArgs) -> Result<(), Failure> {
    args.shown.check()?;
    if args.shown.legend && is_exr(&args.output) {
        return Err(Failure::Usage("--legend is for pictures in PNG; an EXR has the numbers".to_owned()));
    }
    let others = [
        ("--outlines", args.outlines.is_some() && args.shown.show != Show::Clay),
        ("--antialias", args.antialias.is_some()),
        ("--seconds", args.seconds.is_some()),
        ("--no-background", args.no_background),
        ("--types", args.types.is_some()),
        ("--linear", args.linear.is_some()),
        ("--aov", !args.aov.is_empty()),
        ("--reference", !args.references.is_empty()),
        ("--jpeg-quality", args.jpeg.is_given()),
    ];
    match others.into_iter().find(|(_, is_given)| *is_given && args.shown.show != Show::Radiance) {
        Some(("--outlines", _)) => {
            Err(Failure::Usage("--outlines is for --show radiance and --show clay".to_owned()))
        }
        Some((flag, _)) => Err(Failure::Usage(format!("{flag} is for --show radiance"))),
        None => Ok(()),
    }
}

/// Checks the arguments before the scene is loaded.
fn check(args: &RenderArgs, flags: &Flags) -> Result<(), Failure> {
    check_shown(args)?;
    args.jpeg.check(&args.output, args.no_background)?;
    args.section.check_mode(flags.mode)?;
    if args.seconds.is_some() {
        check_timed(flags.pixels())?;
        if !flags.mode.refines() {
            let message = "--seconds refines the picture, which mode paper does not; use exact, fast or full";
            return Err(Failure::Usage(message.to_owned()));
        }
    } else if flags.mode.traces_all(args.references.is_empty()) {
        memory::check_banded(flags.pixels())?;
    } else {
        memory::check(flags.pixels(), args.references.len() as u64)?;
    }
    if args.references.len() > MAX_REFERENCES {
        return Err(Failure::Usage(format!("at most {MAX_REFERENCES} references can be used at once")));
    }
    if !args.aov.is_empty() && !is_exr(&args.output) && args.linear.is_none() {
        return Err(Failure::Usage("--aov needs an EXR: -o FILE.exr or --linear FILE.exr".to_owned()));
    }
    check_folders(args)
}

/// Checks that the folders of the files exist.
fn check_folders(args: &RenderArgs) -> Result<(), Failure> {
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

/// Traces the references. Each has its own seed, so that their noise is independent.
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
        let (tracer, size, stop) = (&loaded.tracer, flags.size(), &interrupt::is_cancelled);
        let reference = match flags.mode.looks_up() {
            true => ReferenceFrame::trace_filtered(tracer, &camera, size, &settings, stop),
            false => ReferenceFrame::trace(tracer, &camera, size, &settings, stop),
        };
        reference.map(Arc::new)
    };
    (1..).zip(&args.references).map(trace).collect::<Option<Vec<_>>>().ok_or(Failure::Interrupted)
}

fn object(
    args: &RenderArgs,
    flags: &Flags,
    loaded: &Loaded,
    made: &MadePicture,
    references: &[Arc<ReferenceFrame>],
) -> Value {
    let (stats, secs) = (&made.stats, &made.stats.secs);
    let mut rays = stats.rays;
    for reference in references {
        rays += reference.rays;
    }
    json!({
        "scene": loaded.name,
        "mode": flags.mode.name(),
        "size": flags.size(),
        "samples": flags.trace().samples,
        "antialias": args.antialias,
        "bounces": flags.trace().bounce_limit(),
        "seed": flags.seed,
        "exposure_ev": decimal(flags.exposure_ev()),
        "threads": rayon::current_num_threads(),
        "is_complete": stats.is_complete,
        "types": stats.types.percentages(),
        "secs": {
            "load": loaded.load_secs,
            "build": loaded.tracer.build_secs(),
            "references": total_secs(references),
            "warp": secs.visibility_and_lookup,
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

/// Time in seconds spent on references. `sum` would return -0 for an empty slice.
fn total_secs(references: &[Arc<ReferenceFrame>]) -> f64 {
    references.iter().fold(0.0, |sum, r| sum + r.secs)
}

fn table(args: &RenderArgs, flags: &Flags, made: &MadePicture, references: &[Arc<ReferenceFrame>]) -> String {
    let (types, secs) = (made.stats.types.percentages(), &made.stats.secs);
    let [w, h] = flags.size();
    let reference_secs = total_secs(references);
    output::table(&[
        ("picture", format!("{}, {w}x{h}", args.output.display())),
        ("Type 1", format!("{:.2} % reused", types.type1_percent)),
        ("Type 2", format!("{:.2} % mirror or glass", types.type2_percent)),
        ("Type 3", format!("{:.2} % traced", types.type3_percent)),
        ("frame", format!("{:.3} s", secs.frame)),
        ("references", format!("{} in {reference_secs:.3} s", references.len())),
        ("rays", format!("{}", made.stats.rays.total())),
    ])
}
