//! Marks of a map over the plan: north, the direction of the sun, and a scale bar.

use super::super::state::AppState;
use afterimage::trace::section::CutPlane;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Ui, Vec2};

const SUN: Color32 = Color32::from_rgb(0xE6, 0x9F, 0x00);

const SECTION: Color32 = Color32::from_rgb(0xD5, 0x5E, 0x00);

/// Length of an arrow in points.
const ARROW: f32 = 16.0;

/// Longest scale bar in points.
const LONGEST_BAR: f32 = 90.0;

/// Shows the marks in the corners of the plan.
pub(super) fn show(ui: &Ui, state: &AppState, rect: Rect, points_per_metre: f64) {
    let painter = ui.painter().with_clip_rect(rect);
    let color = ui.visuals().text_color();
    if let Some(document) = &state.document {
        let now = document.now();
        let turn = now.sun.north_deg.to_radians() as f32;
        let centre = rect.right_top() + egui::vec2(-26.0, 30.0);
        arrow(&painter, centre, egui::vec2(turn.sin(), -turn.cos()), color, "N");
        if let Some(sun) = &now.scene.daylight.sun {
            let flat = egui::vec2(sun.direction.x, sun.direction.z);
            if flat.length() > 1e-3 {
                arrow(&painter, centre - egui::vec2(52.0, 0.0), flat.normalized(), SUN, "sun");
            }
        }
    }
    scale_bar(&painter, rect, points_per_metre, color);
}

/// Draws the upright plane of a section through a point of the plan, and dims what it removes.
pub(super) fn section(painter: &Painter, rect: Rect, plane: CutPlane, at: Pos2) {
    let is_across_x = plane.axis == 0;
    let removed = match (is_across_x, plane.keeps_above) {
        (true, true) => rect.with_max_x(at.x),
        (true, false) => rect.with_min_x(at.x),
        (false, true) => rect.with_max_y(at.y),
        (false, false) => rect.with_min_y(at.y),
    };
    painter.rect_filled(removed.intersect(rect), 0.0, Color32::from_black_alpha(70));
    let ends = match is_across_x {
        true => [Pos2::new(at.x, rect.top()), Pos2::new(at.x, rect.bottom())],
        false => [Pos2::new(rect.left(), at.y), Pos2::new(rect.right(), at.y)],
    };
    painter.extend(Shape::dashed_line(&ends, Stroke::new(1.5, SECTION), 8.0, 4.0));
}

/// Draws an arrow with a word at its tip.
fn arrow(painter: &Painter, centre: Pos2, direction: Vec2, color: Color32, word: &str) {
    let half = direction * (ARROW / 2.0);
    painter.arrow(centre - half, direction * ARROW, Stroke::new(1.5, color));
    let at = centre + direction * (ARROW / 2.0 + 9.0);
    painter.text(at, Align2::CENTER_CENTER, word, FontId::proportional(11.0), color);
}

/// Draws a bar whose length is a round number of metres.
fn scale_bar(painter: &Painter, rect: Rect, points_per_metre: f64, color: Color32) {
    let Some(metres) = bar_metres(points_per_metre) else { return };
    let length = (metres * points_per_metre) as f32;
    let start = rect.left_bottom() + egui::vec2(10.0, -10.0);
    let end = start + egui::vec2(length, 0.0);
    let stroke = Stroke::new(1.5, color);
    painter.line_segment([start, end], stroke);
    for at in [start, end] {
        painter.line_segment([at - egui::vec2(0.0, 3.0), at + egui::vec2(0.0, 3.0)], stroke);
    }
    let at = start + egui::vec2(length / 2.0, -4.0);
    painter.text(at, Align2::CENTER_BOTTOM, format!("{metres} m"), FontId::proportional(11.0), color);
}

/// Returns the longest of 1, 2, 5, 10, ... metres that fits, in either direction.
fn bar_metres(points_per_metre: f64) -> Option<f64> {
    let room = f64::from(LONGEST_BAR) / points_per_metre;
    let tens = 10f64.powf(room.log10().floor());
    let longest = [5.0, 2.0, 1.0].into_iter().map(|n| n * tens).find(|metres| *metres <= room)?;
    (longest.is_finite() && longest > 0.0).then_some(longest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_bar_is_round_and_fits() {
        assert_eq!(bar_metres(10.0), Some(5.0));
        assert_eq!(bar_metres(100.0), Some(0.5));
        assert_eq!(bar_metres(1.0), Some(50.0));
        assert_eq!(bar_metres(f64::NAN), None);
    }
}
