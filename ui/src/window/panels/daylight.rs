//! Sun and sky: the position of the sun by azimuth and elevation, or by place and time.

use super::super::state::{AppState, Change, Command, EditCommand, SunControls};
use super::numbers::Number;
use afterimage::scene::place::PlaceAndTime;
use afterimage::scene::{Daylight, PhysicalSky, PictureSky, Sky, SkyKind, solar::SunPosition};
use egui::{DragValue, Slider, SliderClamping, Ui};

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

/// Kinds of skies, with their names and explanations.
const SKIES: [(SkyKind, &str, &str); 5] = [
    (SkyKind::Gradient, "Gradient", "A clear day, blue above and white at the horizon"),
    (SkyKind::Overcast, "Overcast", "The standard overcast sky of the CIE; the sun is hidden"),
    (SkyKind::Clear, "Clear", "The standard clear sky of the CIE, bright around the sun"),
    (SkyKind::Physical, "Physical", "Sunlight scattered in air and haze (Hosek and Wilkie 2012)"),
    (SkyKind::Picture, "Picture...", "A picture of all directions, .hdr or .exr, twice as wide as high"),
];

/// Shows the controls of the sun and the sky.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(document) = &state.document else {
        ui.weak("No scene yet.");
        return;
    };
    let (now, before) = (&document.scene().daylight, &document.now().sun);
    let (mut has_sun, mut has_sky, mut sun) = (now.sun.is_some(), now.sky.is_some(), before.clone());
    let mut picture = match &now.sky {
        Some(Sky::Picture(sky)) => Some(sky.clone()),
        _ => None,
    };
    ui.horizontal(|ui| {
        ui.checkbox(&mut has_sun, "Sun");
        ui.checkbox(&mut has_sky, "Sky");
    });
    ui.horizontal(|ui| {
        ui.radio_value(&mut sun.is_by_place, false, "By direction");
        ui.radio_value(&mut sun.is_by_place, true, "By place and time");
    });
    ui.spacing_mut().slider_width = 110.0;
    egui::Grid::new("daylight").num_columns(2).min_col_width(84.0).show(ui, |ui| {
        if sun.is_by_place {
            place_rows(ui, &mut sun.place);
        } else {
            direction_rows(ui, &mut sun.direction);
        }
        if sky_rows(ui, &mut sun, picture.as_mut()) {
            commands.push(Command::Edit(EditCommand::BrowseSky));
        }
        let help = "Angle of north, clockwise from the model's -Z (up on the plan) towards its +X";
        slider(ui, "North", help, &mut sun.north_deg, -180.0..=180.0, 0, "°");
    });
    let SunPosition { azimuth_deg, height_deg } = sun.position();
    let place = format!("Sun at azimuth {azimuth_deg:.1}°, elevation {height_deg:.1}°");
    match sun.place.sun() {
        Err(error) if sun.is_by_place => {
            drop(ui.colored_label(ui.visuals().error_fg_color, error.to_string()))
        }
        _ => drop(ui.weak(if height_deg > 0.0 { place } else { format!("{place}: below the horizon") })),
    }
    let mut wanted = daylight(now, before, &sun, [has_sun, has_sky]);
    if let (Some(Sky::Picture(sky)), Some(changed)) = (&mut wanted.sky, picture) {
        *sky = changed;
    }
    if wanted != *now || sun != *before {
        commands.push(Command::Edit(EditCommand::Change(Change::Daylight(wanted, Box::new(sun)))));
    }
}

/// The new daylight. A part that was switched on or moved gets the values of the chosen sky; other
/// parts keep theirs.
fn daylight(
    now: &Daylight,
    before: &SunControls,
    sun: &SunControls,
    [has_sun, has_sky]: [bool; 2],
) -> Daylight {
    let clear = || sun.moved(has_sun, has_sky);
    let is_other_sky = sun.kind != before.kind || sun.turbidity != before.turbidity;
    let is_switched_off = now.sky.is_some() && !has_sky;
    if is_other_sky && !is_switched_off {
        // The clouds of an overcast sky hide a sun, which shines again under another one.
        let was_hidden = before.kind == SkyKind::Overcast && now.sky.is_some();
        return sun.moved(has_sun || was_hidden, true);
    }
    // A sun that was below the horizon rises again if there is a sky.
    let has_moved = sun.position() != before.position() || sun.north_deg != before.north_deg;
    if has_moved && sun.kind == SkyKind::Picture {
        return Daylight { sun: sun.moved(has_sun, false).sun, sky: now.sky.clone().filter(|_| has_sky) };
    }
    if has_moved {
        return Daylight { sun: sun.moved(has_sun || has_sky, false).sun, sky: clear().sky };
    }
    let sun = if has_sun == now.sun.is_some() { now.sun } else { clear().sun };
    let sky = if has_sky == now.sky.is_some() { now.sky.clone() } else { clear().sky };
    Daylight { sun, sky }
}

fn slider(
    ui: &mut Ui,
    name: &str,
    help: &str,
    value: &mut f64,
    range: std::ops::RangeInclusive<f64>,
    decimals: usize,
    unit: &'static str,
) {
    let label = ui.label(name).on_hover_text(help);
    let slider = Number::new(range, decimals, unit).slider(ui, value);
    slider.labelled_by(label.id).on_hover_text(help);
    ui.end_row();
}

/// Shows the kind of the sky and its values. True where the user wants to choose a picture.
fn sky_rows(ui: &mut Ui, sun: &mut SunControls, picture: Option<&mut PictureSky>) -> bool {
    let label = ui.label("Kind of sky");
    let named = |kind| SKIES.iter().find(|(k, ..)| *k == kind).map_or("", |(_, name, _)| *name);
    let shown =
        picture.as_ref().map(|sky| sky.image.file().file_name().unwrap_or_default().to_string_lossy());
    let shown = shown.unwrap_or_else(|| named(sun.kind).into());
    let mut wants_picture = false;
    let combo = egui::ComboBox::from_id_salt("sky").selected_text(&*shown).show_ui(ui, |ui| {
        for (kind, name, help) in SKIES {
            let is_chosen = ui.selectable_label(sun.kind == kind, name).on_hover_text(help).clicked();
            // The kind changes once a picture has been read.
            wants_picture |= is_chosen && kind == SkyKind::Picture;
            if is_chosen && kind != SkyKind::Picture {
                sun.kind = kind;
            }
        }
    });
    combo.response.labelled_by(label.id);
    ui.end_row();
    if sun.kind == SkyKind::Physical {
        let (help, mut turbidity) = ("Turbidity: 2 is very clear, 3 clear, 10 hazy", sun.turbidity.into());
        let range = f64::from(*PhysicalSky::TURBIDITIES.start())..=f64::from(*PhysicalSky::TURBIDITIES.end());
        slider(ui, "Haze", help, &mut turbidity, range, 1, "");
        if turbidity != f64::from(sun.turbidity) {
            sun.turbidity = turbidity as f32;
        }
    }
    if let Some(sky) = picture {
        let [mut rotation, mut stops] =
            [sky.rotation_deg.into(), f64::from(sky.brightness.max(f32::MIN_POSITIVE).log2())];
        let before = [rotation, stops];
        slider(ui, "Rotation", "Turns the picture clockwise", &mut rotation, -180.0..=180.0, 0, "°");
        slider(ui, "Sky brightness", "In stops", &mut stops, -10.0..=10.0, 1, " EV");
        if [rotation, stops] != before {
            (sky.rotation_deg, sky.brightness) = (rotation as f32, stops.exp2() as f32);
        }
    }
    wants_picture
}

fn direction_rows(ui: &mut Ui, direction: &mut SunPosition) {
    slider(
        ui,
        "Azimuth",
        "Clockwise from north: east is 90, south 180",
        &mut direction.azimuth_deg,
        0.0..=360.0,
        0,
        "°",
    );
    slider(ui, "Elevation", "Angle above the horizon", &mut direction.height_deg, -10.0..=90.0, 1, "°");
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
    slider(ui, "Latitude", "Positive in the north", &mut place.latitude_deg, -90.0..=90.0, 2, "°");
    slider(ui, "Longitude", "Positive in the east", &mut place.longitude_deg, -180.0..=180.0, 2, "°");
    date_row(ui, place);
    let help = "Local time of the place, with summer time where its zone has it";
    let label = ui.label("Time of day").on_hover_text(help);
    let mut hours = place.hours;
    let clock = Slider::new(&mut hours, 0.0..=24.0).custom_formatter(|hours, _| clock_text(hours));
    let clock = clock.clamping(SliderClamping::Edits).update_while_editing(false);
    ui.add(clock.custom_parser(clock_hours).step_by(1.0 / 12.0)).labelled_by(label.id).on_hover_text(help);
    // A field that is left without a change sets its own text, in whole minutes.
    if clock_text(hours) != clock_text(place.hours) {
        place.hours = hours;
    }
    ui.end_row();
    let help = "Time zone by its name in the IANA database, such as Europe/Berlin";
    let label = ui.label("Time zone").on_hover_text(help);
    let zone = egui::TextEdit::singleline(&mut place.zone).desired_width(150.0);
    ui.add(zone).labelled_by(label.id).on_hover_text(help);
    ui.end_row();
}

fn date_row(ui: &mut Ui, place: &mut PlaceAndTime) {
    ui.label("Date");
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let years =
            DragValue::new(&mut place.year).range(1950..=2050).custom_formatter(|y, _| format!("{y:.0}"));
        ui.add(years).accessible_name("Year");
        ui.label("-");
        ui.add(DragValue::new(&mut place.month).range(1..=12)).accessible_name("Month");
        ui.label("-");
        let last = days_in(place.year, place.month);
        place.day = place.day.min(last);
        ui.add(DragValue::new(&mut place.day).range(1..=last)).accessible_name("Day");
    });
    ui.end_row();
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

fn clock_text(hours: f64) -> String {
    let minutes = (hours * 60.0).round() as u32;
    format!("{:02}:{:02}", minutes / 60, minutes % 60)
}

fn clock_hours(text: &str) -> Option<f64> {
    let (hours, minutes) = text.split_once(':').unwrap_or((text, "0"));
    Some(hours.trim().parse::<f64>().ok()? + minutes.trim().parse::<f64>().ok()? / 60.0)
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
        assert_eq!((clock_hours("7"), clock_hours("noon")), (Some(7.0), None));
    }

    #[test]
    fn months_have_their_days() {
        assert_eq!(
            [days_in(2024, 2), days_in(2023, 2), days_in(1900, 2), days_in(2000, 2)],
            [29, 28, 28, 29]
        );
        assert_eq!((days_in(2026, 4), days_in(2026, 12)), (30, 31));
    }

    #[test]
    fn only_changed_parts_of_daylight_change() {
        let controls = SunControls::default();
        let own = Daylight { sky: Some(Sky::even(glam::Vec3::X)), sun: None };
        let lit = daylight(&own, &controls, &controls, [true, true]);
        assert!(lit.sun.is_some() && lit.sky == own.sky, "the sky stays");
        let mut moved = controls.clone();
        moved.direction.height_deg = 10.0;
        let evening = daylight(&lit, &controls, &moved, [true, true]);
        assert!(evening.sky != lit.sky && evening.sun != lit.sun);
        assert_eq!(daylight(&lit, &controls, &controls, [false, false]), Daylight::default());
    }

    #[test]
    fn clouds_hide_the_sun_until_another_sky_is_chosen() {
        let controls = SunControls::default();
        let clouded = SunControls { kind: SkyKind::Overcast, ..controls.clone() };
        let clear = controls.moved(true, true);
        let overcast = daylight(&clear, &controls, &clouded, [true, true]);
        assert!(overcast.sun.is_none() && overcast.sky.as_ref().unwrap().kind() == SkyKind::Overcast);
        assert_eq!(daylight(&overcast, &clouded, &controls, [false, true]), clear);
    }
}
