//! Lighting analysis in the window: the scene in which daylight factors are rendered, and the
//! measurement of a work plane.

use super::{AppEvent, Parts};
use crate::window::rendering::{
    Quantity, RenderCommand, TaskError, TaskHandle, background_pool, spawn_activity, spawn_task, take_result,
};
use crate::window::state::{Area, LightingCommand, PlaneSettings};
use crate::work_plane::{MeasuredPlane, Unit};
use afterimage::render::lighting::{
    LightMeter, PlaneArea, PlaneError, PlaneStatistics, Reading, WorkPlane, under_overcast_sky,
};
use afterimage::trace::TraceSettings;
use afterimage::{Camera, Tracer};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Samples of a pass at each point of a work plane.
const PASS_SAMPLES: u32 = 64;

/// Time after which a measurement ends, however large its error is: the error is shown.
const MAX_TIME: Duration = Duration::from_secs(60);

/// Standard error at which a measurement ends, as a share of the reading, at 95 % of the points.
const ERROR: f64 = 0.02;

/// Applies a command about lighting analysis.
pub(super) fn handle_lighting(app: &mut Parts, command: LightingCommand) {
    let lighting = &mut app.state.lighting;
    match command {
        LightingCommand::SetScale(quantity, max) => lighting.set_scale(quantity, max),
        LightingCommand::SetPlane(plane) => lighting.plane = plane,
        LightingCommand::Measure => toggle_measuring(app),
        LightingCommand::SaveTable => save(app, "csv", MeasuredPlane::csv),
        LightingCommand::SaveJson => save(app, "json", |plane| format!("{:#}\n", plane.json())),
    }
}

/// What frames are to show: daylight factors only once their scene is there.
pub(super) fn rendered_quantity(app: &Parts) -> Quantity {
    match app.state.options.quantity {
        Quantity::DaylightFactor if app.current.factors_of.is_none() => Quantity::Picture,
        quantity => quantity,
    }
}

/// Takes over what was made in the background, and begins what is wanted.
pub(super) fn poll_lighting(app: &mut Parts) {
    poll_measuring(app);
    let Some(tracer) = app.current.tracer().cloned() else { return };
    let is_wanted = app.state.options.quantity == Quantity::DaylightFactor;
    match take_result(&mut app.services.overcast) {
        Some(Ok((of, overcast))) if is_wanted && of == tracer.epoch() => {
            show(app, overcast);
            app.current.factors_of = Some(of);
        }
        Some(Err(TaskError::Failed(text))) => {
            app.state.options.quantity = Quantity::Picture;
            app.state.error(format!("daylight factors cannot be shown: {text}"));
        }
        _ => {}
    }
    match (is_wanted, app.current.factors_of) {
        (false, Some(_)) => {
            app.current.factors_of = None;
            show(app, tracer);
        }
        (true, None) if app.services.overcast.is_none() => {
            let wake = app.services.wake.clone();
            app.services.overcast = Some(spawn_activity("overcast", "changing the sky", wake, move |_| {
                Ok((tracer.epoch(), Arc::new(under_overcast_sky(&tracer))))
            }));
        }
        _ => {}
    }
}

/// Renders another state of the scene from now on.
fn show(app: &mut Parts, tracer: Arc<Tracer>) {
    app.services.render.send(RenderCommand::SetTracer(tracer));
    app.state.selection.reference_view = None;
    app.current.sent = None;
}

/// Begins to measure the work plane, or cancels that.
fn toggle_measuring(app: &mut Parts) {
    if app.services.plane.take().is_some() {
        app.state.lighting.measuring = None;
        return app.state.info("measuring was cancelled");
    }
    let Some(tracer) = app.current.tracer().cloned() else {
        return app.state.error("there is no scene yet");
    };
    let (plane, camera) = (app.state.lighting.plane, *app.state.navigation.fly.camera());
    let trace = TraceSettings { samples: PASS_SAMPLES, ..app.state.quality.walk.render.trace };
    let threads = app.services.threads;
    app.services.plane = Some(spawn_task("plane", app.services.wake.clone(), move |task| {
        let pool = background_pool("plane", threads).map_err(TaskError::failed)?;
        pool.install(|| measure(&tracer, plane, &camera, trace, task))
    }));
}

fn measure(
    tracer: &Tracer,
    plane: PlaneSettings,
    camera: &Camera,
    trace: TraceSettings,
    task: &TaskHandle,
) -> Result<MeasuredPlane, TaskError> {
    task.begin("finding the floor")?;
    let sensors = work_plane(tracer, plane, camera).sensors(tracer).map_err(in_window)?;
    let overcast = plane.is_factor.then(|| under_overcast_sky(tracer));
    let mut meter = LightMeter::new(overcast.as_ref().unwrap_or(tracer), sensors, trace);
    let start = Instant::now();
    while start.elapsed() < MAX_TIME && !meter.is_within(ERROR) {
        if !meter.pass(&|| task.is_cancelled()) {
            return Err(TaskError::Cancelled);
        }
        report(&meter.readings(), start.elapsed().as_secs_f64() / MAX_TIME.as_secs_f64(), task);
    }
    let unit = Unit::new(plane.is_factor, tracer.scene().is_photometric);
    let measured = MeasuredPlane::new(meter.sensors().to_vec(), meter.readings(), unit);
    measured.ok_or_else(|| TaskError::failed(PlaneError::NoPoints))
}

/// Reports the error so far. It falls with the square root of the passes.
fn report(readings: &[Reading], of_time: f64, task: &TaskHandle) {
    let Some(statistics) = PlaneStatistics::new(readings) else { return };
    let error = statistics.point_error_percent;
    let known = if error.is_finite() { format!(", \u{b1}{error:.1} % at a point") } else { String::new() };
    // The worst points decide when it ends, so half of the way is left to them.
    let done = (196.0 * ERROR / error.max(1e-9)).powi(2).min(1.0) / 2.0;
    task.report(&format!("measuring{known}"), done.max(of_time).min(1.0) as f32);
}

fn work_plane(tracer: &Tracer, plane: PlaneSettings, camera: &Camera) -> WorkPlane {
    let [low, high] = tracer.scene().building_m;
    let area = match plane.area {
        Area::Room => PlaneArea::Room(camera.eye),
        Area::Floor => {
            PlaneArea::Rectangle { x_m: [low.x, high.x], z_m: [low.z, high.z], above_m: camera.eye.y }
        }
    };
    WorkPlane { height_m: plane.height_m, grid_m: plane.grid_m, margin_m: 0.0, area }
}

/// The message of an error, with the remedy that the window has.
fn in_window(error: PlaneError) -> TaskError {
    TaskError::Failed(match error {
        PlaneError::NoFloor(_) => {
            "there is no floor below you; go into the room and measure again".to_owned()
        }
        PlaneError::NoPoints => {
            "no point of the work plane is free: it lies inside walls or furniture; change its height, or go \
             to a free place"
                .to_owned()
        }
        PlaneError::TooMany | PlaneError::BadNumbers => error.to_string(),
    })
}

fn poll_measuring(app: &mut Parts) {
    let result = take_result(&mut app.services.plane);
    app.state.lighting.measuring = app.services.plane.as_ref().map(|task| task.progress());
    match result {
        Some(Ok(measured)) => {
            app.state.lighting.measured = Some(Arc::new(measured));
            app.state.info("the work plane is measured; the tab Look shows it");
        }
        Some(Err(TaskError::Failed(text))) => app.state.error(text),
        Some(Err(TaskError::Cancelled)) | None => {}
    }
}

/// Saves what was measured in the folder of pictures.
fn save(app: &mut Parts, extension: &'static str, text: fn(&MeasuredPlane) -> String) {
    let Some(measured) = app.state.lighting.measured.clone() else {
        return app.state.error("there is nothing to save; measure the work plane first");
    };
    let destination = app.services.destination(&app.state);
    app.services.spawn("saving the work plane", move || {
        match destination.write_new(extension, text(&measured).as_bytes()) {
            Ok(path) => Ok(AppEvent::Saved(path)),
            Err(Some(error)) => Err(TaskError::failed(error)),
            Err(None) => Err(TaskError::Failed("there is no folder to save in".to_owned())),
        }
    });
}
