//! What is drawn over the picture: the inspected triangle, what is measured, a reference that is looked through.

use super::super::state::{AppState, Measure, ReferenceView, SnapKind};
use crate::window::gpu::projection::Projection;
use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, Ui};
use glam::DVec3;

/// Seen on dark and bright pictures alike: every line has a dark one under it.
const LINE: Color32 = Color32::from_rgb(0xFF, 0xD2, 0x3F);
const UNDER: Color32 = Color32::from_black_alpha(190);

/// Draws over the viewport.
pub fn show(ui: &Ui, viewport: Rect, state: &AppState) {
    if let Some(lent) = &state.selection.reference_view {
        return lent_picture(ui, viewport, lent);
    }
    let painter = ui.painter().with_clip_rect(viewport);
    let projection = Projection::new(state.navigation.fly.camera(), viewport);
    if let Some(found) = &state.selection.inspection {
        let [a, b, c] = found.corners_m;
        [[a, b], [b, c], [c, a]].into_iter().for_each(|edge| line(&painter, &projection, edge, 1.5));
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

/// A square on a vertex, a diamond on an edge, a ring on a surface.
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

/// As large as fits, with what it is.
fn lent_picture(ui: &Ui, viewport: Rect, lent: &ReferenceView) {
    let painter = ui.painter().with_clip_rect(viewport);
    painter.rect_filled(viewport, 0.0, Color32::from_gray(24));
    let size = lent.texture.size_vec2();
    let scale = (viewport.width() / size.x).min(viewport.height() / size.y);
    let rect = Rect::from_center_size(viewport.center(), size * scale);
    let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
    painter.image(lent.texture.id(), rect, whole, Color32::WHITE);
    let share = lent.lit * 100.0;
    let text = format!(
        "Reference {}: holds light for {share:.0} % of its pixels; hatched is lent by others. Esc goes back.",
        lent.id.0
    );
    let room = viewport.width() - 24.0;
    let galley = painter.layout(text, FontId::proportional(14.0), Color32::WHITE, room);
    let centre = viewport.center_bottom() - egui::vec2(0.0, 14.0 + galley.size().y / 2.0);
    let ground = Rect::from_center_size(centre, galley.size() + egui::vec2(16.0, 10.0));
    painter.rect_filled(ground, 4.0, UNDER);
    painter.galley(ground.min + egui::vec2(8.0, 5.0), galley, Color32::WHITE);
}
