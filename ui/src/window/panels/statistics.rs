//! Statistics over the viewport.

use super::super::state::{AppState, Statistics, Work};
use super::comparison;
use super::regions::{self, Region};
use super::widgets::{FIRST_STAGE, GROUND, TEXT, swatch};
use crate::window::input::fly_camera::MoveMode;
use crate::window::input::keymap::{Action, keys_of};
use afterimage::render::AuditEstimate;
use egui::{Color32, RichText, Ui};

const DIM: Color32 = Color32::from_gray(170);

/// A dark, translucent background on which text is legible over any picture.
pub fn ground() -> egui::Frame {
    egui::Frame::new().fill(GROUND).corner_radius(6.0).inner_margin(egui::Margin::symmetric(10, 7))
}

/// Shows the statistics in the corner of `ui`.
pub fn show(ui: &mut Ui, state: &AppState) {
    let shown = ground().show(ui, |ui| {
        ui.style_mut().interaction.selectable_labels = false;
        ui.spacing_mut().item_spacing = egui::vec2(10.0, 3.0);
        if state.options.is_paused {
            paused(ui, state.options.is_frozen);
        }
        if state.options.statistics == Statistics::Off {
            return;
        }
        state_line(ui, state);
        let is_full = state.options.statistics == Statistics::Full;
        egui::Grid::new("statistics").num_columns(2).min_col_width(76.0).show(ui, |ui| {
            short_rows(ui, state);
            if is_full {
                frame_rows(ui, state);
            }
            for (name, value) in comparison::figures(state) {
                line(ui, name, value);
            }
            if is_full {
                line(ui, "window", format!("{:.0} ms", state.window_ms));
            }
            let move_mode =
                if state.navigation.fly.move_mode() == MoveMode::Walk { "walking" } else { "flying" };
            line(ui, move_mode, format!("{} m/s", three_digits(state.navigation.fly.speed_m_per_s())));
        });
        if is_full {
            type_rows(ui, state);
        }
    });
    regions::readable(ui, Region::Figures, shown.response.rect, &spoken(state));
}

/// The figures that everyone wants to know, for a screen reader.
fn spoken(state: &AppState) -> String {
    let reused = state.frame.as_ref().map(|frame| frame.stats.types.percentages().type1_percent);
    let reused = reused.map(|percent| format!(", {percent:.0} % of pixels reused")).unwrap_or_default();
    format!("{}{reused}", state.work_text())
}

/// Shows that the renderer is paused, large.
fn paused(ui: &mut Ui, is_frozen: bool) {
    let keys = keys_of(Action::Pause);
    let (word, help) = match is_frozen {
        true => ("Frozen", format!("This frame is shown from where you go; {keys} goes on")),
        false => ("Paused", format!("Moving or {keys} goes on")),
    };
    ui.label(RichText::new(word).color(TEXT).size(26.0).strong());
    ui.label(RichText::new(help).color(TEXT));
}

/// What everyone wants to know.
fn short_rows(ui: &mut Ui, state: &AppState) {
    let Some(frame) = &state.frame else { return };
    if let Some(per_sec) = state.frame_rate.per_sec() {
        line(ui, "moving", format!("{per_sec:.1} pictures/s"));
    }
    let reused = frame.stats.types.percentages().type1_percent;
    line(ui, "reused", format!("{reused:.0} % of pixels"));
}

/// Paints the first-run hint at the bottom of the viewport.
pub fn hint(ui: &Ui, viewport: egui::Rect) {
    let text = "drag to look, WASD to move, T heatmap, F1 help".to_owned();
    let galley = ui.painter().layout_no_wrap(text, egui::TextStyle::Body.resolve(ui.style()), TEXT);
    let centre = viewport.center_bottom() - egui::vec2(0.0, 28.0);
    let rect = egui::Rect::from_center_size(centre, galley.size() + egui::vec2(24.0, 14.0));
    ui.painter().rect_filled(rect, 6.0, GROUND);
    ui.painter().galley(rect.min + egui::vec2(12.0, 7.0), galley, TEXT);
}

fn state_line(ui: &mut Ui, state: &AppState) {
    ui.horizontal(|ui| {
        let color = match state.work {
            Work::Complete | Work::Converged => Color32::from_rgb(0x6C, 0xD0, 0x8A),
            Work::Paused => Color32::from_rgb(0xF0, 0xE4, 0x42),
            _ => Color32::from_rgb(0x7C, 0xBF, 0xEF),
        };
        let (rect, _) = ui.allocate_exact_size(egui::vec2(9.0, 14.0), egui::Sense::hover());
        ui.painter().circle_filled(rect.center(), 4.0, color);
        ui.label(RichText::new(state.work_text()).color(TEXT).strong());
    });
}

fn frame_rows(ui: &mut Ui, state: &AppState) {
    let Some(frame) = &state.frame else { return };
    let (secs, ms) = (&frame.stats.secs, |s: f64| format!("{:.1}", s * 1000.0));
    line(ui, "frame", format!("{} ms", ms(secs.frame)));
    line(ui, FIRST_STAGE, format!("{} ms", ms(secs.select + secs.visibility_and_lookup)));
    line(ui, "secondary", format!("{} ms", ms(secs.secondary)));
    line(ui, "trace", format!("{} ms", ms(secs.trace)));
    if let Some(audit) = &frame.stats.audit {
        line(ui, "audit", audit_text(audit));
    }
    let rays = &frame.stats.rays;
    let count = rays.primary + rays.shadow + rays.secondary + rays.indirect;
    line(ui, "rays", format!("{:.1} M/s", count as f64 / secs.frame.max(1e-9) / 1e6));
    let [used, held] = state.references_used_and_held();
    line(ui, "references", format!("{used} used / {held} held"));
    if let Some(share) = frame.stats.stored_share {
        // The sum of no shares is -0.
        line(ui, "from the store", format!("{:.0} %", 100.0 * share.abs()));
    }
    let [bytes, limit] = frame.cache_bytes.map(|b| b as f64 / f64::from(1 << 20));
    line(ui, "cache", format!("{bytes:.0} of {limit:.0} MB"));
    let [traced, stale] = frame.traced_and_stale;
    if stale > 0 {
        let percent = 100.0 * stale as f64 / traced.max(1) as f64;
        line(ui, "stale light", format!("{percent:.1} % of references"));
    }
    if frame.cell_bytes > 0 {
        line(ui, "light cells", format!("{:.0} MB", frame.cell_bytes as f64 / f64::from(1 << 20)));
    }
    let refined = &frame.stats.refined;
    if refined.light_samples > 0 {
        let progress = if refined.is_complete { "done" } else { "improving" };
        line(ui, "light", format!("{} samples here, {progress}", refined.light_samples));
    }
    line(ui, "picture", format!("{} x {}", frame.size[0], frame.size[1]));
}

/// Estimated PSNR of the picture against a converged one, such as `43.1 dB ±0.8 (95 %)`.
fn audit_text(audit: &AuditEstimate) -> String {
    match (audit.psnr_db, audit.plus_minus_db(), audit.psnr_low_db) {
        (Some(db), Some(bound), _) => format!("{db:.1} dB \u{b1}{bound:.1} (95 %)"),
        (_, _, Some(low)) => format!("over {low:.0} dB (95 %)"),
        _ => "checking".to_owned(),
    }
}

fn type_rows(ui: &mut Ui, state: &AppState) {
    let Some(frame) = &state.frame else { return };
    let p = frame.stats.types.percentages();
    ui.add_space(3.0);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        for (number, percent) in [p.type1_percent, p.type2_percent, p.type3_percent].into_iter().enumerate() {
            ui.add_space(if number > 0 { 6.0 } else { 0.0 });
            swatch(ui, number);
            ui.label(RichText::new(format!("{} {percent:>5.1}%", number + 1)).color(TEXT).monospace());
        }
    });
}

fn line(ui: &mut Ui, name: &str, value: String) {
    let label = ui.label(RichText::new(name).color(DIM));
    let value = ui.label(RichText::new(value).color(TEXT).monospace());
    if let Some((_, help)) = HELP.iter().find(|(known, _)| *known == name) {
        label.on_hover_text(*help);
        value.on_hover_text(*help);
    }
    ui.end_row();
}

/// What the figures mean.
const HELP: &[(&str, &str)] = &[
    ("moving", "Pictures rendered each second while the camera moves"),
    ("reused", "Pixels whose light comes from references that were traced before"),
    ("frame", "Time of the whole last frame"),
    (FIRST_STAGE, "Finding the surface of each pixel, and the light that references know of it"),
    ("secondary", "Following mirrors and glass"),
    ("trace", "Tracing the light of pixels that no reference knows"),
    ("audit", "Estimated error of the picture: above 40 dB differences are hard to see"),
    ("rays", "Rays traced each second"),
    ("references", "References used by this picture, and all that are held"),
    ("from the store", "Share of the light that was read from disk"),
    ("cache", "Memory of the references, and its limit"),
    ("stale light", "Light that a change of the scene has made wrong; it is traced again"),
    ("light cells", "Memory of stored smooth light"),
    ("light", "Samples of smooth light at this place"),
    ("picture", "Size in pixels"),
    ("full tracer", "Progress of the picture that nothing is reused for"),
    ("PSNR", "Error against the full tracer in decibels: 30 is visible, 40 hardly, 50 not at all"),
    ("FLIP", "Error as eyes see it: 0 is equal, 1 is black for white"),
    ("window", "Time between two updates of the window"),
    ("walking", "Speed; the right button with the wheel changes it"),
    ("flying", "Speed; the right button with the wheel changes it"),
];

/// A value with about three significant digits.
fn three_digits(value: f64) -> String {
    match value {
        v if v < 1.0 => format!("{v:.2}"),
        v if v < 10.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}
