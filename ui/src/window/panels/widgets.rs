//! Small widgets and colours that several panels share.

use crate::window::input::keymap::{Action, keys_of};
use crate::window::{state::AppState, state::FILLED_COLOR};
use afterimage::raster::pixel_types::TYPE_SRGB;
use egui::{Color32, Ui, Widget as _};

/// Names of the pixel types 1, 2 and 3.
pub const TYPE_NAMES: [&str; 3] = ["Type 1, reused", "Type 2, mirror or glass", "Type 3, traced"];

/// Name of the first stage of a frame: references are selected, the surface of each pixel is found,
/// and the light known for it is looked up.
pub const FIRST_STAGE: &str = "visibility + lookup";

/// Text colour, legible on the dark background over any picture.
pub const TEXT: Color32 = Color32::from_gray(235);

/// Dark, translucent background of texts over the picture.
pub const GROUND: Color32 = Color32::from_rgba_premultiplied(0, 0, 0, 185);

/// Colour of a pixel type, 0 for Type 1; numbers above 2 give the colour of filled pixels.
pub fn type_color(number: usize) -> Color32 {
    TYPE_SRGB.get(number).map_or(FILLED_COLOR, |&[r, g, b]| Color32::from_rgb(r, g, b))
}

/// Adjusts egui's style: contrast of labels is raised to 4.5 : 1 against the panel, and small text
/// is enlarged to be legible at arm's length.
pub fn install_style(ctx: &egui::Context) {
    ctx.all_styles_mut(|style| {
        if let Some(small) = style.text_styles.get_mut(&egui::TextStyle::Small) {
            small.size = 10.5;
        }
        let visuals = &mut style.visuals;
        let gray = if visuals.dark_mode { 190 } else { 50 };
        visuals.widgets.noninteractive.fg_stroke.color = Color32::from_gray(gray);
        visuals.weak_text_alpha = 0.8;
    });
}

/// A number with what it counts, such as `1 light` or `2,000 lights`.
pub fn counted(count: usize, what: &str) -> String {
    format!("{} {what}{}", grouped(count), if count == 1 { "" } else { "s" })
}

/// A number with digits in groups of three, such as 1,234,567.
pub fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Hover text that names the key of an action.
pub fn key_hint(action: Action) -> String {
    format!("Key {}", keys_of(action))
}

/// A combo box for a value; `selected` is the text of the current choice.
pub fn choice<T: PartialEq, N: Into<egui::WidgetText>>(
    ui: &mut Ui,
    id: &str,
    selected: &str,
    value: &mut T,
    choices: impl IntoIterator<Item = (T, N)>,
) -> egui::Response {
    let combo = egui::ComboBox::from_id_salt(id).selected_text(selected).width(118.0);
    let menu = |ui: &mut Ui| {
        for (choice, name) in choices {
            // A key that chooses an entry does not close the list by itself.
            if ui.selectable_value(value, choice, name.into()).clicked() {
                ui.close();
            }
        }
    };
    combo.show_ui(ui, menu).response
}

/// A text field, and what was entered in it.
pub struct TextField {
    /// Response of the field.
    pub response: egui::Response,
    /// The text, where it is finished and another one than before.
    pub entered: Option<String>,
}

/// Shows a text field whose text counts on Enter or when the field is left; Escape drops it. `look`
/// sets width and hint.
pub fn text_field(
    ui: &mut Ui,
    name: &str,
    before: &str,
    look: impl FnOnce(egui::TextEdit<'_>) -> egui::TextEdit<'_>,
) -> TextField {
    let id = ui.scope_id().with(name);
    let draft: Option<String> = ui.data_mut(|data| data.remove_temp(id));
    let mut text = draft.unwrap_or_else(|| before.to_owned());
    let response = look(egui::TextEdit::singleline(&mut text)).ui(ui);
    let is_dropped = ui.input(|i| i.key_pressed(egui::Key::Escape));
    let is_finished = response.lost_focus() && !is_dropped && text != before;
    if response.has_focus() && text != before {
        ui.data_mut(|data| data.insert_temp(id, text.clone()));
    }
    TextField { response, entered: is_finished.then_some(text) }
}

/// A small picture of the view of a camera; grey until it is rendered.
pub fn thumbnail(ui: &mut Ui, state: &AppState, camera: &afterimage::Camera) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(egui::vec2(72.0, 45.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 3.0, Color32::from_gray(70));
    if let Some(texture) = state.thumbnails.of(camera) {
        egui::Image::new(texture).corner_radius(3.0).paint_at(ui, rect);
    }
    response
}

/// A small square in the colour of a type, with the numbers of [`type_color`]. It is hatched from
/// Type 3 on.
pub fn swatch(ui: &mut Ui, number: usize) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(14.0, 14.0), egui::Sense::hover());
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 2.0, type_color(number));
    if number >= 2 {
        let stroke = egui::Stroke::new(1.5, Color32::from_rgb(0x70, 0x30, 0x00));
        for step in 0..6 {
            let x = rect.left() + step as f32 * 5.0;
            let end = egui::pos2(x - rect.height(), rect.bottom());
            painter.line_segment([egui::pos2(x, rect.top()), end], stroke);
        }
    }
}

/// A time in words, such as `about 12 s` or `about 3 min`.
pub fn about(secs: f64) -> String {
    match secs {
        s if s < 1.0 => "less than 1 s".to_owned(),
        s if s < 90.0 => format!("about {s:.0} s"),
        s if s < 5400.0 => format!("about {:.0} min", s / 60.0),
        s => format!("about {:.1} h", s / 3600.0),
    }
}
