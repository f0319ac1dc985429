//! Settings of saved pictures, and the progress of saving one.

use super::super::state::{
    AppState, Command, ListCommand, PictureCommand, PictureFormat, PictureQuality, PictureSettings,
    PictureSize, Purpose,
};
use super::numbers::Number;
use super::panorama;
use super::regions::{self, Region};
use super::widgets::{about, choice, key_hint};
use crate::picture::LONGEST_SIDE;
use crate::picture::film::rays_of;
use crate::window::input::keymap::Action;
use crate::window::input::playback::{film_frames, path_secs};
use crate::window::rendering::task::Progress;
use afterimage::raster::film::FilmQuality;
use afterimage::{Mode, render::bands::Background};
use egui::{Align2, Color32, ProgressBar, Rect, RichText, Ui};

/// Suggested sizes in pixels.
const SIZES: [(&str, [u32; 2]); 5] = [
    ("Full HD, 1920 x 1080", [1920, 1080]),
    ("4K, 3840 x 2160", [3840, 2160]),
    ("A4 at 300 dpi, 3508 x 2480", [3508, 2480]),
    ("A3 at 300 dpi, 4961 x 3508", [4961, 3508]),
    ("16K, 16384 x 9216", [16384, 9216]),
];

/// Shows the settings in a window; the scene remains visible and usable.
pub fn show(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let mut is_open = true;
    let shown = egui::Window::new("Picture settings")
        .open(&mut is_open)
        .resizable(false)
        .default_pos([40.0, 60.0])
        .show(ctx, |ui| {
            regions::name(ui, Region::Dialog);
            let mut settings = state.picture.settings.clone();
            egui::Grid::new("picture").num_columns(2).spacing([12.0, 6.0]).show(ui, |ui| {
                size_rows(ui, &mut settings);
                rendering_rows(ui, state, &mut settings);
                file_rows(ui, state, &mut settings, commands);
            });
            film_rows(ui, state, &mut settings);
            panorama::rows(ui, state, &mut settings, commands);
            if settings != state.picture.settings {
                commands.push(Command::Picture(PictureCommand::Set(settings)));
            }
            ui.separator();
            buttons(ui, state, commands);
        });
    if let Some(shown) = shown {
        regions::note_rect(ctx, Region::Dialog, shown.response.rect);
    }
    if !is_open {
        commands.push(Command::Picture(PictureCommand::ShowDialog(false)));
    }
}

fn size_rows(ui: &mut Ui, settings: &mut PictureSettings) {
    let label = ui.label("Size");
    let sizes = SIZES.map(|(name, size)| (PictureSize::Pixels(size), name));
    let sizes = [&[(PictureSize::Viewport, "Viewport size")], &sizes[..]].concat();
    let name = sizes.iter().find(|(size, _)| *size == settings.size).map_or("Custom size", |(_, name)| name);
    let size = choice(ui, "picture size", name, &mut settings.size, sizes.iter().copied());
    regions::note(&size.labelled_by(label.id), Region::Dialog);
    ui.end_row();
    let PictureSize::Pixels([mut width, mut height]) = settings.size else { return };
    ui.label("Pixels");
    ui.horizontal(|ui| {
        for (side, name) in [(&mut width, "Picture width"), (&mut height, "Picture height")] {
            let number = Number::new(1.0..=f64::from(LONGEST_SIDE), 0, "").speed(8.0);
            number.field(ui, "", side).accessible_name(name);
        }
    });
    settings.size = PictureSize::Pixels([width, height]);
    ui.end_row();
}

fn rendering_rows(ui: &mut Ui, state: &AppState, settings: &mut PictureSettings) {
    let label = ui.label("Mode");
    let modes = [
        (Mode::Full, "full: ray tracing with anti-aliasing"),
        (Mode::Exact, "exact, from the current references"),
        (Mode::Fast, "fast, from the current references"),
        (Mode::Paper, "paper, from the current references"),
    ];
    choice(ui, "picture mode", settings.mode.name(), &mut settings.mode, modes).labelled_by(label.id);
    ui.end_row();
    let label = ui.label("Samples");
    let window_samples = state.quality.walk.render.trace.samples;
    let mut samples = settings.samples.unwrap_or(window_samples);
    let number = Number::new(1.0..=65536.0, 0, "");
    let help =
        "Samples per pixel for each light and for scattered light; with anti-aliasing, per primary ray";
    if number.field(ui, "", &mut samples).labelled_by(label.id).on_hover_text(help).changed() {
        settings.samples = Some(samples);
    }
    ui.end_row();
    ui.label("Quality");
    quality_row(ui, state, settings);
    ui.end_row();
    let label = ui.label("Anti-aliasing");
    let number = Number::new(1.0..=4096.0, 0, " rays per pixel");
    let field = |ui: &mut Ui| number.field(ui, "", &mut settings.antialias);
    ui.add_enabled_ui(settings.mode == Mode::Full, field).inner.labelled_by(label.id);
    ui.end_row();
}

/// Shows Draft, Good and Best, and the time that a picture will take.
fn quality_row(ui: &mut Ui, state: &AppState, settings: &mut PictureSettings) {
    let is_full = settings.mode == Mode::Full;
    ui.add_enabled_ui(is_full, |ui| {
        ui.horizontal(|ui| {
            for (quality, name) in PictureQuality::ALL {
                let is_chosen = settings.antialias == quality.antialias();
                let of_quality = PictureSettings { antialias: quality.antialias(), ..settings.clone() };
                let help = format!(
                    "{} rays per pixel, {}",
                    quality.antialias(),
                    time_text(state, picture_samples(state, &of_quality))
                );
                if ui.selectable_label(is_chosen, name).on_hover_text(help).clicked() {
                    settings.antialias = quality.antialias();
                }
            }
        });
    });
    if is_full {
        ui.end_row();
        ui.label("Time");
        ui.label(time_text(state, picture_samples(state, settings)));
    }
}

/// Size of the picture in pixels.
fn picture_size(state: &AppState, settings: &PictureSettings) -> [u32; 2] {
    match settings.size {
        PictureSize::Viewport => state.viewport_size,
        PictureSize::Pixels(size) => size,
    }
}

/// Number of samples of a picture.
fn picture_samples(state: &AppState, settings: &PictureSettings) -> f64 {
    let pixels: f64 = picture_size(state, settings).map(f64::from).iter().product();
    let samples = settings.samples.unwrap_or(state.quality.walk.render.trace.samples);
    pixels * f64::from(settings.antialias) * f64::from(samples)
}

fn time_text(state: &AppState, samples: f64) -> String {
    let secs = state.picture.expected_secs(samples);
    secs.map_or("measured with the first picture".to_owned(), about)
}

/// Shows the settings of films, and how long one will take.
fn film_rows(ui: &mut Ui, state: &AppState, settings: &mut PictureSettings) {
    ui.separator();
    ui.horizontal(|ui| {
        let label = ui.label("Film of the camera path");
        let rates = [24, 25, 30, 50, 60].map(|rate| (rate, format!("{rate} pictures a second")));
        let name = format!("{} pictures a second", settings.film_rate);
        choice(ui, "film rate", &name, &mut settings.film_rate, rates).labelled_by(label.id);
    });
    let mut is_left_out = settings.film_background == Background::LeftOut;
    let help = "Numbered pictures are transparent there; a film (MP4) shows the sky always";
    ui.checkbox(&mut is_left_out, "film without sky").on_hover_text(help);
    settings.film_background = if is_left_out { Background::LeftOut } else { Background::Shown };
    ui.horizontal(|ui| {
        ui.label("Film (MP4)");
        for (quality, name) in FilmQuality::ALL {
            let help = format!("{} rays a pixel", rays_of(quality));
            let button = ui.selectable_value(&mut settings.film_quality, quality, name).on_hover_text(help);
            button.accessible_name(format!("Film quality {name}"));
        }
    });
    let path = state.path();
    if path.keyframes.len() > 1 {
        let count = film_frames(path, settings.film_rate);
        let samples = picture_samples(state, settings) * f64::from(count);
        let (secs, time) = (path_secs(path), time_text(state, samples));
        let film = film_time(state, settings, count);
        ui.weak(format!("{secs:.1} s of film, {count} pictures; time: {time}; as MP4: {film}"));
    } else {
        ui.weak(format!("A film needs a path of two keys or more ({}).", key_hint(Action::AddPathKey)));
    }
}

/// The time that a film of a number of frames will take, in words.
fn film_time(state: &AppState, settings: &PictureSettings, frames: u32) -> String {
    let pixels: f64 = picture_size(state, settings).map(f64::from).iter().product();
    let rays = pixels * f64::from(frames) * f64::from(rays_of(settings.film_quality));
    let secs = state.picture.secs_per_film_ray.map(|secs| secs * rays);
    secs.map_or("measured with the first film".to_owned(), about)
}

/// Dims what the picture will not show, while the dialog is open.
pub fn dim_outside(ui: &Ui, viewport: Rect, state: &AppState) {
    let [width, height] = picture_size(state, &state.picture.settings).map(|side| side.max(1) as f32);
    // The height of the view is the same, whatever the width.
    let side = (viewport.width() - viewport.height() * width / height) / 2.0;
    if side > 0.5 {
        let painter = ui.painter().with_clip_rect(viewport);
        let (left, right) = (viewport.left() + side, viewport.right() - side);
        for strip in [viewport.with_max_x(left), viewport.with_min_x(right)] {
            painter.rect_filled(strip, 0.0, Color32::from_black_alpha(150));
        }
    }
}

fn file_rows(ui: &mut Ui, state: &AppState, settings: &mut PictureSettings, commands: &mut Vec<Command>) {
    ui.label("File");
    ui.vertical(|ui| {
        let help = "Display-referred, tone-mapped";
        ui.radio_value(&mut settings.format, PictureFormat::Png, "PNG, 8 bits").on_hover_text(help);
        ui.horizontal(|ui| {
            let help = "Small files, with losses that are hardly seen; without sky it is saved as PNG";
            ui.radio_value(&mut settings.format, PictureFormat::Jpeg, "JPEG").on_hover_text(help);
            if settings.format == PictureFormat::Jpeg {
                let field = Number::new(1.0..=100.0, 0, "").field(ui, "quality ", &mut settings.jpeg_quality);
                field.accessible_name("JPEG quality");
            }
        });
        let help = "Linear, with layers for depth, normal, type, reference and primitive";
        ui.radio_value(&mut settings.format, PictureFormat::Exr, "OpenEXR, linear").on_hover_text(help);
    });
    ui.end_row();
    ui.label("Background");
    let mut is_left_out = settings.background == Background::LeftOut;
    ui.checkbox(&mut is_left_out, "transparent (without sky)");
    settings.background = if is_left_out { Background::LeftOut } else { Background::Shown };
    ui.end_row();
    if is_left_out && settings.format == PictureFormat::Jpeg {
        ui.label("");
        ui.weak("JPEG has no transparency: a PNG is saved.");
        ui.end_row();
    }
    let label = ui.label("Folder");
    let mut text = state.picture.folder_text.clone();
    ui.horizontal(|ui| {
        let field = egui::TextEdit::singleline(&mut text).hint_text("beside the model, or Pictures");
        if ui.add(field).labelled_by(label.id).changed() {
            commands.push(Command::Picture(PictureCommand::SetFolderText(text)));
        }
        if ui.button("Browse").accessible_name("Browse for the folder of pictures").clicked() {
            commands.push(Command::List(ListCommand::Ask(Purpose::PictureFolder)));
        }
    });
    ui.end_row();
}

fn buttons(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let is_free = state.picture.exporting.is_none();
    ui.horizontal(|ui| {
        let save = ui.add_enabled(is_free, egui::Button::new("Save now"));
        if save.on_hover_text(key_hint(Action::Screenshot)).clicked() {
            commands.push(Command::Picture(PictureCommand::Save));
        }
        let sequence = ui.add_enabled(is_free, egui::Button::new("Save path as sequence"));
        if sequence.on_hover_text(key_hint(Action::SaveSequence)).clicked() {
            commands.push(Command::Picture(PictureCommand::SaveSequence));
        }
        let film = ui.add_enabled(is_free, egui::Button::new("Save path as film (MP4)"));
        if film.on_hover_text(key_hint(Action::SaveFilm)).clicked() {
            commands.push(Command::Picture(PictureCommand::SaveFilm));
        }
        if ui.button("Reset picture settings").clicked() {
            commands.push(Command::Picture(PictureCommand::Set(PictureSettings::default())));
            commands.push(Command::Picture(PictureCommand::SetFolderText(String::new())));
        }
    });
    if let Some(command) = &state.picture.film_command {
        ui.label("Command that encodes the last sequence as a film:");
        ui.add(egui::Label::new(RichText::new(command).monospace().small()).wrap());
        if ui.button("Copy film command").clicked() {
            commands.push(Command::CopyText(command.clone()));
        }
    }
}

/// Shows the progress of saving at the top of the viewport; messages are at the bottom.
pub fn progress(
    ctx: &egui::Context,
    viewport: Rect,
    state: &AppState,
    exporting: &Progress,
    commands: &mut Vec<Command>,
) {
    let at = viewport.center_top() + egui::vec2(0.0, 12.0);
    let area = egui::Area::new(egui::Id::unique("exporting")).fixed_pos(at).pivot(Align2::CENTER_TOP);
    area.order(egui::Order::Foreground).show(ctx, |ui| {
        super::statistics::ground().show(ui, |ui| {
            ui.set_width(340.0);
            ui.label(RichText::new(format!("Saving: {}", exporting.phase)).color(Color32::WHITE));
            ui.horizontal(|ui| {
                let part = exporting.fraction.unwrap_or(0.0);
                let left = state.picture.secs_left().map(|secs| format!(", {} left", about(secs)));
                let text = format!("{:.0} %{}", part * 100.0, left.unwrap_or_default());
                ui.add(ProgressBar::new(part).text(text).desired_width(250.0));
                let cancel = ui.button("Cancel saving");
                regions::note(&cancel, Region::Messages);
                if cancel.clicked() {
                    commands.push(Command::Picture(PictureCommand::Cancel));
                }
            });
        });
    });
}
