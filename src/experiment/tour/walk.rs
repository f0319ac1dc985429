//! The measured walk: the walkthrough of the window, frame by frame, with every reference traced
//! between two frames.

use super::record::{FlownTour, FrameRecord, Pose, ReferenceRecord, StoreRecord, TourRecord};
use crate::camera::{Camera, CameraPath};
use crate::experiment::measure::{MeasureSettings, Measurer};
use crate::experiment::run::ExperimentError;
use crate::raster::save::SaveError;
use crate::render::{Mode, RenderSettings, Walkthrough, WalkthroughSettings};
use crate::store::{StoreSession, StoreSettings};
use crate::trace::{Tracer, parallel::Stop};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Settings of a tour.
#[derive(Clone, Debug, PartialEq)]
pub struct TourSettings {
    /// Settings of the walkthrough.
    pub walkthrough: WalkthroughSettings,
    /// Width and height of frames and references in pixels.
    pub size: [u32; 2],
    /// Number of frames from the start of the walk to its end.
    pub frames: u32,
    /// Time limit of a frame. A frame that reaches it stays incomplete; `None` finishes every
    /// frame.
    pub budget: Option<Duration>,
    /// How frames are measured; `None` measures none.
    pub measure: Option<MeasureSettings>,
    /// The store that references are read from and written to; `None` uses none.
    pub store: Option<StoreSettings>,
    /// Whether frame 0 is rendered once before the walk, unrecorded, so that no recorded frame pays
    /// for first touching memory.
    pub warms_up: bool,
}

/// Progress of a tour.
#[derive(Debug)]
pub enum TourEvent<'a> {
    /// A frame is finished.
    Frame(&'a FrameRecord, &'a Walkthrough),
    /// A frame is about to be measured, which takes much longer than rendering it.
    Measuring(u32),
    /// A converged picture cannot be stored; the next run traces it again.
    TruthNotKept(&'a SaveError),
    /// Something of the store of references is damaged or cannot be used.
    StoreProblem(&'a str),
}

/// Renders the frames along `path` and records each. A reference that the policy requests after a
/// frame is traced at once and used from the next frame on. References that the policy requests
/// ahead are traced before frame 0. After `cancel` the finished frames are returned.
///
/// # Errors
/// [`ExperimentError`] if the walk has no key frames or an invalid pose, or if a frame cannot be
/// measured.
pub fn run_tour(
    tracer: &Arc<Tracer>,
    path: &CameraPath,
    settings: &TourSettings,
    cancel: &AtomicBool,
    observe: impl FnMut(TourEvent<'_>),
) -> Result<TourRecord, ExperimentError> {
    let stop = || cancel.load(Ordering::Relaxed);
    fly(tracer, &cameras(path, settings.frames)?, settings, &stop, observe)
}

/// Like [`run_tour`], with one frame at each camera.
///
/// # Errors
/// [`ExperimentError`] if a frame cannot be measured.
pub fn fly(
    tracer: &Arc<Tracer>,
    cameras: &[Camera],
    settings: &TourSettings,
    stop: Stop<'_>,
    mut observe: impl FnMut(TourEvent<'_>),
) -> Result<TourRecord, ExperimentError> {
    let trace = settings.walkthrough.render.trace;
    let mut walk = Walkthrough::new(Arc::clone(tracer), settings.walkthrough);
    if settings.budget.is_some() {
        walk = walk.progressive();
    }
    let first = cameras.first().filter(|_| settings.warms_up);
    let warm_up_secs = first.map_or(0.0, |first| warm_up(&mut walk, first, settings, stop));
    open_store(&mut walk, settings, &mut observe);
    let mut measurer = settings.measure.clone().map(Measurer::new);
    let mut frames = Vec::new();
    let mut references = references_ahead(&mut walk, settings, cameras.first(), stop);
    for (index, camera) in (0..).zip(cameras) {
        let start = Instant::now();
        let is_over = || settings.budget.is_some_and(|budget| start.elapsed() >= budget);
        walk.render(camera, settings.size, &|| stop() || is_over());
        if stop() {
            break;
        }
        let mut record = record_of(index, &walk);
        if let Some(measurer) = measurer.as_mut().filter(|m| m.is_due(index)) {
            observe(TourEvent::Measuring(index));
            record.measurement = measurer.measure(tracer, walk.frame(), &trace, stop)?;
            if let Some(error) = measurer.keep_error.take() {
                observe(TourEvent::TruthNotKept(&error));
            }
        }
        // No frame would use a reference requested by the last frame.
        if index + 1 < cameras.len() as u32
            && let Some(pose) = walk.wanted_reference()
            && let Some(added) =
                add_reference(&mut walk, settings, index, (references.len() as u32, pose), stop)
        {
            record.reference_added = true;
            record.reference_secs = added.secs;
            references.push(added);
        }
        observe(TourEvent::Frame(&record, &walk));
        frames.push(record);
    }
    let is_complete = frames.len() == cameras.len() && !stop();
    let truth_samples = settings.measure.as_ref().map_or(0, |m| m.truth_samples);
    let flown = FlownTour {
        frames,
        references,
        warm_up_secs,
        is_complete,
        store: close_store(&mut walk, &mut observe),
    };
    Ok(TourRecord::new(flown, [trace.samples, truth_samples]))
}

/// Opens the store of the settings. Without it the walk goes on.
fn open_store(walk: &mut Walkthrough, settings: &TourSettings, observe: &mut impl FnMut(TourEvent<'_>)) {
    let Some(store) = &settings.store else { return };
    match StoreSession::open(store, walk.tracer(), true) {
        Ok(session) => drop(walk.set_store(Some(session))),
        Err(error) => observe(TourEvent::StoreProblem(&error.to_string())),
    }
}

/// Waits until all references are stored.
fn close_store(walk: &mut Walkthrough, observe: &mut impl FnMut(TourEvent<'_>)) -> StoreRecord {
    let Some(store) = walk.store_mut() else { return StoreRecord::default() };
    store.finish();
    store.report().problems.iter().for_each(|problem| observe(TourEvent::StoreProblem(problem)));
    StoreRecord::of(store)
}

/// End of the message about a pose that is not finite.
const INVALID: &str = "has no valid pose; eyes and targets must be finite numbers";

/// Returns the cameras of a number of frames along a path.
///
/// # Errors
/// [`ExperimentError`] if the walk has no key frames or an invalid pose.
pub fn cameras(path: &CameraPath, frames: u32) -> Result<Vec<Camera>, ExperimentError> {
    (0..frames)
        .map(|i| {
            let camera = path.camera(i, frames).ok_or(ExperimentError::EmptyWalk)?;
            if camera.is_valid() {
                Ok(camera)
            } else {
                Err(ExperimentError::Unsuitable(format!("frame {i} of the walk {INVALID}")))
            }
        })
        .collect()
}

/// Renders the first frame in full with the buffers of the walkthrough. Returns its time in
/// seconds.
fn warm_up(walk: &mut Walkthrough, camera: &Camera, settings: &TourSettings, stop: Stop<'_>) -> f64 {
    let render = RenderSettings { mode: Mode::Full, ..settings.walkthrough.render };
    walk.set_settings(WalkthroughSettings { render, ..settings.walkthrough });
    let secs = walk.render(camera, settings.size, stop).stats.secs.frame;
    walk.set_settings(settings.walkthrough);
    secs
}

fn record_of(index: u32, walk: &Walkthrough) -> FrameRecord {
    let frame = walk.frame();
    let stats = &frame.stats;
    FrameRecord {
        frame: index,
        pose: Pose::from(&frame.camera),
        types: stats.types.percentages(),
        references_used: stats.references_used,
        references_held: walk.cache().entries().len(),
        warped_pixels: stats.warped_pixels,
        frame_secs: stats.secs.frame,
        select_secs: stats.secs.select,
        warp_secs: stats.secs.visibility_and_lookup,
        secondary_secs: stats.secs.secondary,
        trace_secs: stats.secs.trace,
        audit_secs: stats.secs.audit,
        audit: stats.audit,
        temporal_stability: stats.temporal_stability,
        is_complete: stats.is_complete,
        rays: stats.rays,
        reference_added: walk.has_kept_frame(),
        reference_secs: 0.0,
        measurement: None,
    }
}

/// Traces the references that the policy requests before the first frame.
fn references_ahead(
    walk: &mut Walkthrough,
    settings: &TourSettings,
    first: Option<&Camera>,
    stop: Stop<'_>,
) -> Vec<ReferenceRecord> {
    let mut references = Vec::new();
    while let Some(pose) = first.and_then(|camera| walk.wanted_ahead(camera, settings.size)) {
        let number = references.len() as u32;
        let Some(added) = add_reference(walk, settings, 0, (number, pose), stop) else { break };
        references.push(ReferenceRecord { is_ahead: true, ..added });
    }
    references
}

/// Traces a reference at a pose and inserts it into the cache. `None` after a stop or if it is
/// rejected.
fn add_reference(
    walk: &mut Walkthrough,
    settings: &TourSettings,
    frame: u32,
    (number, camera): (u32, Camera),
    stop: Stop<'_>,
) -> Option<ReferenceRecord> {
    // The time includes the insertion into the cache.
    let start = Instant::now();
    let reference = walk.reference_job(camera, settings.size).trace(stop)?;
    let mut record = ReferenceRecord {
        reference: number,
        after_frame: frame,
        is_ahead: false,
        pose: Pose::from(&camera),
        secs: 0.0,
        rays: reference.rays,
        bytes: reference.bytes(),
    };
    walk.insert(reference)?;
    record.secs = start.elapsed().as_secs_f64();
    Some(record)
}
