//! Drawings over the picture: the inspected triangle, measurements, and the view of a reference.

use super::super::state::{AppState, ReferenceView, SnapKind};
use crate::window::gpu::projection::Projection;
use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, Ui};
use glam::DVec3;

/// Colour of lines. Each has a dark outline, so that it is visible on dark and bright pictures.
const LINE: Color32 = Color32::from_rgb(0xFF, 0xD2, 0x3F);
const UNDER: Color32 = Color32::from_black_alpha(190);

/// Draws triangle, measurements and the shown reference over the viewport.
pub fn show(ui: &Ui, viewport: Rect, state: &AppState) {
    if let Some(view) = &state.selection.reference_view {
        return reference_view(ui, viewport, view);
    }
    let painter = ui.painter().with_clip_rect(viewport);
    let projection = Projection::new(state.navigation.fly.camera(), viewport);
    selected(&painter, &projection, state);
    measured(&painter, &projection, state);
}

/// Draws the outline of the selected surface, and a dot at the point that was clicked. Until the
/// outline is found, the triangle is drawn.
fn selected(painter: &egui::Painter, projection: &Projection, state: &AppState) {
    let Some(found) = &state.selection.inspection else { return };
    match state
        .selection
        .outline
        .as_ref()
        .filter(|(triangle, lines)| *triangle == found.triangle && !lines.is_empty())
    {
        Some((_, lines)) => {
            for edge in lines.iter() {
                line(painter, projection, *edge, 1.5);
            }
        }
        None => {
            let [a, b, c] = found.corners_m;
            for edge in [[a, b], [b, c], [c, a]] {
                line(painter, projection, edge, 1.5);
            }
        }
    }
    if let Some(at) = projection.point(found.position_m) {
        painter.circle(at, 4.0, LINE, Stroke::new(1.5, UNDER));
    }
}

fn line(painter: &egui::Painter, projection: &Projection, ends_m: [DVec3; 2], width: f32) {
    if let Some(ends) = projection.segment(ends_m) {
        painter.line_segment(ends, Stroke::new(width + 2.0, UNDER));
        painter.line_segment(ends, Stroke::new(width, LINE));
    }
}

/// Draws the distances of the document and the one that is being measured.
fn measured(painter: &egui::Painter, projection: &Projection, state: &AppState) {
    let measure = &state.selection.measure;
    let kept = state.document.as_ref().map_or(&[][..], |document| &document.now().measures);
    for ends in kept.iter().copied().chain(measure.ends()) {
        line(painter, projection, ends, 2.0);
        if let Some([a, b]) = projection.segment(ends) {
            let text = format!("{:.3} m", ends[0].distance(ends[1]));
            label(painter, a + (b - a) / 2.0 - egui::vec2(0.0, 14.0), &text);
        }
    }
    let hover = measure.hover.as_ref().filter(|_| measure.is_on);
    for snap in measure.first.iter().chain(hover) {
        if let Some(at) = projection.point(snap.position_m) {
            mark(painter, at, snap.kind);
        }
    }
}

/// Says what a click does while distances are measured, or a material is picked; `None` otherwise.
fn mode_text(state: &AppState) -> Option<String> {
    let measure = &state.selection.measure;
    if let Some(dropper) = state.selection.dropper {
        let materials = state.document.as_ref().map_or(&[][..], |document| &document.scene().materials);
        let name = materials.get(dropper.into.0 as usize).map_or("the material", |m| &m.name);
        return Some(format!("Click the surface that {name} shall look like; Esc ends"));
    }
    let which = if measure.first.is_none() { "first" } else { "second" };
    measure.is_on.then(|| format!("Measuring: click the {which} point; Esc ends"))
}

/// Says over the viewport what a click does.
pub fn banner(ctx: &egui::Context, viewport: Rect, state: &AppState) {
    let Some(text) = mode_text(state) else { return };
    let at = viewport.center_top() + egui::vec2(0.0, BANNER_DOWN);
    let area = egui::Area::new(egui::Id::unique("measuring")).fixed_pos(at).pivot(Align2::CENTER_TOP);
    area.interactable(false).show(ctx, |ui| {
        super::statistics::ground().show(ui, |ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
            ui.label(egui::RichText::new(text).color(LINE).strong());
        });
    });
}

/// Distance in points of the banner from the top of the viewport: the progress of a picture that is
/// being saved fits above it.
const BANNER_DOWN: f32 = 84.0;

/// Marks a point: a square on a vertex, a diamond on an edge, a ring on a surface.
fn mark(painter: &egui::Painter, at: Pos2, kind: SnapKind) {
    let around = |points: [(f32, f32); 4]| {
        let corners = points.map(|(x, y)| at + egui::vec2(x, y)).to_vec();
        painter.add(egui::Shape::closed_line(corners.clone(), Stroke::new(4.0, UNDER)));
        painter.add(egui::Shape::closed_line(corners, Stroke::new(2.0, LINE)));
    };
    match kind {
        SnapKind::Vertex => around([(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)]),
        SnapKind::Edge => around([(-6.0, 0.0), (0.0, -6.0), (6.0, 0.0), (0.0, 6.0)]),
        SnapKind::Surface => {
            painter.circle_stroke(at, 4.5, Stroke::new(4.0, UNDER));
            painter.circle_stroke(at, 4.5, Stroke::new(2.0, LINE));
        }
    }
}

fn label(painter: &egui::Painter, at: Pos2, text: &str) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(15.0), Color32::WHITE);
    let rect = Align2::CENTER_CENTER.anchor_size(at, galley.size() + egui::vec2(12.0, 6.0));
    painter.rect_filled(rect, 4.0, UNDER);
    painter.galley(rect.min + egui::vec2(6.0, 3.0), galley, Color32::WHITE);
}

/// Shows a reference as large as fits, with a description.
fn reference_view(ui: &Ui, viewport: Rect, view: &ReferenceView) {
    let painter = ui.painter().with_clip_rect(viewport);
    painter.rect_filled(viewport, 0.0, Color32::from_gray(24));
    let size = view.texture.size_vec2();
    let scale = (viewport.width() / size.x).min(viewport.height() / size.y);
    let rect = Rect::from_center_size(viewport.center(), size * scale);
    let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
    painter.image(view.texture.id(), rect, whole, Color32::WHITE);
    let share = view.lit * 100.0;
    let text = format!(
        "Reference {}: contains the light of {share:.0} % of its pixels; hatched pixels reuse other references. \
         Esc closes this view.",
        view.id.0
    );
    let room = viewport.width() - 24.0;
    let galley = painter.layout(text, FontId::proportional(14.0), Color32::WHITE, room);
    let centre = viewport.center_bottom() - egui::vec2(0.0, 14.0 + galley.size().y / 2.0);
    let ground = Rect::from_center_size(centre, galley.size() + egui::vec2(16.0, 10.0));
    painter.rect_filled(ground, 4.0, UNDER);
    painter.galley(ground.min + egui::vec2(8.0, 5.0), galley, Color32::WHITE);
}
