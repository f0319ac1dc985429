//! Drawings over the picture: the inspected triangle, measurements, and the view of a reference.

use super::super::state::{AppState, Measure, ReferenceView, SnapKind};
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
    if let Some(found) = &state.selection.inspection {
        let [a, b, c] = found.corners_m;
        for edge in [[a, b], [b, c], [c, a]] {
            line(&painter, &projection, edge, 1.5);
        }
    }
    measured(&painter, &projection, &state.selection.measure);
}

fn line(painter: &egui::Painter, projection: &Projection, ends_m: [DVec3; 2], width: f32) {
    if let Some(ends) = projection.segment(ends_m) {
        painter.line_segment(ends, Stroke::new(width + 2.0, UNDER));
        painter.line_segment(ends, Stroke::new(width, LINE));
    }
}

fn measured(painter: &egui::Painter, projection: &Projection, measure: &Measure) {
    if let Some(ends) = measure.ends() {
        line(painter, projection, ends, 2.0);
        if let Some([a, b]) = projection.segment(ends) {
            let text = format!("{:.3} m", ends[0].distance(ends[1]));
            label(painter, a + (b - a) / 2.0 - egui::vec2(0.0, 14.0), &text);
        }
    }
    let hover = measure.hover.as_ref().filter(|_| measure.is_on);
    for snap in measure.points.iter().chain(hover) {
        if let Some(at) = projection.point(snap.position_m) {
            mark(painter, at, snap.kind);
        }
    }
}

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
