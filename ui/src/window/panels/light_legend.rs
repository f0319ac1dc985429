//! The legend of a quantity: what it is, a bar of its colours with numbers, and the value under the
//! cursor.

use super::statistics;
use super::widgets::TEXT;
use crate::window::rendering::Quantity;
use crate::window::state::AppState;
use afterimage::raster::false_color::{color, line_step};
use afterimage::raster::legend::number;
use egui::{Align2, Color32, FontId, Pos2, Rect, RichText, Ui, vec2};

/// Size of the bar, points.
const BAR: egui::Vec2 = vec2(240.0, 12.0);

/// Pieces in which the bar is drawn.
const PIECES: usize = 60;

/// Shows the legend over the viewport, at the lower right of `room`. Drags go through it.
pub fn over_viewport(ctx: &egui::Context, room: Rect, state: &AppState) {
    let area = egui::Area::new(egui::Id::unique("light legend")).pivot(Align2::RIGHT_BOTTOM);
    area.fixed_pos(room.right_bottom()).interactable(false).show(ctx, |ui| {
        statistics::ground().show(ui, |ui| {
            ui.style_mut().interaction.selectable_labels = false;
            ui.spacing_mut().item_spacing.y = 4.0;
            show(ui, state);
        });
    });
}

fn show(ui: &mut Ui, state: &AppState) {
    let quantity = state.options.quantity;
    ui.label(RichText::new(title(quantity)).color(TEXT).strong());
    if state.shown_quantity() != quantity {
        ui.label(RichText::new("being rendered").color(TEXT));
        return;
    }
    let Some(max) = state.lighting.max_of(quantity) else { return };
    bar(ui, max);
    ui.label(RichText::new(value_text(state)).color(TEXT).monospace());
    if state.frame.as_ref().is_some_and(|frame| frame.values.is_relative) {
        let text = "relative: the lights of the model have no photometric units";
        ui.label(RichText::new(text).color(TEXT).small());
    }
}

/// Name and unit.
fn title(quantity: Quantity) -> String {
    match quantity.unit() {
        "" => quantity.name().to_owned(),
        unit => format!("{}, {unit}", quantity.name()),
    }
}

/// The value under the cursor, in words.
pub fn value_text(state: &AppState) -> String {
    let unit = state.options.quantity.unit();
    match state.value_at_cursor() {
        Some(value) => format!("{} {unit} at the cursor", three_digits(value)),
        None if state.lighting.cursor.is_some() => "no value at the cursor".to_owned(),
        None => "point at a surface for its value".to_owned(),
    }
}

/// A value with about three digits: more would be noise.
fn three_digits(value: f32) -> String {
    match value {
        v if v >= 100.0 => {
            let step = 10f32.powf(v.log10().floor() - 2.0);
            format!("{:.0}", (v / step).round() * step)
        }
        v if v >= 10.0 => format!("{v:.1}"),
        v if v >= 0.1 => format!("{v:.2}"),
        v => format!("{v:.4}"),
    }
}

/// Draws the colours of the scale with round numbers below.
fn bar(ui: &mut Ui, max: f32) {
    let font = FontId::proportional(11.0);
    let (rect, response) = ui.allocate_exact_size(vec2(BAR.x + 26.0, BAR.y + 17.0), egui::Sense::hover());
    let name = format!("scale from 0 to {}", number(max));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
    let painter = ui.painter();
    let left = rect.left() + 4.0;
    for piece in 0..PIECES {
        let [from, to] = [piece, piece + 1].map(|i| left + BAR.x * i as f32 / PIECES as f32);
        let [r, g, b] = color((piece as f32 + 0.5) / PIECES as f32);
        let piece = Rect::from_min_max(Pos2::new(from, rect.top()), Pos2::new(to, rect.top() + BAR.y));
        painter.rect_filled(piece, 0.0, Color32::from_rgb(r, g, b));
    }
    let every = line_step(max) * if max / line_step(max) > 6.0 { 2.0 } else { 1.0 };
    let mut value = 0.0;
    while value <= max * 1.0001 {
        let x = left + BAR.x * value / max;
        let at = Pos2::new(x, rect.top() + BAR.y);
        painter.line_segment([at, at + vec2(0.0, 3.0)], egui::Stroke::new(1.0, TEXT));
        let align = if value == 0.0 { Align2::LEFT_TOP } else { Align2::CENTER_TOP };
        let nudge = if value == 0.0 { -4.0 } else { 0.0 };
        painter.text(at + vec2(nudge, 4.0), align, number(value), font.clone(), TEXT);
        value += every;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_three_digits() {
        for (value, text) in
            [(31_234.0, "31200"), (312.4, "312"), (31.24, "31.2"), (0.512, "0.51"), (0.0, "0.0000")]
        {
            assert_eq!(three_digits(value), text);
        }
    }
}
