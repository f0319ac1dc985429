//! Fields for what is typed. A text counts on Enter or when the field is left, never before: while
//! "18:30" is typed, "1" is no time of day. A field that is left as it was changes nothing.

use egui::{DragValue, Response, Slider, SliderClamping, TextEdit, Ui};
use std::ops::RangeInclusive;

/// A slider for a number with its value as a field. Values between its steps stay as they are
/// until they are changed.
pub fn slider(
    ui: &mut Ui,
    value: &mut f64,
    range: RangeInclusive<f64>,
    decimals: usize,
    unit: &str,
) -> Response {
    let before = *value;
    let slider = Slider::new(value, range).clamping(SliderClamping::Edits).update_while_editing(false);
    let response = ui.add(slider.fixed_decimals(decimals).suffix(unit));
    keep_same(value, before, |v| format!("{v:.decimals$}"));
    response
}

/// A whole number, which can be dragged and typed.
pub fn whole(ui: &mut Ui, value: &mut i32, range: RangeInclusive<i32>) -> Response {
    let field = DragValue::new(value).range(range).speed(0.1).update_while_editing(false);
    ui.add(field.custom_formatter(|v, _| format!("{v:.0}")))
}

/// A length in metres to the centimetre, which can be dragged and typed.
pub fn metres(ui: &mut Ui, value: &mut f64, range: RangeInclusive<f64>) -> Response {
    let before = *value;
    let field = DragValue::new(value).range(range).speed(0.02).update_while_editing(false);
    let response = ui.add(field.clamp_existing_to_range(false).fixed_decimals(2).suffix(" m"));
    keep_same(value, before, |v| format!("{v:.2}"));
    response
}

/// A time of day in hours, shown and typed as hours and minutes.
pub fn clock(ui: &mut Ui, hours: &mut f64) -> Response {
    let before = *hours;
    let field = DragValue::new(hours).range(0.0..=24.0).speed(1.0 / 60.0).update_while_editing(false);
    let field = field.custom_formatter(|hours, _| clock_text(hours)).custom_parser(clock_hours);
    let response = ui.add(field);
    keep_same(hours, before, clock_text);
    response
}

/// A line of text.
pub fn text(ui: &mut Ui, value: &mut String, width: f32) -> Response {
    let id = ui.next_auto_id().with("typed");
    let mut typed = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| value.clone());
    let response = ui.add(TextEdit::singleline(&mut typed).desired_width(width));
    if response.lost_focus() && !ui.input(|i| i.key_pressed(egui::Key::Escape)) {
        typed.trim().clone_into(value);
    }
    // The data are locked while they are changed, so that the focus is read before.
    let is_typing = response.has_focus();
    ui.data_mut(|data| match is_typing {
        true => {
            data.insert_temp(id, typed);
        }
        false => data.remove::<String>(id),
    });
    response
}

/// Puts back a value that looks as before: a field that is left stores what it shows.
fn keep_same(value: &mut f64, before: f64, shown: impl Fn(f64) -> String) {
    if *value != before && shown(*value) == shown(before) {
        *value = before;
    }
}

/// Returns hours and minutes as people write them.
pub fn clock_text(hours: f64) -> String {
    let minutes = (hours * 60.0).round() as u32;
    format!("{:02}:{:02}", minutes / 60, minutes % 60)
}

/// Returns the hours of a time like `18:30`, `18.30`, `18 30`, `1830` or `18`; `None` for other
/// texts.
fn clock_hours(text: &str) -> Option<f64> {
    let text = text.trim();
    let is_digits = text.len() == 4 && text.bytes().all(|b| b.is_ascii_digit());
    let (hours, minutes) = match text.split_once([':', '.', ' ']) {
        Some(parts) => parts,
        None if is_digits => text.split_at(2),
        None => (text, "0"),
    };
    let [hours, minutes] = [hours, minutes].map(|part| part.parse::<u32>().ok());
    Some(f64::from(hours?) + f64::from(minutes.filter(|m| *m < 60)?) / 60.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_formatted_and_parsed_as_hours_and_minutes() {
        for (hours, text) in [(0.0, "00:00"), (9.5, "09:30"), (13.25, "13:15"), (24.0, "24:00")] {
            assert_eq!(clock_text(hours), text);
            assert_eq!(clock_hours(text), Some(hours));
        }
        for text in ["18:30", "18.30", "1830", " 18 30 "] {
            assert_eq!(clock_hours(text), Some(18.5), "{text}");
        }
        for text in ["noon", "", "12:75", "-3", "1e1"] {
            assert_eq!(clock_hours(text), None, "{text}");
        }
        assert_eq!(clock_hours("7"), Some(7.0));
    }

    #[test]
    fn a_value_that_looks_as_before_stays() {
        let mut value = 9.5;
        keep_same(&mut value, 9.501, clock_text);
        assert!((value - 9.501).abs() < 1e-12);
        keep_same(&mut value, 10.0, clock_text);
        assert!((value - 9.501).abs() < 1e-12);
    }
}
