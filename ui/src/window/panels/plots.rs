//! Plots of the last minute: types of pixels, and frame times by stage.

use super::super::state::{AppState, HISTORY};
use super::widgets::{FIRST_STAGE, TYPE_NAMES, swatch, type_color};
use afterimage::reference::PlacementPolicy;
use egui::{Color32, Ui};
use egui_plot::{FilledArea, HLine, Line, LineStyle, Plot, PlotPoints};
use std::time::Instant;

/// Height of a plot in points.
const HEIGHT: f32 = 92.0;

/// Shows both plots.
pub fn show(ui: &mut Ui, state: &AppState) {
    let now = Instant::now();
    let ages: Vec<f64> = state.history.iter().map(|s| -(now - s.at).as_secs_f64()).collect();
    ui.weak("Pixels by type, percent; dashed: threshold for a new reference");
    plot("types").include_y(0.0).include_y(100.0).show(ui, |plot| {
        // Type 3 is at the bottom, where it can be compared with its threshold.
        let mut lower = vec![0.0; ages.len()];
        for number in [2, 1, 0] {
            let upper: Vec<f64> =
                lower.iter().zip(&state.history).map(|(l, s)| l + f64::from(s.percent[number])).collect();
            plot.add(area(number, &ages, &lower, &upper));
            lower = upper;
        }
        if let Some(percent) = threshold(&state.quality.walk.placement) {
            let line =
                HLine::new("threshold", percent).color(Color32::BLACK).style(LineStyle::dashed_dense());
            plot.hline(line.width(1.5));
        }
    });
    ui.add_space(4.0);
    ui.weak("Frame time by stage, ms");
    let stages = [FIRST_STAGE, "secondary", "trace"];
    key(ui, &stages);
    let text = ui.visuals().strong_text_color();
    plot("time").include_y(0.0).show(ui, |plot| {
        let points = |ms: &dyn Fn(&[f32; 3]) -> f32| -> PlotPoints<'_> {
            let ys = state.history.iter().map(|s| f64::from(ms(&s.stage_ms)));
            ages.iter().zip(ys).map(|(&x, y)| [x, y]).collect()
        };
        plot.line(Line::new("frame", points(&|s| s.iter().sum())).color(text).width(1.5));
        for (number, name) in stages.into_iter().enumerate() {
            plot.line(Line::new(name, points(&|s| s[number])).color(type_color(number)).width(1.0));
        }
    });
}

/// Legend of the lines. A stage has the colour of the type that it renders.
fn key(ui: &mut Ui, names: &[&str]) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (number, name) in names.iter().enumerate() {
            swatch(ui, number);
            ui.label(egui::RichText::new(*name).small());
        }
    });
}

fn plot(name: &str) -> Plot<'static> {
    Plot::new(name.to_owned())
        .height(HEIGHT)
        .default_x_bounds(-HISTORY.as_secs_f64(), 0.0)
        .include_x(-HISTORY.as_secs_f64())
        .include_x(0.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_axes([false, true])
        .show_x(false)
        .set_margin_fraction(egui::vec2(0.0, 0.05))
        .y_axis_min_width(28.0)
}

fn area(number: usize, ages: &[f64], lower: &[f64], upper: &[f64]) -> FilledArea {
    FilledArea::new(TYPE_NAMES[number], ages, lower, upper).fill_color(type_color(number))
}

fn threshold(policy: &PlacementPolicy) -> Option<f64> {
    policy.rule.has_threshold.then_some(policy.percent)
}
