//! The measured walk: the window's walk, one frame after the other, every reference traced between two frames.

use super::record::{FrameRecord, Pose, ReferenceRecord, TourRecord};
use crate::camera::Camera;
use crate::camera::CameraPath;
use crate::experiment::measure::{MeasureError, MeasureSettings, Measurer};
use crate::raster::save::SaveError;
use crate::render::{Mode, RenderSettings, Walkthrough, WalkthroughSettings};
use crate::trace::Tracer;
use crate::trace::parallel::Stop;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What a tour is made with.
#[derive(Clone, Debug, PartialEq)]
pub struct TourSettings {
    /// The walk's own settings.
    pub walkthrough: WalkthroughSettings,
    /// Of the frames and of the references.
    pub size: [u32; 2],
    /// How many, from the start of the walk to its end.
    pub frames: u32,
    /// Frames are cut after so long and stay as they are; `None` finishes them all.
    pub budget: Option<Duration>,
    /// Whether and how frames are measured.
    pub measure: Option<MeasureSettings>,
}

/// What happens on a tour, as it happens.
#[derive(Debug)]
pub enum TourEvent<'a> {
    /// A frame is done.
    Frame(&'a FrameRecord, &'a Walkthrough),
    /// A frame is about to be measured, which takes much longer than the frame.
    Measuring(u32),
    /// Truths cannot be kept; they are traced anew the next time.
    TruthNotKept(&'a SaveError),
}

/// Why there is no tour.
#[derive(Debug, thiserror::Error)]
pub enum TourError {
    /// A walk without key frames.
    #[error("the walk has no key frames; it needs at least one")]
    EmptyWalk,
    /// A pose that is not finite, or a field of view out of range.
    #[error("frame {0} of the walk has no valid pose; eyes and targets must be finite numbers")]
    Pose(u32),
    /// Measuring failed.
    #[error(transparent)]
    Measure(#[from] MeasureError),
}

/// Walks along `path` and records every frame. A reference that the policy wants after a frame is traced at once and
/// serves from the next frame on; before frame 0 there are those that the policy wants ahead. After `cancel` what was done so far is returned.
///
/// Frame 0 is rendered once before the walk, unrecorded, so that no frame pays for touching memory first.
///
/// # Errors
/// [`TourError`] where the walk cannot be walked.
pub fn run_tour(
    tracer: &Arc<Tracer>,
    path: &CameraPath,
    settings: &TourSettings,
    cancel: &AtomicBool,
    observe: impl FnMut(TourEvent<'_>),
) -> Result<TourRecord, TourError> {
    let stop = || cancel.load(Ordering::Relaxed);
    fly(tracer, &cameras(path, settings.frames)?, settings, &stop, observe)
}

/// The same from pose to pose; the number of frames is theirs.
///
/// # Errors
/// [`TourError::Measure`] where a frame cannot be measured.
pub fn fly(
    tracer: &Arc<Tracer>,
    cameras: &[Camera],
    settings: &TourSettings,
    stop: Stop<'_>,
    mut observe: impl FnMut(TourEvent<'_>),
) -> Result<TourRecord, TourError> {
    let trace = settings.walkthrough.render.trace;
    let mut walk = Walkthrough::new(Arc::clone(tracer), settings.walkthrough);
    if settings.budget.is_some() {
        walk = walk.progressive();
    }
    let warm_up_secs = cameras.first().map_or(0.0, |first| warm_up(&mut walk, first, settings, stop));
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
        // The last frame's wish would serve nobody.
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
    Ok(TourRecord::new(frames, references, warm_up_secs, is_complete, [trace.samples, truth_samples]))
}

fn cameras(path: &CameraPath, frames: u32) -> Result<Vec<Camera>, TourError> {
    (0..frames)
        .map(|i| {
            let camera = path.camera(i, frames).ok_or(TourError::EmptyWalk)?;
            if camera.is_valid() { Ok(camera) } else { Err(TourError::Pose(i)) }
        })
        .collect()
}

/// Renders the first frame in full with the walk's own buffers.
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
        warp_secs: stats.secs.warp,
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

/// Traces what the policy wants before the first frame.
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

/// Traces a reference of a number at a pose.
fn add_reference(
    walk: &mut Walkthrough,
    settings: &TourSettings,
    frame: u32,
    (number, camera): (u32, Camera),
    stop: Stop<'_>,
) -> Option<ReferenceRecord> {
    // Entering it into the cache counts as well.
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
