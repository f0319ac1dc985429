//! The rows of the sun's place and time: a slider through day and night with sunrise and sunset.

use super::clock::clock_text;
use super::numbers::Number;
use super::widgets::text_field;
use afterimage::scene::place::{PlaceAndTime, SunTimes};
use egui::{Color32, Pos2, Rect, Slider, Ui};

/// Suggested places: name, latitude and longitude in degrees, time zone.
const PLACES: [(&str, f64, f64, &str); 8] = [
    ("Berlin", 52.52, 13.40, "Europe/Berlin"),
    ("London", 51.51, -0.13, "Europe/London"),
    ("Madrid", 40.42, -3.70, "Europe/Madrid"),
    ("Nairobi", -1.29, 36.82, "Africa/Nairobi"),
    ("New York", 40.71, -74.01, "America/New_York"),
    ("S\u{e3}o Paulo", -23.55, -46.63, "America/Sao_Paulo"),
    ("Sydney", -33.87, 151.21, "Australia/Sydney"),
    ("Tokyo", 35.68, 139.69, "Asia/Tokyo"),
];

/// Days of a sun study: month and name.
const DAYS: [(u32, &str, &str); 3] = [
    (3, "21 Mar", "Day and night are equally long"),
    (6, "21 Jun", "The longest day in the north"),
    (12, "21 Dec", "The shortest day in the north"),
];

/// Steps of the slider of the time, in hours.
const STEP_HOURS: f64 = 1.0 / 12.0;

/// Shows the rows of place, date and time in a grid of two columns.
pub(super) fn rows(ui: &mut Ui, place: &mut PlaceAndTime) {
    place_rows(ui, place);
    date_rows(ui, place);
    time_rows(ui, place);
    let help = "Time zone by its name in the IANA database, such as Europe/Berlin";
    let label = ui.label("Time zone").on_hover_text(help);
    let field = text_field(ui, "time zone", &place.zone, |field| field.desired_width(150.0));
    field.response.labelled_by(label.id).on_hover_text(help);
    if let Some(zone) = field.entered {
        zone.trim().clone_into(&mut place.zone);
    }
    ui.end_row();
}

fn place_rows(ui: &mut Ui, place: &mut PlaceAndTime) {
    let label = ui.label("Place");
    let is_at = |p: &PlaceAndTime, lat: f64, lon: f64| p.latitude_deg == lat && p.longitude_deg == lon;
    let known = PLACES.iter().find(|(_, lat, lon, _)| is_at(place, *lat, *lon)).map_or("custom", |p| p.0);
    let combo = egui::ComboBox::from_id_salt("place").selected_text(known).show_ui(ui, |ui| {
        for (name, latitude_deg, longitude_deg, zone) in PLACES {
            if ui.selectable_label(known == name, name).clicked() {
                (place.latitude_deg, place.longitude_deg) = (latitude_deg, longitude_deg);
                zone.clone_into(&mut place.zone);
            }
        }
    });
    combo.response.labelled_by(label.id);
    ui.end_row();
    for (name, help, value, limit) in [
        ("Latitude", "Positive in the north", &mut place.latitude_deg, 90.0),
        ("Longitude", "Positive in the east", &mut place.longitude_deg, 180.0),
    ] {
        let label = ui.label(name).on_hover_text(help);
        let number = Number::new(-limit..=limit, 2, "\u{b0}");
        number.slider(ui, value).labelled_by(label.id).on_hover_text(help);
        ui.end_row();
    }
}

fn date_rows(ui: &mut Ui, place: &mut PlaceAndTime) {
    ui.label("Date");
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        whole(1950..=2050).field(ui, "", &mut place.year).accessible_name("Year");
        ui.label("-");
        part(ui, "Month", &mut place.month, 12);
        ui.label("-");
        part(ui, "Day", &mut place.day, days_in(place.year, place.month));
    });
    ui.end_row();
    ui.label("");
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for (month, name, help) in DAYS {
            let is_it = (place.month, place.day) == (month, 21);
            if ui.selectable_label(is_it, name).on_hover_text(help).clicked() {
                (place.month, place.day) = (month, 21);
            }
        }
        if ui.selectable_label(place.hours == 12.0, "12:00").on_hover_text("Noon by the clocks").clicked() {
            place.hours = 12.0;
        }
    });
    ui.end_row();
}

/// A month or a day.
fn part(ui: &mut Ui, name: &str, value: &mut u32, max: u32) {
    *value = (*value).min(max);
    whole(1..=max).field(ui, "", value).accessible_name(name);
}

/// A whole number, ten points of dragging a step.
fn whole<T: Into<f64>>(range: std::ops::RangeInclusive<T>) -> Number {
    let (low, high) = range.into_inner();
    Number::new(low.into()..=high.into(), 0, "").speed(0.1)
}

fn time_rows(ui: &mut Ui, place: &mut PlaceAndTime) {
    let times = sun_times(ui, place);
    let help =
        "Local time of the place, with summer time where its zone has it. Night is dark on the slider.";
    let label = ui.label("Time of day").on_hover_text(help);
    ui.horizontal(|ui| {
        let before = place.hours;
        let slider = Slider::new(&mut place.hours, 0.0..=24.0).show_value(false).step_by(STEP_HOURS);
        let response = ui.add(slider.clamping(egui::SliderClamping::Edits));
        let response = response.labelled_by(label.id).on_hover_text(help);
        if !response.changed() {
            place.hours = before;
        }
        night(ui, response.rect, times);
        Number::clock().field(ui, "", &mut place.hours).accessible_name("Time");
        ui.weak(place.clock_name());
    });
    ui.end_row();
    ui.label("");
    ui.weak(times_text(times));
    ui.end_row();
}

/// Returns sunrise and sunset, which are computed again only where place or date have changed.
fn sun_times(ui: &Ui, place: &PlaceAndTime) -> Option<SunTimes> {
    let id = egui::Id::unique("sun times");
    let day = PlaceAndTime { hours: 0.0, ..place.clone() };
    let known = ui.data(|data| data.get_temp::<(PlaceAndTime, Option<SunTimes>)>(id));
    if let Some((_, times)) = known.filter(|(of, _)| *of == day) {
        return times;
    }
    let times = day.sun_times().ok();
    ui.data_mut(|data| data.insert_temp(id, (day, times)));
    times
}

fn times_text(times: Option<SunTimes>) -> String {
    let clock = |hours: Option<f64>| hours.map_or("none".to_owned(), clock_text);
    match times {
        Some(SunTimes::Changes { sunrise, sunset }) => {
            format!("Sunrise {}, sunset {}", clock(sunrise), clock(sunset))
        }
        Some(SunTimes::AlwaysUp) => "The sun is up all day.".to_owned(),
        Some(SunTimes::AlwaysDown) => "The sun does not rise.".to_owned(),
        None => String::new(),
    }
}

/// Draws a dark line under the hours of the night, with ticks at sunrise and sunset.
fn night(ui: &Ui, rect: Rect, times: Option<SunTimes>) {
    // As far as the handle of the slider goes.
    let hours = rect.x_range().shrink(rect.height() / 2.5);
    let x = |at: f64| egui::lerp(hours.min..=hours.max, (at / 24.0) as f32);
    let (dark, y) = (Color32::from_rgb(0x46, 0x5a, 0xa0), rect.bottom() - 1.0);
    let stroke = egui::Stroke::new(2.0, dark);
    let line = |from: f64, to: f64| {
        ui.painter().hline(x(from)..=x(to), y, stroke);
    };
    match times {
        Some(SunTimes::Changes { sunrise, sunset }) => {
            for at in [sunrise, sunset].into_iter().flatten() {
                ui.painter().line_segment([Pos2::new(x(at), y - 4.0), Pos2::new(x(at), y)], stroke);
            }
            nights(sunrise, sunset).into_iter().for_each(|[from, to]| line(from, to));
        }
        Some(SunTimes::AlwaysDown) => line(0.0, 24.0),
        Some(SunTimes::AlwaysUp) | None => {}
    }
}

/// Returns the hours without the sun, from and to.
fn nights(sunrise: Option<f64>, sunset: Option<f64>) -> Vec<[f64; 2]> {
    match (sunrise, sunset) {
        (Some(up), Some(down)) if down < up => vec![[down, up]],
        (up, down) => {
            let before = up.map(|up| [0.0, up]);
            before.into_iter().chain(down.map(|down| [down, 24.0])).collect()
        }
    }
}

fn days_in(year: i32, month: u32) -> u32 {
    let is_leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    match month {
        2 if is_leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn months_have_their_days() {
        assert_eq!(
            [days_in(2024, 2), days_in(2023, 2), days_in(1900, 2), days_in(2000, 2)],
            [29, 28, 28, 29]
        );
        assert_eq!((days_in(2026, 4), days_in(2026, 12)), (30, 31));
    }

    #[test]
    fn the_night_is_before_sunrise_and_after_sunset() {
        assert_eq!(nights(Some(5.0), Some(21.0)), [[0.0, 5.0], [21.0, 24.0]]);
        // Far in the north, the sun may set after midnight.
        assert_eq!(nights(Some(2.0), Some(0.5)), [[0.5, 2.0]]);
        assert_eq!(nights(None, Some(23.0)), [[23.0, 24.0]]);
    }
}
