//! Lighting analysis as a user meets it: quantities by key, the value under the cursor, and the work
//! plane.

use super::{
    app, app_saving_to, app_with_graphics, open, request, says, settle, show_tab, small_room, step_until,
    viewport_centre,
};
use afterimage::raster::false_color::color;
use afterimage::render::lighting::SurfaceLight;
use afterimage::trace::{TraceSettings, parallel::NEVER};
use afterimage::{Mode, Tracer};
use afterimage_ui::window::input::keymap::{Action, Chord};
use afterimage_ui::window::rendering::PublishedFrame;
use afterimage_ui::window::rendering::quantity::Quantity;
use afterimage_ui::window::state::{AppState, Compare};
use afterimage_ui::window::{App, panels};
use egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

type Window = Harness<'static, App>;

const KEYS: [Key; 5] = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];

fn state(window: &Window) -> &AppState {
    window.state().state()
}

fn frame(window: &Window) -> &PublishedFrame {
    state(window).frame.as_ref().expect("a frame")
}

/// Presses the key of a quantity and waits until it is shown.
fn show(window: &mut Window, quantity: Quantity) {
    window.key_press_modifiers(Modifiers::SHIFT, KEYS[quantity as usize]);
    window.run_steps(2);
    assert_eq!(state(window).options.quantity, quantity);
    step_until(window, "another quantity", |app| app.state().shown_quantity() == quantity);
    settle(window);
}

/// Presses a key of a quantity and checks that it is chosen; false for other actions.
pub(super) fn chooses(window: &mut Window, action: Action, chord: Chord) -> bool {
    let Some(place) = panels::lighting::ACTIONS.iter().position(|shown| *shown == action) else {
        return false;
    };
    for (key, quantity) in [(chord.key, Quantity::ALL[place]), (KEYS[0], Quantity::Picture)] {
        window.key_press_modifiers(Modifiers::SHIFT, key);
        window.run_steps(2);
        assert_eq!(state(window).options.quantity, quantity);
    }
    true
}

fn values(window: &Window) -> Vec<Option<f32>> {
    let frame = frame(window);
    frame.radiance.iter().map(|packed| frame.values.value(*packed)).collect()
}

fn mean(values: impl Iterator<Item = f32>) -> f64 {
    let values: Vec<f64> = values.map(f64::from).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn illuminance_is_that_of_the_engine_and_mirrors_have_none() {
    let mut launch = request();
    launch.settings.render.trace.samples = 16;
    let mut window = open(launch.clone(), false);
    show(&mut window, Quantity::Illuminance);
    let tracer = Tracer::new(small_room());
    let trace = TraceSettings { samples: 64, ..launch.settings.render.trace };
    let shown = frame(&window);
    let truth = SurfaceLight::trace(&tracer, &shown.camera, shown.size, &trace, NEVER).expect("the light");
    let lux = truth.lux(tracer.scene().nits_per_unit());
    let both = values(&window).into_iter().zip(&lux).filter_map(|(v, l)| Some((v?, *l)));
    // Next to a lamp there is more light than a frame can hold.
    let pairs: Vec<(f32, f32)> =
        both.filter(|(_, l)| l.is_finite()).map(|(v, l)| (v.min(5e4), l.min(5e4))).collect();
    let ratio = mean(pairs.iter().map(|p| p.0)) / mean(pairs.iter().map(|p| p.1));
    assert!((ratio - 1.0).abs() < 0.03, "{ratio} over {} pixels", pairs.len());
    assert!(pairs.len() * 3 > lux.len(), "{} of {} pixels have a value", pairs.len(), lux.len());
    let mirrors = values(&window).iter().zip(&lux).filter(|(v, l)| v.is_none() && l.is_nan()).count();
    assert_eq!(mirrors, lux.iter().filter(|l| l.is_nan()).count(), "what has no value shows none");
    assert!(shown.values.is_relative, "the lamps of the room have no photometric units");
    assert_eq!(state(&window).quality.walk.render.mode, Mode::Paper, "the mode of pictures stays");
}

#[test]
fn luminance_is_the_picture_before_exposure_and_each_key_goes_back() {
    let mut window = app();
    let picture = frame(&window).radiance.clone();
    show(&mut window, Quantity::Luminance);
    let nits = small_room().nits_per_unit();
    let luminance = |packed: &u32| {
        let color = afterimage::raster::rgb9e5::unpack(*packed);
        afterimage::raster::color::luminance(color) * nits
    };
    let ratio = mean(values(&window).into_iter().flatten()) / mean(picture.iter().map(luminance));
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    show(&mut window, Quantity::Clay);
    show(&mut window, Quantity::Picture);
    assert!(values(&window).iter().all(Option::is_none));
}

#[test]
fn daylight_factors_replace_the_light_of_the_scene_until_the_picture_is_back() {
    let mut window = app();
    let before = mean(frame(&window).radiance.iter().map(|p| afterimage::raster::rgb9e5::unpack(*p).y));
    show(&mut window, Quantity::DaylightFactor);
    // A pixel may be noisy; the mean of all is below that of the open ground.
    assert!(values(&window).into_iter().flatten().all(|factor| (0.0..200.0).contains(&factor)));
    assert!(mean(values(&window).into_iter().flatten()) < 100.0);
    assert!(!frame(&window).values.is_relative, "a ratio needs no units");
    show(&mut window, Quantity::Picture);
    let after = mean(frame(&window).radiance.iter().map(|p| afterimage::raster::rgb9e5::unpack(*p).y));
    assert!((after / before - 1.0).abs() < 0.05, "{before} {after}");
}

#[test]
fn the_legend_names_the_scale_and_the_value_at_the_cursor() {
    let mut window = app();
    show(&mut window, Quantity::Illuminance);
    window.hover_at(viewport_centre(&window) + vec2(-100.0, 60.0));
    window.run_steps(3);
    let value = state(&window).value_at_cursor().expect("a wall");
    let node = window.get_by_label_contains("at the cursor").accesskit_node();
    let text = node.label().or(node.value()).unwrap_or_default();
    let first: f32 = text.split(' ').next().and_then(|word| word.parse().ok()).expect("a number");
    assert!((first / value - 1.0).abs() < 0.01 && text.contains("lx"), "{text} for {value}");
    window.get_by_label_contains("relative: the lights of the model");
    let max = state(&window).lighting.max_of(Quantity::Illuminance).expect("a scale");
    window.get_by_label(&format!("scale from 0 to {max}"));
    // A comparison is one of pictures.
    window.key_press(Key::C);
    window.run_steps(2);
    assert_eq!(state(&window).options.quantity, Quantity::Picture);
    window.key_press_modifiers(Modifiers::SHIFT, Key::Num2);
    window.run_steps(2);
    assert_eq!(state(&window).comparison.shows, Compare::Off);
}

#[test]
fn a_scale_is_typed_and_automatic_again() {
    let mut window = app();
    show(&mut window, Quantity::Illuminance);
    show_tab(&mut window, "Look");
    let automatic = state(&window).lighting.max_of(Quantity::Illuminance);
    window.get_by_label("Automatic scale").click_accesskit();
    window.run_steps(2);
    assert_eq!(state(&window).lighting.chosen(Quantity::Illuminance), automatic);
    window.get_by_label("Automatic scale").click_accesskit();
    window.run_steps(2);
    assert_eq!(state(&window).lighting.chosen(Quantity::Illuminance), None);
    window.get_by_label("Lines of equal value").click_accesskit();
    window.run_steps(2);
    assert!(state(&window).options.has_isolines);
}

#[test]
fn a_work_plane_is_measured_and_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = app_saving_to(folder.path().to_owned());
    show_tab(&mut window, "Look");
    window.get_by_label("Measure the work plane").click_accesskit();
    step_until(&mut window, "a measurement", |app| app.state().lighting.measured.is_some());
    let measured = state(&window).lighting.measured.clone().expect("a measurement");
    assert!(measured.statistics.mean_lux > 0.0 && measured.statistics.error_percent < 2.0);
    window.run_steps(3);
    window.get_by_label("uniformity");
    for (button, extension) in
        [("Save CSV of the work plane", "csv"), ("Save JSON of the work plane", "json")]
    {
        window.get_by_label(button).click_accesskit();
        step_until(&mut window, "a file", |app| says(app, &format!(".{extension}")));
        let is_wanted = |entry: &std::fs::DirEntry| entry.path().extension().is_some_and(|e| e == extension);
        let file = std::fs::read_dir(folder.path()).expect("the folder").flatten().find(is_wanted);
        let text = std::fs::read_to_string(file.expect("a file").path()).expect("a text");
        let lines = measured.sensors.len() + 1;
        assert!(extension == "json" || text.lines().count() == lines, "{text}");
        assert!(extension == "csv" || text.contains("\"mean_lux\""), "{text}");
    }
}

#[test]
fn values_are_drawn_and_saved_in_their_colours() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut window) = app_with_graphics() else { return };
    show(&mut window, Quantity::Illuminance);
    let at = viewport_centre(&window) + vec2(-100.0, 60.0);
    window.hover_at(at);
    window.run_steps(3);
    let value = state(&window).value_at_cursor().expect("a wall");
    let max = state(&window).lighting.max_of(Quantity::Illuminance).expect("a scale");
    let image = window.render().expect("a picture of the window");
    let shown = image.get_pixel(at.x as u32, at.y as u32).0;
    let expected = color(value / max);
    let distance = (0..3).map(|c| shown[c].abs_diff(expected[c])).max();
    assert!(distance < Some(30), "{shown:?} for {expected:?}");
    drop(window);
    let mut window = app_saving_to(folder.path().to_owned());
    show(&mut window, Quantity::Illuminance);
    let size = frame(&window).size;
    window.key_press(Key::F12);
    step_until(&mut window, "a picture", |app| says(app, ".png"));
    let file = std::fs::read_dir(folder.path()).expect("the folder").flatten().next().expect("a file").path();
    let saved = afterimage::raster::load::Picture::load(&file).expect("a picture").size;
    assert!(saved[0] > size[0] && saved[1] == size[1], "the legend stands beside the picture");
}
