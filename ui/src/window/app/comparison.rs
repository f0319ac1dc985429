//! The comparison with the full tracer: its picture is traced once the view is at rest, dropped
//! when the view changes, and its distance to the shown picture is measured.

use super::{CurrentScene, Measurement, Parts, Services};
use crate::window::gpu::viewport;
use crate::window::rendering::{
    FullTrace, SeenSection, Subject, TaskError, lower_priority, spawn_task, take_result,
};
use crate::window::state::{AppState, Compare, Comparison, Overlay, Pair, Quality, difference};
use afterimage::raster::exposure::Exposure;

/// Takes the comparison one step further.
pub(super) fn update_comparison(app: &mut Parts) {
    take_measurement(&mut app.state, &mut app.services);
    let subject = subject(&app.state, &app.current);
    if app.services.full_trace.as_ref().is_some_and(|trace| Some(&trace.subject) != subject.as_ref()) {
        app.services.full_trace = None;
        (app.state.comparison.full, app.state.comparison.error) = (None, None);
    }
    let is_due = app.state.comparison.is_wanted()
        && app.services.full_trace.is_none()
        && is_at_rest(&app.state, &app.services);
    if let Some(subject) = subject.filter(|_| is_due) {
        app.services.full_trace =
            Some(FullTrace::start(subject, app.services.threads, app.services.wake.clone()));
    }
    if let Some(trace) = &app.services.full_trace {
        let full = &mut app.state.comparison.full;
        if trace.take(full)
            && let (Some(graphics), Some(full)) = (&app.services.graphics, full)
        {
            viewport::upload_full(graphics, full);
        }
        if let Some(text) = trace.failure() {
            app.state.error(format!("tracing in full failed: {text}"));
        }
    }
    measure(&app.state, &mut app.services);
}

/// Everything that decides the full tracer's picture of the current view.
fn subject(state: &AppState, current: &CurrentScene) -> Option<Subject> {
    let (tracer, frame) = (current.tracer()?.clone(), state.frame.as_ref()?);
    let camera = *state.navigation.fly.camera();
    let tracer = SeenSection::of(state.section(), &tracer);
    Some(Subject { tracer, camera, size: frame.size, render: state.quality.walk.render })
}

/// True where the newest frame is complete and shows the current view.
fn is_at_rest(state: &AppState, services: &Services) -> bool {
    state.frame.as_ref().is_some_and(|frame| {
        let is_newest = frame.generation == services.render.generation();
        is_newest && frame.stats.is_complete && frame.camera == *state.navigation.fly.camera()
    })
}

/// Returns the two pictures that can be measured.
fn pair(state: &AppState, services: &Services) -> Option<Pair> {
    let (frame, full) = (state.frame.as_ref()?, state.comparison.full.as_ref()?);
    let is_same_view = frame.camera == full.camera && frame.size == full.size;
    let is_pair = state.comparison.is_wanted() && is_at_rest(state, services) && is_same_view;
    let pair = (frame.generation, full.stats.refined.pass, state.exposure_ev());
    (is_pair && !frame.is_refinement).then_some(pair)
}

/// Starts to measure a pair that is not measured yet, unless another one is being measured.
fn measure(state: &AppState, services: &mut Services) {
    let (Some(pair), None) = (pair(state, services), &services.measurement) else { return };
    let (Some(frame), Some(full)) = (&state.frame, &state.comparison.full) else { return };
    // No measurement is running: a pair that was begun and has no result has failed.
    if state.comparison.error.is_some_and(|(of, _)| of == pair) || services.measured_pair == Some(pair) {
        return;
    }
    services.measured_pair = Some(pair);
    let quality = Quality { exposure: Exposure::Stops(state.exposure_ev()), ..state.quality };
    let size = frame.size;
    let [picture, full] = [frame, full].map(|f| f.radiance.clone());
    services.measurement = Some(spawn_task("measure", services.wake.clone(), move |_| {
        lower_priority();
        let (error, map) = difference(&picture, &full, size, &quality).map_err(TaskError::failed)?;
        Ok(Measurement { pair, size, error, map })
    }));
}

fn take_measurement(state: &mut AppState, services: &mut Services) {
    match take_result(&mut services.measurement) {
        Some(Ok(Measurement { pair, size, error, map })) => {
            services.measured_pair = None;
            // The view may have changed meanwhile.
            if state.comparison.full.as_ref().is_some_and(|f| f.size == size) {
                state.comparison.error = Some((pair, error));
                if let Some(graphics) = &services.graphics {
                    viewport::upload_errors(graphics, size, &map);
                }
            }
        }
        Some(Err(TaskError::Failed(text))) => {
            state.error(format!("the pictures cannot be compared: {text}"));
        }
        Some(Err(TaskError::Cancelled)) | None => {}
    }
}

/// Returns what is drawn over the picture.
pub(super) fn overlay(comparison: &Comparison) -> Overlay {
    match (comparison.is_held, comparison.shows) {
        _ if comparison.full.is_none() => Overlay::None,
        (true, _) => Overlay::Full,
        (_, Compare::Split) => Overlay::RightOf(comparison.split),
        (_, Compare::Errors) if comparison.error.is_some() => Overlay::Errors,
        _ => Overlay::None,
    }
}
