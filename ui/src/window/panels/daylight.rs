//! Sun and sky: the position of the sun by azimuth and elevation, or by place and time.

use super::super::state::{AppState, Change, Command, EditCommand, ListCommand, Purpose, SunControls};
use super::{numbers::Number, sun_time};
use afterimage::scene::{Daylight, GroundAdvice, PhysicalSky, PictureSky, Sky, SkyKind, solar::SunPosition};
use egui::Ui;

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
    let mut sun = before.clone();
    let mut picture = match &now.sky {
        Some(Sky::Picture(sky)) => Some(sky.clone()),
        _ => None,
    };
    ui.horizontal(|ui| {
        ui.checkbox(&mut sun.has_sun, "Sun");
        ui.checkbox(&mut sun.has_sky, "Sky");
    });
    if sun.has_sky && !before.has_sky && sun.kind == SkyKind::Picture {
        // The picture was left with the sky that was switched off.
        sun.kind = SkyKind::default();
    }
    position_choice(ui, &mut sun);
    ui.spacing_mut().slider_width = 110.0;
    egui::Grid::new("daylight").num_columns(2).min_col_width(84.0).show(ui, |ui| {
        if sun.is_by_place {
            sun_time::rows(ui, &mut sun.place);
        } else {
            direction_rows(ui, &mut sun.direction);
        }
        if sky_rows(ui, &mut sun, picture.as_mut()) {
            commands.push(Command::List(ListCommand::Ask(Purpose::Sky)));
        }
        let help = "Angle of north, clockwise from the model's -Z (up on the plan) towards its +X";
        slider(ui, "North", help, &mut sun.north_deg, -180.0..=180.0, 0, "°");
    });
    describe(ui, &sun);
    ground_rows(ui, state, commands);
    push_changes((now, before), sun, picture, commands);
}

/// Shows the choice between a direction and a place and time. A sun that is set by direction from
/// now on stays where it stands.
fn position_choice(ui: &mut Ui, sun: &mut SunControls) {
    let by_place = sun.is_by_place.then(|| sun.position());
    ui.horizontal(|ui| {
        ui.radio_value(&mut sun.is_by_place, false, "By direction");
        ui.radio_value(&mut sun.is_by_place, true, "By place and time");
    });
    if let Some(position) = by_place.filter(|_| !sun.is_by_place) {
        sun.direction = position;
    }
}

/// Says where the sun stands, and why there is none.
fn describe(ui: &mut Ui, sun: &SunControls) {
    if let Some(error) = sun.place.sun().err().filter(|_| sun.is_by_place) {
        ui.colored_label(ui.visuals().error_fg_color, error.to_string());
        return;
    }
    let SunPosition { azimuth_deg, height_deg } = sun.position();
    ui.weak(format!("Sun at azimuth {azimuth_deg:.1}°, elevation {height_deg:.1}°"));
    if !sun.words().is_empty() {
        ui.label(sun.words());
    }
}

/// Shows the ground: whether there is one, its height, and why.
fn ground_rows(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (Some(document), Some(scene)) = (&state.document, &state.scene) else { return };
    let now = document.scene().ground;
    let (mut ground, mut has_ground) = (now.unwrap_or(scene.lowest_ground), now.is_some());
    let help = "A level ground that takes shadows and light, and that you can stand on";
    ui.checkbox(&mut has_ground, "Ground").on_hover_text(help);
    if has_ground {
        egui::Grid::new("ground").num_columns(2).min_col_width(84.0).show(ui, |ui| {
            let reach = scene.reach_m();
            let range = scene.lowest_ground.height_m - reach..=scene.lowest_ground.height_m + reach;
            let label = ui.label("Ground height").on_hover_text("Height in metres, as the model has it");
            let number = Number::new(range, 2, " m").speed(0.02);
            number.field(ui, "", &mut ground.height_m).labelled_by(label.id);
            ui.end_row();
        });
    }
    ui.weak(match scene.ground_advice {
        GroundAdvice::Wanted => "The model has no ground of its own.",
        GroundAdvice::HasOwn => "The model has a ground of its own.",
        GroundAdvice::NoDaylight => "Without sun and sky, a ground stays dark.",
    });
    let wanted = has_ground.then_some(ground);
    if wanted != now {
        commands.push(Command::Edit(EditCommand::Change(Change::Ground(wanted))));
    }
}

/// Pushes the commands for what was changed.
fn push_changes(
    (now, before): (&Daylight, &SunControls),
    sun: SunControls,
    picture: Option<PictureSky>,
    commands: &mut Vec<Command>,
) {
    let mut wanted = if sun == *before { now.clone() } else { sun.changed(before, now) };
    if let (Some(Sky::Picture(sky)), Some(changed)) = (&mut wanted.sky, picture) {
        *sky = changed;
    }
    if wanted != *now || sun != *before {
        commands.push(Command::Edit(EditCommand::Change(Change::Daylight(wanted, Box::new(sun)))));
    }
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
    Number::new(range, decimals, unit).slider(ui, value).labelled_by(label.id).on_hover_text(help);
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
