//! `afterimage tour`: renders a camera path frame by frame, and records every frame.

use super::flags::{Flags, StoreChoice, number_in};
use super::scene::{Loaded, load};
use super::section::SectionFlags;
use super::show_flags::{Show, ShowArgs};
use super::tour_show::TourPictures;
use super::{failure::Failure, interrupt, output, paths, progress::Progress, section, walk::read_path};
use crate::picture::{PictureOrigin, memory, metadata, sequence::FRAMES_PER_SEC, sequence::film_command};
use afterimage::experiment::tour::{MeasuredSummary, StoreRecord};
use afterimage::experiment::{FrameRecord, MeasureSettings, TourEvent, TourRecord, TourSettings, run_tour};
use afterimage::raster::exposure::decimal;
use afterimage::raster::save::{save_png, write_atomically};
use afterimage::render::aov::types_rows;
use afterimage::{
    Frame, Mode, WalkthroughSettings, camera::CameraPath, experiment::run::csv,
    experiment::statistics::median, raster::stream::COMPLETE, reference::PlacementPolicy,
    reference::placement::RULES, render::bands::Background, warp::MAX_REFERENCES,
};
use clap::{Args, builder::PossibleValuesParser};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Duration;

#[derive(Args, Clone, Debug)]
pub(crate) struct TourArgs {
    /// A model (.obj, .gltf, .glb) or builtin:NAME [default: the embedded gallery].
    pub(super) scene: Option<String>,
    /// Number of frames [default: the camera path's own].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_FRAMES)))]
    pub(super) frames: Option<u32>,
    /// A recorded camera path (JSON) [default: the scene's own]; FILE#NAME selects one of several.
    #[arg(long, value_name = "FILE[#NAME]")]
    pub(super) path: Option<String>,
    /// Folder for frames.csv, references.csv, summary.json and pictures; created if it does not
    /// exist.
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Rule that places new references.
    #[arg(long, value_name = "predictive|threshold|greedy|grid|none", default_value = "predictive")]
    #[arg(value_parser = PossibleValuesParser::new(RULES.iter().map(|rule| rule.name)), hide_possible_values = true)]
    pub(super) placement: String,
    /// Percentage of Type 3 pixels above which a new reference is traced.
    #[arg(long, value_name = "PERCENT", default_value = "5", value_parser = number_in(0.0..=100.0, " percent"))]
    pub(super) threshold: f64,
    /// Memory for references, MB.
    #[arg(long, value_name = "MB", default_value_t = 1024)]
    #[arg(value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    pub(super) cache_mb: u64,
    /// Maximum number of references that a frame uses.
    #[arg(long, value_name = "N", default_value_t = 8)]
    #[arg(value_parser = clap::value_parser!(u8).range(1..=MAX_REFERENCES as i64))]
    pub(super) most_references: u8,
    /// Write every frame, and the types of its pixels, to images/.
    #[arg(long)]
    pub(super) pictures: bool,
    #[command(flatten)]
    pub(super) shown: ShowArgs,
    /// Frames from one picture to the next; 0 writes every frame.
    #[arg(skip)]
    pub(super) picture_every: u32,
    /// Check a few looked-up pixels of every frame by tracing them, in up to a twentieth of its
    /// time.
    #[arg(long)]
    pub(super) audit: bool,
    /// End every frame after this time, as the window does while the camera moves; unfinished
    /// pixels are filled from their neighbours, ms.
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u32).range(1..=3_600_000))]
    pub(super) budget_ms: Option<u32>,
    /// Measure errors and the full tracer's time on some frames.
    #[arg(long)]
    pub(super) measure: bool,
    /// Measure every K-th frame [default: six frames in all].
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) measure_every: Option<u32>,
    /// Samples, as of --samples, of the converged pictures against which errors are measured.
    #[arg(long, value_name = "N", default_value_t = 256)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(super) truth_samples: u32,
    /// Folder in which converged pictures are kept [default: the user's cache folder].
    #[arg(long, value_name = "DIR")]
    pub(super) truth_cache: Option<PathBuf>,
    #[command(flatten)]
    pub(super) section: SectionFlags,
}

/// Maximum number of frames.
const MAX_FRAMES: u32 = CameraPath::MAX_FRAMES;

pub(crate) fn run(args: &TourArgs, flags: &Flags) -> Result<(), Failure> {
    check_shown(args, flags)?;
    memory::check(flags.pixels(), 1)?;
    args.section.check_mode(flags.mode)?;
    let recorded = args.path.as_deref().map(read_path).transpose()?;
    make_folder(&args.out)?;
    let loaded = load(args.scene.as_deref(), flags)?;
    let flags = &loaded.expose(flags)?;
    let walk = recorded.unwrap_or_else(|| loaded.scene().walk.clone());
    let first = walk.camera(0, args.frames.unwrap_or(walk.frames)).unwrap_or(*loaded.scene().start());
    let loaded = args.section.cut(loaded, &first, flags)?;
    let (_, outcome) = record(args, flags, &loaded, &walk)?;
    if args.pictures && !matches!(outcome, Err(Failure::Failed(_))) {
        output::say(&format!(
            "to encode them as a film: {}",
            film_command(&args.out.join("images"), FRAMES_PER_SEC)
        ));
    }
    outcome
}

/// Checks what `--show` does not go with.
fn check_shown(args: &TourArgs, flags: &Flags) -> Result<(), Failure> {
    args.shown.check()?;
    let shows_light = !matches!(args.shown.show, Show::Radiance | Show::Luminance);
    let fault = match () {
        () if args.shown.show == Show::Radiance => return Ok(()),
        () if !args.pictures => "--show draws the pictures of a tour; add --pictures",
        () if args.measure || args.measure_every.is_some() => "--measure is for --show radiance",
        () if shows_light && flags.mode == Mode::Paper => {
            "mode paper warps pictures of radiance; use --mode exact, fast or full"
        }
        () => return Ok(()),
    };
    Err(Failure::Usage(fault.to_owned()))
}

/// Flies a camera path, writes pictures and records, and prints the result. Returns the record, and
/// whether it is whole.
pub(super) fn record(
    args: &TourArgs,
    flags: &Flags,
    loaded: &Loaded,
    walk: &CameraPath,
) -> Result<(TourRecord, Result<(), Failure>), Failure> {
    make_folder(&args.out)?;
    if args.pictures {
        make_folder(&args.out.join("images"))?;
    }
    let settings = settings(args, flags, walk);
    let (record, picture_error) = fly(args, flags, loaded, walk, &settings)?;
    let mut object = object(args, flags, loaded, &record);
    output::extend(&mut object, section::record(loaded));
    write_atomically(&args.out.join("frames.csv"), csv(&record.frames).as_bytes())?;
    write_atomically(&args.out.join("references.csv"), csv(&record.references).as_bytes())?;
    write_atomically(&args.out.join("summary.json"), format!("{object:#}\n").as_bytes())?;
    loaded.say_bounds();
    output::result(flags.json, &object, || table(args, &record));
    let outcome = match picture_error {
        Some(error) => Err(error),
        None if !record.is_complete => Err(Failure::Interrupted),
        None => loaded.verdict(flags),
    };
    Ok((record, outcome))
}

fn make_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Failure::Failed(format!("cannot create the folder {}: {e}", folder.display())))
}

fn settings(args: &TourArgs, flags: &Flags, walk: &CameraPath) -> TourSettings {
    let placement = PlacementPolicy::named(&args.placement, args.threshold).unwrap_or_default();
    let frames = args.frames.unwrap_or(walk.frames);
    let measure = (args.measure || args.measure_every.is_some()).then(|| MeasureSettings {
        every: args.measure_every.unwrap_or(frames.div_ceil(6)),
        truth_samples: args.truth_samples,
        truth_folder: args.truth_cache.clone().or_else(|| paths::cache_folder().map(|c| c.join("truth"))),
        exposure_ev: flags.exposure_ev(),
    });
    let walkthrough = WalkthroughSettings {
        render: flags.render(),
        placement,
        max_references: args.most_references.into(),
        cache_bytes: usize::try_from(args.cache_mb << 20).unwrap_or(usize::MAX),
        audits: args.audit,
        measures_stability: measure.is_some(),
    };
    let budget = args.budget_ms.map(|ms| Duration::from_millis(ms.into()));
    let store = flags.store(&StoreChoice::Off);
    TourSettings { walkthrough, size: flags.size(), frames, budget, measure, store, warms_up: true }
}

/// Renders the camera path. If a picture cannot be written, the tour ends and its record is kept.
fn fly(
    args: &TourArgs,
    flags: &Flags,
    loaded: &Loaded,
    walk: &CameraPath,
    settings: &TourSettings,
) -> Result<(TourRecord, Option<Failure>), Failure> {
    let mut progress = Progress::new(&loaded.name, settings.frames.into());
    let cancel = interrupt::flag();
    let mut picture_error = None;
    let mut pictures = TourPictures::new(args.shown);
    let record = run_tour(&pictures.tracer(&loaded.tracer), walk, settings, cancel, |event| match event {
        TourEvent::Measuring(frame) => progress.at(frame.into(), "measuring"),
        TourEvent::TruthNotKept(error) => {
            progress.say(&format!("warning: the converged picture is not cached: {error}"));
        }
        TourEvent::StoreProblem(problem) => progress.say(&format!("warning: {problem}")),
        TourEvent::Frame(record, walk) => {
            let note =
                format!("{:.0} ms, Type 3 {:.1} %", record.frame_secs * 1e3, record.types.type3_percent);
            progress.at(u64::from(record.frame) + 1, &note);
            let is_pictured = args.pictures && record.frame.is_multiple_of(args.picture_every.max(1));
            if is_pictured && picture_error.is_none() {
                picture_error =
                    write_pictures(args, flags, loaded, (record.frame, walk.frame()), &mut pictures).err();
                if picture_error.is_some() {
                    cancel.store(true, std::sync::atomic::Ordering::Relaxed);
                }
            }
        }
    });
    Ok((record.map_err(|e| Failure::Failed(e.to_string()))?, picture_error))
}

fn write_pictures(
    args: &TourArgs,
    flags: &Flags,
    loaded: &Loaded,
    (number, frame): (u32, &Frame),
    pictures: &mut TourPictures,
) -> Result<(), Failure> {
    let folder = args.out.join("images");
    let (picture, size, note) = pictures.draw(frame, loaded.scene(), flags)?;
    let mut metadata = file_metadata(flags, loaded, frame);
    metadata.extend(note.map(|note| ("Description", note)));
    save_png(&folder.join(format!("frame_{number:04}.png")), size, &picture, &metadata)?;
    let types = types_rows(&frame.types);
    save_png(&folder.join(format!("types_{number:04}.png")), frame.view.size, &types, &metadata)?;
    Ok(())
}

/// Metadata of the picture of a frame.
fn file_metadata(flags: &Flags, loaded: &Loaded, frame: &Frame) -> Vec<(&'static str, String)> {
    let mut metadata = metadata(&PictureOrigin {
        section: loaded.tracer.section().map_or(&[], |section| section.planes()),
        outlines: None,
        document: None,
        scene_name: &loaded.name,
        scene: loaded.scene(),
        camera: &frame.camera,
        size: frame.view.size,
        settings: &flags.render(),
        refined: frame.stats.refined,
        background: Background::Shown,
        exposure_ev: flags.exposure_ev(),
        tone_map: flags.tone_map,
    });
    metadata.push((COMPLETE, if frame.stats.is_complete { "yes" } else { "no" }.to_owned()));
    metadata
}

fn object(args: &TourArgs, flags: &Flags, loaded: &Loaded, record: &TourRecord) -> Value {
    let mut object = json!({
        "scene": loaded.name,
        "scene_hash": loaded.scene().hash,
        "stiffness": loaded.scene().conditioning,
        "version": env!("CARGO_PKG_VERSION"),
        "mode": flags.mode.name(),
        "size": flags.size(),
        "samples": flags.trace().samples,
        "bounces": flags.trace().bounce_limit(),
        "seed": flags.seed,
        "threads": rayon::current_num_threads(),
        "placement": args.placement,
        "threshold_percent": args.threshold,
        "cache_mb": args.cache_mb,
        "exposure_ev": decimal(flags.exposure_ev()),
        "light_cuts": loaded.light_cuts(),
        "secs": { "load": loaded.load_secs, "build": loaded.tracer.build_secs() },
    });
    output::extend(&mut object, record);
    object
}

/// The equal-error speed-up in words, with the number of frames that it leaves out.
fn equal_error(m: &MeasuredSummary) -> String {
    let (of, all) = (m.measured_frames_with_references, m.measured_frames);
    let left_out = format!("{} of {all} measured frames are left out: they had no references", all - of);
    match m.equal_error_speedup {
        None => format!("unknown; {left_out}"),
        Some(times) if of == all => format!("{times:.2}x, references counted"),
        Some(times) => format!("{times:.2}x, references counted; {left_out}"),
    }
}

fn table(args: &TourArgs, record: &TourRecord) -> String {
    let summary = &record.summary;
    let ms = |secs: Option<f64>| secs.map_or("-".to_owned(), |s| format!("{:.1} ms", s * 1e3));
    let share = |p: Option<f64>| p.map_or("-".to_owned(), |p| format!("{p:.2} %"));
    let of = |a: String, b: String| format!("{a} median, {b}");
    let type3 = of(share(summary.type3_percent_median), format!("{} most", share(summary.type3_percent_max)));
    let stage = |secs: fn(&FrameRecord) -> f64| ms(median(record.frames.iter().map(secs)));
    let mut rows = vec![
        ("records", args.out.display().to_string()),
        ("frames", record.frames.len().to_string()),
        ("frame", of(ms(summary.frame_secs_median), format!("{} p99", ms(summary.frame_secs_p99)))),
        ("select", stage(|f| f.select_secs)),
        ("visibility and look-up", stage(|f| f.warp_secs)),
        ("specular", stage(|f| f.secondary_secs)),
        ("trace", stage(|f| f.trace_secs)),
        ("Type 3", type3),
        ("references", format!("{} in {:.2} s", record.references_added, record.reference_secs_total)),
    ];
    if record.store.store_bytes > 0 {
        let StoreRecord { references_from_store, references_to_store, store_bytes, store_secs } =
            record.store;
        rows.push((
            "store",
            format!(
                "{references_from_store} references read, {references_to_store} added in {store_secs:.2} s; {:.1} MB",
                store_bytes as f64 / 1e6
            ),
        ));
    }
    if summary.cut_percent > 0.0 {
        rows.push(("cut at the budget", share(Some(summary.cut_percent))));
    }
    if let Some(flips) = summary.flips_percent_median {
        let db = summary.steadiness_psnr_db_median.unwrap_or(f64::INFINITY);
        rows.push(("steadiness", format!("{flips:.2} % flips, {db:.1} dB from frame to frame")));
    }
    if let Some(m) = &summary.measured {
        rows.extend([
            ("full frame", ms(Some(m.full_frame_secs_median))),
            ("speed-up", format!("{:.2}x, with references {:.2}x", m.speedup, m.speedup_with_references)),
            ("at equal error", equal_error(m)),
            ("exposure", format!("{:+.1} EV for all pictures compared", m.exposure_ev)),
            ("PSNR", format!("{:.2} dB median, full {:.2} dB", m.psnr_db_median, m.full_psnr_db_median)),
            ("FLIP", format!("{:.4} median, full {:.4}", m.flip_mean_median, m.full_flip_mean_median)),
            ("see-through", format!("{:.3} % of the reused pixels", m.see_through_percent_median)),
            ("noise", m.noise.clone()),
        ]);
    }
    output::table(&rows)
}
