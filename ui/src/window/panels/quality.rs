//! Settings that trade time for quality, each with its unit and a reset button.

use super::super::state::{AppState, Command, Options, Quality};
use super::{numbers::Number, widgets::choice};
use crate::window::input::fly_camera::ViewChange;
use afterimage::Mode;
use afterimage::raster::{color::ToneMap, exposure::Exposure};
use afterimage::reference::{PlacementPolicy, PlacementRule, placement};
use afterimage::trace::BounceLimit;
use egui::Ui;

const MB: usize = 1 << 20;

/// Limits of bounces to choose from; the command line takes others too.
const BOUNCE_LIMITS: [BounceLimit; 6] =
    [BounceLimit::ALL, BounceLimit::NONE, BounceLimit(1), BounceLimit(2), BounceLimit(4), BounceLimit(8)];

/// Shows the settings of quality and speed.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (mut q, d) = (state.quality, &state.default_quality);
    ui.spacing_mut().slider_width = 88.0;
    egui::Grid::new("quality").num_columns(3).spacing([6.0, 5.0]).show(ui, |ui| {
        mode_row(ui, &mut q, d);
        sampling_rows(ui, &mut q, d);
        pace_rows(ui, &mut q, d);
        placement_rows(ui, &mut q, d);
    });
    if q != state.quality {
        commands.push(Command::SetQuality(q));
    }
}

/// Shows the settings of how a picture is displayed.
pub fn show_look(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (mut q, d) = (state.quality, &state.default_quality);
    ui.spacing_mut().slider_width = 88.0;
    egui::Grid::new("look").num_columns(3).spacing([6.0, 5.0]).show(ui, |ui| {
        exposure_rows(ui, state, &mut q);
        picture_rows(ui, &mut q, d);
    });
    if q != state.quality {
        commands.push(Command::SetQuality(q));
    }
}

/// Shows the settings of how the camera moves.
pub fn show_movement(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.spacing_mut().slider_width = 88.0;
    let grid = egui::Grid::new("movement").num_columns(3).spacing([6.0, 5.0]);
    grid.show(ui, |ui| camera_rows(ui, state, commands));
}

/// Shows a row: a name, a control, and a reset button.
fn row<T: PartialEq + Copy>(
    ui: &mut Ui,
    name: &str,
    help: &str,
    value: &mut T,
    default: T,
    control: impl FnOnce(&mut Ui, &mut T) -> egui::Response,
) {
    let label = ui.label(name).on_hover_text(help);
    control(ui, value).labelled_by(label.id).on_hover_text(help);
    let clicked = ui
        .add_enabled_ui(*value != default, reset_button)
        .inner
        .accessible_name(format!("Reset {}", name.to_lowercase()))
        .on_hover_text("Reset to the value at the start")
        .clicked();
    if clicked {
        *value = default;
    }
    ui.end_row();
}

/// The reset button. Its arrow is drawn because the default font has none.
fn reset_button(ui: &mut Ui) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(egui::vec2(16.0, 16.0), egui::Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), "Reset"));
    let visuals = ui.style().interact(&response);
    // The arrow is faint while the value is the default.
    let stroke = egui::Stroke::new(
        1.5,
        visuals.fg_stroke.color.gamma_multiply(if ui.is_enabled() { 1.0 } else { 0.4 }),
    );
    let (centre, radius) = (rect.center(), 4.5);
    let at = |turn: f32| centre + radius * egui::Vec2::angled(turn * std::f32::consts::TAU);
    let arc: Vec<egui::Pos2> = (0..=18).map(|i| at(-0.42 + 0.8 * i as f32 / 18.0)).collect();
    let tip = arc[0];
    ui.painter().line(arc, stroke);
    ui.painter().line(vec![tip + egui::vec2(-0.5, -4.0), tip, tip + egui::vec2(4.0, -0.5)], stroke);
    response
}

fn mode_row(ui: &mut Ui, q: &mut Quality, d: &Quality) {
    let help = "exact: light is looked up in several references, and uncertain pixels are checked.\n\
                fast: light is looked up in the best reference.\n\
                paper: reference images are reprojected as in the paper, including its errors.\n\
                full: every pixel is traced, for comparison.";
    row(ui, "Mode", help, &mut q.walk.render.mode, d.walk.render.mode, |ui, v| {
        let modes = [Mode::Exact, Mode::Fast, Mode::Paper, Mode::Full];
        choice(ui, "mode", v.name(), v, modes.map(|mode| (mode, mode.name())))
    });
}

fn sampling_rows(ui: &mut Ui, q: &mut Quality, d: &Quality) {
    let help = "Samples per pixel for each light, and paths for light that surfaces scatter; more than 64 lights in \
                one place share 16 rays for each sample. The window's default is low for smooth motion.";
    let (trace, default) = (&mut q.walk.render.trace, &d.walk.render.trace);
    row(ui, "Samples", help, &mut trace.samples, default.samples, |ui, v| {
        Number::new(1.0..=256.0, 0, " /light").step(1.0).logarithmic().slider(ui, v)
    });
    let help =
        "Maximum number of diffuse bounces of light: all is as many as matter, 0 is direct light only.";
    row(ui, "Bounces", help, &mut trace.bounces, default.bounces, |ui, v| {
        let limits = BOUNCE_LIMITS.map(|limit| (limit.0, limit.to_string()));
        choice(ui, "bounces", &BounceLimit(*v).to_string(), v, limits)
    });
}

fn pace_rows(ui: &mut Ui, q: &mut Quality, d: &Quality) {
    let help = "While the camera moves: rendered pixels per screen pixel, along each axis, at most. There are fewer where \
                more would not keep the rate. When it is stationary, every mode but paper refines the picture to full \
                resolution.";
    row(ui, "Render scale", help, &mut q.render_scale, d.render_scale, |ui, v| {
        Number::percent(25.0..=100.0).step(5.0).slider(ui, v)
    });
    let help = "While the camera moves, a frame ends after this time; where light is not known by then, it \
                is filled from around. When it is stationary, every frame is finished.";
    row(ui, "Frame budget", help, &mut q.budget_ms, d.budget_ms, |ui, v| {
        Number::new(16.0..=1000.0, 0, " ms").logarithmic().slider(ui, v)
    });
    let help = "After the last pass, the picture of a stationary camera gets more passes and less noise, until you \
                move. The processor stays busy.";
    row(ui, "Go on", help, &mut q.keeps_improving, d.keeps_improving, |ui, v| ui.checkbox(v, "until I move"));
}

fn placement_rows(ui: &mut Ui, q: &mut Quality, d: &Quality) {
    let about = |rule: &PlacementRule| format!("{}: {}", rule.name, rule.about);
    let help = format!(
        "Rule that places new references. {}.",
        placement::RULES.iter().map(about).collect::<Vec<_>>().join("; ")
    );
    let names: Vec<(usize, &str)> = placement::RULES.iter().map(|rule| rule.name).enumerate().collect();
    let number = |policy: &PlacementPolicy| names.iter().position(|n| n.1 == policy.rule.name).unwrap_or(0);
    let mut chosen = number(&q.walk.placement);
    row(ui, "Placement", &help, &mut chosen, number(&d.walk.placement), |ui, v| {
        choice(ui, "placement", names[*v].1, v, names.iter().copied())
    });
    q.walk.placement.rule = &placement::RULES[chosen];
    if q.walk.placement.rule.has_threshold {
        let help = "A new reference is traced when the percentage of Type 3 pixels exceeds this.";
        let default = d.walk.placement.percent;
        row(ui, "Threshold", help, &mut q.walk.placement.percent, default, |ui, v| {
            Number::new(0.5..=50.0, 1, " %").logarithmic().slider(ui, v)
        });
    }
    let help = "Memory for references; the least useful ones are evicted first.";
    let mut megabytes = q.walk.cache_bytes / MB;
    row(ui, "Cache limit", help, &mut megabytes, d.walk.cache_bytes / MB, |ui, v| {
        Number::new(16.0..=8192.0, 0, " MB").step(1.0).logarithmic().slider(ui, v)
    });
    if megabytes != q.walk.cache_bytes / MB {
        q.walk.cache_bytes = megabytes * MB;
    }
}

fn exposure_rows(ui: &mut Ui, state: &AppState, q: &mut Quality) {
    let default = state.default_quality.exposure;
    let mut is_auto = q.exposure == Exposure::Auto;
    let help =
        "Chooses the exposure from the light in the scene: the same wherever you are, and without a window.";
    row(ui, "Auto exposure", help, &mut is_auto, default == Exposure::Auto, |ui, v| {
        let control = |ui: &mut Ui| {
            let response = ui.checkbox(v, "auto");
            // A text of its own: screen readers replace that of the checkbox by the row's name.
            if let Some(metered) = state.metered.filter(|_| *v) {
                ui.label(format!("{:+.1} EV", metered.ev()));
            }
            response
        };
        ui.horizontal(control).inner
    });
    if is_auto != (q.exposure == Exposure::Auto) {
        q.exposure = if is_auto { Exposure::Auto } else { Exposure::Stops(state.exposure_ev()) };
    }
    let help = "The automatic exposure follows the view: a house that is entered from the sun does not stay \
                black. Otherwise it is that of the whole scene.";
    let default = state.default_quality.follows_view;
    row(ui, "This view", help, &mut q.follows_view, default, |ui, v| {
        ui.add_enabled(is_auto, egui::Checkbox::new(v, "automatic"))
    });
    let default = state.default_quality.exposure;
    let help = "Exposure in stops: one stop more is twice as bright. Setting it ends the automatic exposure.";
    row(ui, "Exposure", help, &mut q.exposure, default, |ui, v| {
        let before = v.stops().unwrap_or(state.exposure_ev());
        let mut ev = before;
        let response = Number::new(-8.0..=8.0, 1, " EV").step(0.1).slider(ui, &mut ev);
        // A field that is left with what it showed has changed nothing.
        if ev != before {
            *v = Exposure::Stops(ev);
        }
        response
    });
}

fn picture_rows(ui: &mut Ui, q: &mut Quality, d: &Quality) {
    let help = "aces: a filmic curve that keeps the hue of bright lamps. linear: clipped at white.";
    row(ui, "Tone map", help, &mut q.tone_map, d.tone_map, |ui, v| {
        choice(ui, "tone map", v.name(), v, [ToneMap::Aces, ToneMap::Linear].map(|map| (map, map.name())))
    });
}

fn camera_rows(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    use crate::window::input::fly_camera::{DEFAULT_SPEED, SPEED_RANGE};
    let mut speed = state.navigation.fly.speed_m_per_s();
    let usual = state.scene.as_ref().map_or(DEFAULT_SPEED, |scene| scene.speed_m_per_s);
    let help = "Speed of the movement keys; also right mouse button + wheel. Shift is five times as fast, Alt a fifth.";
    row(ui, "Speed", help, &mut speed, usual, |ui, v| {
        Number::new(SPEED_RANGE, 2, " m/s").logarithmic().slider(ui, v)
    });
    if speed != state.navigation.fly.speed_m_per_s() {
        commands.push(Command::SetSpeed(speed));
    }
    // Rounded, because 60 degrees stored in radians convert back to 59.99999999999999.
    let shown = (state.navigation.fly.camera().fov_y.to_degrees() * 1e6).round() / 1e6;
    let mut fov = shown;
    row(ui, "Field of view", "Vertical field of view.", &mut fov, 60.0, |ui, v| {
        Number::new(10.0..=130.0, 0, "°").slider(ui, v)
    });
    let mut is_reduced = state.options.view_change == ViewChange::AtOnce;
    let help = "Change views without animation.";
    row(ui, "Reduce motion", help, &mut is_reduced, false, |ui, v| ui.checkbox(v, ""));
    let view_change = if is_reduced { ViewChange::AtOnce } else { ViewChange::Eased };
    if view_change != state.options.view_change {
        commands.push(Command::SetOptions(Options { view_change, ..state.options }));
    }
    // Ignores differences that come from rounding.
    if (fov - shown).abs() > 1e-6 {
        commands.push(Command::SetFovDegrees(fov));
    }
}
