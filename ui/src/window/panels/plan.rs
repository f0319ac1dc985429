//! The plan: a horizontal section of a storey of the model, 1.2 m above its floor, the camera, its
//! path, and the references coloured by their contribution.

use super::super::state::{AppState, Command, InspectCommand};
use super::widgets::choice;
use crate::window::input::keymap::{Action, keys_of};
use crate::window::rendering::exchange::ReferenceInfo;
use crate::window::rendering::floor_plan::{Plan, PlanView};
use afterimage::Camera;
use egui::{Color32, Mesh, Pos2, ProgressBar, Rect, Response, RichText, Sense, Shape, Stroke, Ui};
use glam::{DVec2, DVec3};

/// Height of the plan in points.
const HEIGHT: f32 = 210.0;

/// Maximum distance in points from a reference's position at which a click selects it.
const CLICK_POINTS: f32 = 12.0;

/// Length in points of the wedge that marks a view.
const WEDGE: f32 = 26.0;

/// Fraction of the plan that the model fills at zoom 1.
const MARGIN: f32 = 0.92;

/// Side of the square that stands for a walkable place, metres.
const FLOOR_M: f64 = 0.9;

/// Places whose eyes differ from the height of the cut by more belong to other storeys, metres.
const STOREY_M: f64 = 2.0;

const FLOOR: Color32 = Color32::from_rgb(0x00, 0x9E, 0x73);
const CAMERA: Color32 = Color32::from_rgb(0x56, 0xB4, 0xE9);
const PATH: Color32 = Color32::from_rgb(0xCC, 0x79, 0xA7);

/// Shows the plan and the selected reference.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(plan) = &state.plan.cut else {
        ui.weak(if state.scene.is_some() { "The plan is being computed." } else { "No scene yet." });
        return;
    };
    let size = egui::vec2(ui.available_width(), HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Plan map"));
    let sheet = Sheet::new(plan, &state.plan.view, state.navigation.fly.camera(), rect);
    draw(ui, state, &sheet);
    super::plan_marks::show(ui, state, rect, sheet.points_per_metre);
    steer(ui, state, &sheet, &response, commands);
    storey_choice(ui, state, plan, commands);
    buttons(ui, state, &sheet, commands);
    bake(ui, state, commands);
    selected(ui, state, plan, commands);
}

/// The plan on screen: -Z points up, +X right.
struct Sheet<'a> {
    plan: &'a Plan,
    view: PlanView,
    rect: Rect,
    points_per_metre: f64,
}

impl<'a> Sheet<'a> {
    fn new(plan: &'a Plan, view: &PlanView, camera: &Camera, rect: Rect) -> Self {
        let half = plan.half_extent_m.max(DVec2::splat(1e-3));
        let fit = (f64::from(rect.width()) / half.x).min(f64::from(rect.height()) / half.y) / 2.0;
        let mut view = *view;
        if view.follows {
            view.centre_m = plan.place(camera.eye);
        }
        Self { plan, view, rect, points_per_metre: fit * f64::from(MARGIN) * view.zoom() }
    }

    fn point(&self, place_m: DVec2) -> Pos2 {
        let offset = (place_m - self.view.centre_m) * self.points_per_metre;
        self.rect.center() + egui::vec2(offset.x as f32, offset.y as f32)
    }

    fn place(&self, at: Pos2) -> DVec2 {
        let offset = at - self.rect.center();
        self.view.centre_m + DVec2::new(f64::from(offset.x), f64::from(offset.y)) / self.points_per_metre
    }

    fn eye(&self, camera: &Camera) -> Pos2 {
        self.point(self.plan.place(camera.eye))
    }
}

fn draw(ui: &Ui, state: &AppState, sheet: &Sheet) {
    let painter = ui.painter().with_clip_rect(sheet.rect);
    let is_dark = ui.visuals().dark_mode;
    painter.rect_filled(sheet.rect, 4.0, if is_dark { Color32::from_gray(22) } else { Color32::WHITE });
    painter.add(floor(sheet, &state.plan.floor));
    painter.add(walls(sheet, if is_dark { Color32::from_gray(190) } else { Color32::from_gray(60) }));
    if let Some(section) = state.section().filter(|section| section.plane.axis != 1) {
        let at = sheet.point(sheet.plan.place(DVec3::splat(section.plane.at_m)));
        super::plan_marks::section(&painter, sheet.rect, section.plane, at);
    }
    let keys = &state.path().keyframes;
    let path: Vec<Pos2> = keys.iter().map(|k| sheet.point(sheet.plan.place(k.eye))).collect();
    painter.add(Shape::line(path, Stroke::new(1.5, PATH)));
    for reference in references(state) {
        let is_chosen = state.selection.reference == Some(reference.id);
        wedge(&painter, sheet, &reference.camera, color_of(reference), is_chosen);
    }
    let camera = state.navigation.fly.camera();
    wedge(&painter, sheet, camera, CAMERA, false);
    painter.circle(sheet.eye(camera), 5.0, CAMERA, Stroke::new(1.5, Color32::BLACK));
}

/// The walkable places as one mesh of squares: brighter where stored references light more of what
/// is seen from there. Nothing is shown where no reference is stored.
fn floor(sheet: &Sheet, places: &[(DVec3, f32)]) -> Shape {
    let half = egui::Vec2::splat((FLOOR_M * sheet.points_per_metre / 2.0) as f32);
    let mut mesh = Mesh::default();
    let is_on_floor = |eye: &DVec3| (eye.y - sheet.plan.height_m).abs() < STOREY_M;
    for (eye, share) in places.iter().filter(|(eye, share)| is_on_floor(eye) && *share > 0.0) {
        let centre = sheet.point(sheet.plan.place(*eye));
        let color = FLOOR.gamma_multiply(0.1 + 0.6 * share.clamp(0.0, 1.0));
        mesh.add_colored_rect(Rect::from_min_max(centre - half, centre + half), color);
    }
    Shape::mesh(mesh)
}

/// The walls as one mesh with a thin quad per line; lines outside the plan are culled.
fn walls(sheet: &Sheet, color: Color32) -> Shape {
    const HALF_WIDTH: f32 = 0.6;
    let mut mesh = Mesh::default();
    for line in &sheet.plan.lines {
        let [a, b] = line.map(|[x, z]| sheet.point(DVec2::new(f64::from(x), f64::from(z))));
        if !sheet.rect.intersects(Rect::from_two_pos(a, b).expand(1.0)) {
            continue;
        }
        // A degenerate line becomes a dot.
        let along = if a.distance(b) > 1e-3 { (b - a).normalized() } else { egui::Vec2::X } * HALF_WIDTH;
        let (side, first) = (along.rot90(), mesh.vertices.len() as u32);
        for at in [a - along + side, b + along + side, b + along - side, a - along - side] {
            mesh.colored_vertex(at, color);
        }
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first, first + 2, first + 3);
    }
    Shape::mesh(mesh)
}

/// Draws a view as a wedge from its camera.
fn wedge(painter: &egui::Painter, sheet: &Sheet, camera: &Camera, color: Color32, is_chosen: bool) {
    // An aspect ratio of 1.5 is assumed.
    let half_width = ((camera.fov_y / 2.0).tan() * 1.5).atan();
    let eye = sheet.eye(camera);
    let end = |turn: f64| {
        let yaw = camera.yaw + turn;
        eye + WEDGE * egui::vec2(-yaw.sin() as f32, -yaw.cos() as f32)
    };
    let corners = vec![eye, end(half_width), end(-half_width)];
    let stroke = if is_chosen { Stroke::new(2.5, Color32::WHITE) } else { Stroke::new(1.0, color) };
    painter.add(Shape::convex_polygon(corners, color.gamma_multiply(0.45), stroke));
}

fn references(state: &AppState) -> &[ReferenceInfo] {
    state.frame.as_ref().map_or(&[], |f| &f.references)
}

/// Grey for no contribution, orange for all of it; disabled references are faint.
fn color_of(reference: &ReferenceInfo) -> Color32 {
    const NO_SHARE: Color32 = Color32::from_gray(130);
    const FULL_SHARE: Color32 = Color32::from_rgb(0xE6, 0x9F, 0x00);
    let color = NO_SHARE.lerp_to_gamma(FULL_SHARE, reference.contribution.clamp(0.0, 1.0).sqrt());
    if reference.is_enabled { color } else { color.gamma_multiply(0.25) }
}

fn steer(ui: &Ui, state: &AppState, sheet: &Sheet, response: &Response, commands: &mut Vec<Command>) {
    let mut view = sheet.view;
    if response.dragged() {
        let drag = response.drag_delta();
        view.centre_m -= DVec2::new(f64::from(drag.x), f64::from(drag.y)) / sheet.points_per_metre;
        view.follows = false;
    }
    if let Some(at) = response.hover_pos() {
        // The wheel zooms, and does not scroll the side panel too.
        let turned = ui.input_mut(|i| std::mem::take(&mut i.smooth_scroll_delta).y);
        let factor = ui.input(egui::InputState::zoom_delta) * (turned / POINTS_PER_E).exp();
        if factor != 1.0 {
            view = view.zoomed(f64::from(factor), sheet.place(at));
        }
    }
    if view != sheet.view {
        commands.push(Command::Inspect(InspectCommand::SetPlanView(view)));
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked()) {
        let distance = |r: &&ReferenceInfo| sheet.eye(&r.camera).distance(at);
        let nearest = references(state).iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        match nearest.filter(|r| distance(r) <= CLICK_POINTS) {
            Some(hit) => commands.push(Command::Inspect(InspectCommand::SelectReference(Some(hit.id)))),
            None => commands.push(Command::EaseTo(gone_to(state, sheet, at))),
        }
    }
}

/// Points that the wheel turns for a magnification by e.
const POINTS_PER_E: f32 = 200.0;

/// Height of the eye above the floor after a click, in metres.
const EYE_M: f64 = 1.6;

/// Returns the camera at a place of the plan, at eye height over the floor of its storey.
fn gone_to(state: &AppState, sheet: &Sheet, at: Pos2) -> Camera {
    let camera = *state.navigation.fly.camera();
    let place = sheet.place(at) + sheet.plan.origin_m;
    let height = sheet.plan.floor_m.map_or(camera.eye.y, |floor| floor + EYE_M);
    Camera { eye: DVec3::new(place.x, height, place.y), ..camera }
}

/// Shows the choice of storeys, where there are several.
fn storey_choice(ui: &mut Ui, state: &AppState, plan: &Plan, commands: &mut Vec<Command>) {
    if plan.storeys_m.len() < 2 {
        return;
    }
    let name = |floor: f64| format!("floor at {floor:.1} m");
    let mut chosen = state.plan.storey_m;
    let selected = chosen.map_or("where you are".to_owned(), name);
    let floors = plan.storeys_m.iter().rev().map(|floor| (Some(*floor), name(*floor)));
    let choices = [(None, "where you are".to_owned())].into_iter().chain(floors);
    ui.horizontal(|ui| {
        let label = ui.label("Storey");
        choice(ui, "storey", &selected, &mut chosen, choices).labelled_by(label.id);
    });
    if chosen != state.plan.storey_m {
        commands.push(Command::Inspect(InspectCommand::ShowStorey(chosen)));
    }
}

fn buttons(ui: &mut Ui, state: &AppState, sheet: &Sheet, commands: &mut Vec<Command>) {
    let mut view = state.plan.view;
    ui.horizontal(|ui| {
        if ui.button("+").accessible_name("Zoom in on the plan").clicked() {
            view = sheet.view.zoomed(1.5, sheet.view.centre_m);
        }
        if ui.button("\u{2212}").accessible_name("Zoom out of the plan").clicked() {
            view = sheet.view.zoomed(1.0 / 1.5, sheet.view.centre_m);
        }
        if ui.button("Whole plan").clicked() {
            view = PlanView::default();
        }
        ui.checkbox(&mut view.follows, "Follow camera");
    });
    if view != state.plan.view {
        commands.push(Command::Inspect(InspectCommand::SetPlanView(view)));
    }
}

/// Shows the button that starts or cancels a bake, and its progress.
fn bake(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let text = if state.plan.baking.is_some() { "Cancel" } else { "Bake" };
        let button = ui.button(text).accessible_name(format!("{text} lighting the whole scene"));
        let help = "Light the whole scene while you are at rest, into the store; green shows what is lit";
        if button.on_hover_text(format!("{help} (key {})", keys_of(Action::Bake))).clicked() {
            commands.push(Command::Bake);
        }
        if let Some(progress) = &state.plan.baking {
            let bar = ProgressBar::new(progress.fraction.unwrap_or(0.0));
            ui.add(bar.text(RichText::new(&progress.phase).small()).desired_height(16.0));
        }
    });
}

fn selected(ui: &mut Ui, state: &AppState, plan: &Plan, commands: &mut Vec<Command>) {
    match references(state).iter().find(|r| state.selection.reference == Some(r.id)) {
        None => {
            let height = plan.height_m;
            ui.weak(format!(
                "Section at {height:.1} m. Blue: camera; pink: camera path. Click to go there, or a reference to \
                 select it; drag to pan, wheel to zoom."
            ));
        }
        Some(reference) => super::references::entry(ui, state, reference, "selected reference", commands),
    }
}
