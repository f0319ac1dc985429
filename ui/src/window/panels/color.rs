//! A button for a colour, with hue, saturation, brightness and a hex field in its popup.

use super::numbers::Number;
use super::widgets::text_field;
use egui::{Color32, Popup, PopupCloseBehavior, Response, Ui, ecolor::HsvaGamma};
use glam::Vec3;

/// Shows a button in a colour, linear Rec. 709. It opens the controls. The colour keeps all its
/// digits until the user changes it; then it is one of 8 bits a channel.
pub fn color_button(ui: &mut Ui, name: &str, color: &mut Vec3) -> Response {
    let shown = shown(*color);
    let size = egui::vec2(ui.spacing().interact_size.x, ui.spacing().interact_size.y);
    let button = egui::Button::new("").fill(shown).min_size(size).stroke(ui.visuals().window_stroke);
    let mut response = ui.add(button);
    let hex = hex_text(shown);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ColorWell, true, format!("{name} {hex}")));
    let popup = Popup::menu(&response).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let chosen = popup.show(|ui| controls(ui, shown)).map_or(shown, |popup| popup.inner);
    if chosen != shown {
        let linear = egui::Rgba::from(chosen);
        *color = Vec3::new(linear.r(), linear.g(), linear.b());
        response.mark_changed();
    }
    response
}

/// The colour as the screen shows it.
fn shown(color: Vec3) -> Color32 {
    let color = color.clamp(Vec3::ZERO, Vec3::ONE);
    egui::Rgba::from_rgb(color.x, color.y, color.z).into()
}

fn controls(ui: &mut Ui, shown: Color32) -> Color32 {
    let mut chosen = shown;
    ui.spacing_mut().slider_width = 150.0;
    egui::Grid::new("colour").num_columns(2).show(ui, |ui| {
        let parts = hue_rows(ui, shown);
        chosen = Color32::from(parts);
        let label = ui.label("Hex");
        let field = text_field(ui, "colour as hex", &hex_text(shown), |field| field.desired_width(80.0));
        field.response.labelled_by(label.id);
        chosen = field.entered.as_deref().and_then(parse_hex).unwrap_or(chosen);
        ui.end_row();
    });
    chosen
}

/// Shows hue, saturation and brightness. They are remembered while they give the shown colour: the
/// hue of grey follows from no colour.
fn hue_rows(ui: &mut Ui, shown: Color32) -> HsvaGamma {
    let id = ui.scope_id().with("hue");
    let remembered: Option<HsvaGamma> = ui.data(|data| data.get_temp(id));
    let mut parts =
        remembered.filter(|parts| Color32::from(*parts) == shown).unwrap_or_else(|| HsvaGamma::from(shown));
    let rows = [
        ("Hue", &mut parts.h, 360.0, "°"),
        ("Saturation", &mut parts.s, 100.0, " %"),
        ("Brightness", &mut parts.v, 100.0, " %"),
    ];
    for (name, part, most, unit) in rows {
        let label = ui.label(name);
        let mut number = f64::from(*part) * most;
        if Number::new(0.0..=most, 0, unit).slider(ui, &mut number).labelled_by(label.id).changed() {
            *part = (number / most) as f32;
        }
        ui.end_row();
    }
    ui.data_mut(|data| data.insert_temp(id, parts));
    parts
}

/// A colour as six hex digits, such as `#C8A060`.
pub fn hex_text(color: Color32) -> String {
    format!("#{:02X}{:02X}{:02X}", color.r(), color.g(), color.b())
}

/// Parses three or six hex digits, with or without `#`.
pub fn parse_hex(text: &str) -> Option<Color32> {
    let digits = text.trim().trim_start_matches('#');
    let is_hex = digits.bytes().all(|b| b.is_ascii_hexdigit());
    let number = u32::from_str_radix(digits, 16).ok().filter(|_| is_hex)?;
    let byte = |shift: u32| (number >> shift & 0xFF) as u8;
    let double = |shift: u32| (number >> shift & 0xF) as u8 * 17;
    match digits.len() {
        6 => Some(Color32::from_rgb(byte(16), byte(8), byte(0))),
        3 => Some(Color32::from_rgb(double(8), double(4), double(0))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_colours_are_read_and_written() {
        for color in [Color32::BLACK, Color32::WHITE, Color32::from_rgb(200, 160, 96)] {
            assert_eq!(parse_hex(&hex_text(color)), Some(color));
        }
        assert_eq!(parse_hex(" c8a "), Some(Color32::from_rgb(0xCC, 0x88, 0xAA)));
        for wrong in ["", "#", "12", "#12345G", "+12345", "1234567"] {
            assert_eq!(parse_hex(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn hue_saturation_and_brightness_give_every_colour_back() {
        for i in 0..4096u32 {
            let byte = |shift: u32| ((i >> shift & 0xF) * 17) as u8;
            let color = Color32::from_rgb(byte(8), byte(4), byte(0));
            assert_eq!(Color32::from(HsvaGamma::from(color)), color);
        }
    }
}
