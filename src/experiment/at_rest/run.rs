//! Renders the view as the window does, keeps what is shown at each checkpoint, and compares it.
//!
//! The pictures depend on the clock, so their errors differ from run to run, as times do.

use crate::{
    camera::{Camera, View},
    experiment::{
        measure::{Errors, FramePictures, antialiased_truth_of, spread_over_passes},
        run::{Cell, CellOutcome, Effort, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord},
    },
    raster::{
        color::{ToneMap, srgb8},
        load::exposed,
        metrics::mse,
        pixel_types::PixelType,
    },
    render::{
        Frame, FrameRequest, Mode, RenderSettings, StillView, WalkthroughSettings, render_antialiased,
        schedule::WINDOW_SAMPLES,
    },
};
use glam::Vec3;
use std::{rc::Rc, sync::Arc, time::Duration};

/// Names of the cells.
pub(super) const WINDOW: &str = "window";
pub(super) const FULL: &str = "full";

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    let usual = ExperimentSettings {
        effort,
        size: [1200, 825],
        samples: WINDOW_SAMPLES,
        truth_samples: 4096,
        seconds: vec![1.0, 2.0, 5.0, 10.0, 60.0],
        full_samples: Some(256),
        ..ExperimentSettings::default()
    };
    match effort {
        Effort::Quick => ExperimentSettings {
            size: [160, 90],
            truth_samples: 512,
            seconds: vec![0.5, 1.0, 2.0],
            full_samples: Some(64),
            ..usual
        },
        Effort::Usual => usual,
    }
}

pub(crate) fn cells(context: &ExperimentContext<'_>) -> Vec<Cell> {
    let has_full = context.settings.full_samples.is_some_and(|samples| samples > 0);
    let names = [WINDOW].into_iter().chain(has_full.then_some(FULL));
    names.map(|name| Cell(RunRecord::default().with("picture", name))).collect()
}

pub(crate) fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let camera = context.camera_on_walk(0.0)?;
    match cell.text("picture") {
        Some(WINDOW) => window(context, &camera),
        Some(FULL) => full(context, &camera),
        _ => Err(ExperimentError::UnknownCell { experiment: "at-rest", cell: cell.label() }),
    }
}

/// A picture that the window has shown.
#[derive(Clone)]
struct Shown {
    frame: Frame,
    /// Time at which it was finished.
    at: Duration,
}

/// What is shown at each checkpoint, compared with the converged picture.
fn window(context: &ExperimentContext<'_>, camera: &Camera) -> CellOutcome {
    let Some((first, shown)) = shown_at_checkpoints(context, camera) else { return Ok(None) };
    let Some(truth) = antialiased_truth_of(context, camera) else { return Ok(None) };
    let exposure_ev = context.settings.exposure_ev;
    let shown_truth: Vec<[u8; 3]> = truth.iter().map(|v| srgb8(*v, exposure_ev, ToneMap::Aces)).collect();
    context.save_picture("truth.png", context.settings.size, &shown_truth)?;
    let mut records = Vec::new();
    for (seconds, shown) in context.settings.seconds.iter().zip(shown) {
        let frame = in_window(context, camera, shown.as_deref());
        FramePictures::of(&picture_name(*seconds), &frame, &truth, exposure_ev)?.save(context)?;
        let stats = frame.stats;
        let passes = stats.refined.pass.max(u32::from(shown.is_some()));
        // Samples per pixel: of all passes, or of the smooth light that the picture looks up where
        // that has more.
        let samples = passes.saturating_mul(context.settings.samples).max(stats.refined.light_samples);
        records.push(
            RunRecord::default()
                .with("seconds", *seconds)
                .with("first_frame_secs", first.map(|at| at.as_secs_f64()))
                .with("shown_secs", shown.as_ref().map(|s| s.at.as_secs_f64()))
                .with("width", shown.as_ref().map_or(0, |s| s.frame.view.size[0]))
                .with("is_complete", stats.is_complete)
                .with("passes", passes)
                .with("samples", samples)
                .with_fields(&errors(&frame, &truth, exposure_ev)?),
        );
    }
    Ok(Some(records))
}

/// Base name of the pictures of a checkpoint.
pub(super) fn picture_name(seconds: f64) -> String {
    format!("at-{seconds}s")
}

/// The time of the first picture, and what is shown at each checkpoint.
type Watched = (Option<Duration>, Vec<Option<Rc<Shown>>>);

/// Renders until the last checkpoint. Returns the time of the first picture, and what is shown at
/// each checkpoint; pictures are compared afterwards, so that the clock counts rendering alone.
/// `None` after a stop.
fn shown_at_checkpoints(context: &ExperimentContext<'_>, camera: &Camera) -> Option<Watched> {
    // A tracer that nothing was traced with: what it has cached would be missing in a new window.
    let scene = Arc::clone(context.tracer.scene());
    let tracer = Arc::new(context.tracer.with_same_geometry(scene));
    let settings = WalkthroughSettings {
        render: RenderSettings { mode: Mode::Exact, trace: context.settings.trace() },
        cache_bytes: context.settings.cache_bytes(),
        audits: true,
        ..WalkthroughSettings::default()
    };
    let mut view = StillView::new(tracer, settings, camera, context.settings.size).in_window();
    let checkpoints: Vec<Duration> =
        context.settings.seconds.iter().map(|s| Duration::from_secs_f64(*s)).collect();
    let (mut kept, mut now, mut first) = (Vec::new(), None, None);
    while kept.len() < checkpoints.len() {
        let step = view.step(context.stop);
        if (context.stop)() {
            return None;
        }
        let spent = view.spent();
        // A picture that is finished after a checkpoint is not shown yet.
        while step.is_none() || checkpoints[kept.len()] < spent {
            kept.push(now.clone());
            if kept.len() == checkpoints.len() {
                break;
            }
        }
        if step.is_some_and(|done| done.is_shown) {
            now = Some(Rc::new(Shown { frame: view.frame().clone(), at: spent }));
            first = first.or(Some(spent));
        }
    }
    Some((first, kept))
}

/// The frame as a window shows it: enlarged where it has less than every pixel, and black before
/// the first one.
fn in_window(context: &ExperimentContext<'_>, camera: &Camera, shown: Option<&Shown>) -> Frame {
    let size = context.settings.size;
    let view = View::new(camera, &context.tracer.scene().frame, size);
    let Some(Shown { frame, .. }) = shown else {
        let count = view.pixel_count();
        let (radiance, types) = (vec![Vec3::ZERO; count], vec![PixelType::Unseen; count]);
        return Frame { camera: *camera, view, radiance, types, ..Frame::default() };
    };
    let (radiance, types) = enlarged(frame, size);
    Frame { camera: *camera, view, radiance, types, stats: frame.stats, ..Frame::default() }
}

/// Enlarges a frame as the graphics card does: radiance interpolated linearly, types of the nearest
/// pixel.
fn enlarged(frame: &Frame, [width, height]: [u32; 2]) -> (Vec<Vec3>, Vec<PixelType>) {
    let from = frame.view.size;
    let place = |pixel: u32, to: u32, from: u32| {
        let at = ((pixel as f32 + 0.5) * from as f32 / to as f32 - 0.5).clamp(0.0, (from - 1) as f32);
        let low = at as u32;
        (low, (low + 1).min(from - 1), at - low as f32)
    };
    let pixel = |x: u32, y: u32| (y * from[0] + x) as usize;
    let color = |x: u32, y: u32| {
        let ((x0, x1, across), (y0, y1, down)) = (place(x, width, from[0]), place(y, height, from[1]));
        let row = |y: u32| frame.radiance[pixel(x0, y)].lerp(frame.radiance[pixel(x1, y)], across);
        row(y0).lerp(row(y1), down)
    };
    let nearest = |x: u32, y: u32| frame.types[pixel(x * from[0] / width, y * from[1] / height)];
    let pixels = || (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)));
    (pixels().map(|(x, y)| color(x, y)).collect(), pixels().map(|(x, y)| nearest(x, y)).collect())
}

/// The full tracer's picture, anti-aliased as a refined picture is.
fn full(context: &ExperimentContext<'_>, camera: &Camera) -> CellOutcome {
    let samples = context.settings.full_samples.unwrap_or(1);
    let (passes, trace) = spread_over_passes(samples, context.settings.trace());
    let settings = RenderSettings { mode: Mode::Full, trace };
    let request = FrameRequest::new(context.tracer, camera, context.settings.size, &settings);
    let frame = render_antialiased(&request.with_stop(context.stop), passes);
    if !frame.stats.is_complete {
        return Ok(None);
    }
    let Some(truth) = antialiased_truth_of(context, camera) else { return Ok(None) };
    let exposure_ev = context.settings.exposure_ev;
    FramePictures::of(FULL, &frame, &truth, exposure_ev)?.save(context)?;
    let record = RunRecord::default()
        .with("samples", passes * trace.samples)
        .with("full_secs", frame.stats.secs.frame)
        .with_fields(&errors(&frame, &truth, exposure_ev)?);
    Ok(Some(vec![record]))
}

/// All errors, with the mean squared difference of display values as `mse`.
fn errors(frame: &Frame, truth: &[Vec3], exposure_ev: f32) -> Result<RunRecord, ExperimentError> {
    let [shown, right] = [&frame.radiance[..], truth].map(|r| exposed(r, exposure_ev));
    let record = RunRecord::default().with("mse", mse(&shown, &right));
    Ok(record.with_fields(&Errors::of(frame, truth, exposure_ev)?))
}
