//! Commands about the selected pixel, distance, material and reference; the plan and the
//! thumbnails.

use super::{Parts, Services};
use crate::window::rendering::{
    CUT_M, Plan, ReferenceRadiance, RenderCommand, TaskError, TaskHandle, spawn_task, surface_outline,
    take_result,
};
use crate::window::state::{AppState, Change, Dropper, InspectCommand, ReferenceView, Work};
use afterimage::raster::color;
use glam::DVec3;
use std::sync::Arc;

/// The plan is cut again where the eye is higher or lower than the cut by more than this, in
/// metres: less than the height of a floor, more than a few steps.
const SAME_FLOOR_M: f64 = 0.7;

/// Applies a command about pixels, distances and references.
pub(super) fn handle_inspect(state: &mut AppState, services: &Services, command: InspectCommand) {
    let selection = &mut state.selection;
    match command {
        InspectCommand::CloseInspector => selection.inspection = None,
        InspectCommand::SelectMaterial(id) => match &mut selection.dropper {
            Some(dropper) => dropper.from = Some(id),
            None => selection.material = Some(id),
        },
        InspectCommand::ToggleDropper(into) => {
            let is_on = selection.dropper.take().is_some();
            selection.measure.switch(false);
            selection.dropper = (!is_on).then_some(Dropper { into, from: None });
        }
        InspectCommand::SelectObject(key) => selection.object = Some(key),
        InspectCommand::ToggleMeasure => {
            selection.dropper = None;
            selection.measure.switch(!selection.measure.is_on);
        }
        InspectCommand::ClearMeasures => change_measures(state, Vec::clear),
        InspectCommand::RemoveMeasure(index) => change_measures(state, |measures| {
            if index < measures.len() {
                measures.remove(index);
            }
        }),
        InspectCommand::SelectReference(id) => selection.reference = id,
        InspectCommand::EnableReference(id, is_enabled) => {
            services.render.send(RenderCommand::Enable(id, is_enabled));
        }
        InspectCommand::ShowReference(id) => {
            services.render.send(RenderCommand::ShowReference(id));
        }
        InspectCommand::CloseReference => selection.reference_view = None,
        InspectCommand::SetPlanView(view) => state.plan.view = view,
        InspectCommand::ShowStorey(floor_m) => (state.plan.storey_m, state.plan.asked_m) = (floor_m, None),
        InspectCommand::FilterReport(text) => selection.report_filter = text,
    }
}

/// Changes the distances in one step, which can be undone.
fn change_measures(state: &mut AppState, change: impl FnOnce(&mut Vec<[DVec3; 2]>)) {
    let Some(document) = &mut state.document else { return };
    let mut measures = document.now().measures.clone();
    change(&mut measures);
    document.change(Change::Measures(measures));
}

/// Finds the outline of the surface that was clicked, off the window's thread.
pub(super) fn update_outline(app: &mut Parts) {
    let selection = &mut app.state.selection;
    let wanted = selection.inspection.as_ref().map(|found| found.triangle);
    match take_result(&mut app.services.outline) {
        Some(Ok((triangle, lines))) => selection.outline = Some((triangle, Arc::new(lines))),
        // Without an outline, the triangle is drawn.
        Some(Err(_)) => selection.outline = wanted.map(|triangle| (triangle, Arc::default())),
        None => {}
    }
    if selection.outline.as_ref().map(|(triangle, _)| *triangle) == wanted {
        return;
    }
    let (Some(triangle), Some(tracer), None) = (wanted, app.current.tracer(), &app.services.outline) else {
        selection.outline = selection.outline.take().filter(|_| wanted.is_some());
        return;
    };
    let scene = tracer.scene().clone();
    let find = move |_: &TaskHandle| Ok((triangle, surface_outline(&scene, triangle)));
    app.services.outline = Some(spawn_task("outline", app.services.wake.clone(), find));
}

/// Shows a plan that was cut, and cuts one where the camera is on another floor.
pub(super) fn update_plan(app: &mut Parts) {
    match take_result(&mut app.services.plan) {
        Some(Ok(plan)) => app.state.plan.cut = Some(Arc::new(plan)),
        Some(Err(TaskError::Failed(text))) => app.state.error(format!("the plan cannot be cut: {text}")),
        Some(Err(TaskError::Cancelled)) | None => {}
    }
    let (Some(tracer), None) = (app.current.tracer(), &app.services.plan) else { return };
    let (eye_m, storey_m) = (app.state.navigation.fly.camera().eye.y, app.state.plan.storey_m);
    let wanted_m = storey_m.map_or(eye_m, |floor| floor + CUT_M);
    // A cut that failed is not tried again on the same floor.
    let is_on_floor = |asked_m: f64| (asked_m - wanted_m).abs() <= SAME_FLOOR_M;
    if app.state.plan.asked_m.is_some_and(is_on_floor) || app.state.work == Work::Moving {
        return;
    }
    app.state.plan.asked_m = Some(wanted_m);
    let scene = tracer.scene().clone();
    app.services.plan = Some(spawn_task("plan", app.services.wake.clone(), move |_| {
        Ok(Plan::of_storey(&scene, storey_m, eye_m))
    }));
}

/// Traces small pictures of all views and references while the renderer is idle.
pub(super) fn update_thumbnails(state: &mut AppState, services: &Services) {
    state.thumbnails.poll(&services.ctx);
    if matches!(state.work, Work::Complete | Work::Refining | Work::Converged | Work::Paused) {
        let views = state.document.iter().flat_map(|d| d.now().views.iter().map(|v| &v.camera));
        let references = state.frame.iter().flat_map(|f| f.references.iter().map(|r| &r.camera));
        let exposure_ev = state.exposure_ev();
        state.thumbnails.request(views.chain(references), exposure_ev, &services.wake);
    }
}

/// Shows the light that a reference holds, with the exposure of the viewport.
pub(super) fn show_reference(state: &mut AppState, services: &Services, reference: &ReferenceRadiance) {
    let Some(radiance) = &reference.radiance else {
        return state.info(format!("reference {} is no longer held", reference.id.0));
    };
    let (exposure_ev, tone_map) = (state.exposure_ev(), state.quality.tone_map);
    let size = reference.size.map(|s| s as usize);
    // Pixels without light are grey and hatched.
    let pixels = radiance.iter().enumerate().map(|(i, light)| match light {
        Some(light) => color::srgb8(*light, exposure_ev, tone_map),
        None => [if (i % size[0] + i / size[0]) % 8 < 2 { 52 } else { 38 }; 3],
    });
    let image = egui::ColorImage::from_rgb(size, &pixels.flatten().collect::<Vec<u8>>());
    let texture = services.ctx.load_texture("reference", image, egui::TextureOptions::LINEAR);
    let lit = radiance.iter().flatten().count() as f32 / radiance.len().max(1) as f32;
    let view = ReferenceView { id: reference.id, camera: reference.camera, lit, texture };
    state.selection.reference_view = Some(view);
}
