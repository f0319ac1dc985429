//! Saving a panorama: its size, and what it takes.

use super::widgets::{about, choice};
use crate::window::state::{AppState, Command, PictureCommand, PictureSettings};
use egui::{Button, Ui};

/// Suggested widths in pixels; a panorama is half as high.
const WIDTHS: [u32; 4] = [2048, 4096, 8192, 16384];

/// Bytes of a pixel in a PNG file: panoramas of rooms have 0.6 to 0.9.
const BYTES_PER_PIXEL: f64 = 0.75;

/// Shows the size of a panorama, the button that saves it, and how large it is and how long it
/// will take.
pub(super) fn rows(
    ui: &mut Ui,
    state: &AppState,
    settings: &mut PictureSettings,
    commands: &mut Vec<Command>,
) {
    let name = |width: u32| format!("{width} x {}", width / 2);
    ui.separator();
    ui.horizontal(|ui| {
        let label = ui.label("Panorama of all directions");
        let widths = WIDTHS.map(|width| (width, name(width)));
        let shown = name(settings.panorama_width);
        choice(ui, "panorama size", &shown, &mut settings.panorama_width, widths).labelled_by(label.id);
        let save = ui.add_enabled(state.picture.exporting.is_none(), Button::new("Save panorama"));
        if save.on_hover_text("PNG that viewers of panoramas recognise; the view is its middle").clicked() {
            commands.push(Command::Picture(PictureCommand::SavePanorama));
        }
    });
    let pixels = f64::from(settings.panorama_width).powi(2) / 2.0;
    let secs = state.picture.secs_per_panorama_pixel.map(|secs| about(secs * pixels));
    let time = secs.unwrap_or_else(|| "measured with the first panorama".to_owned());
    ui.weak(format!("About {:.0} MB; time: {time}.", (pixels * BYTES_PER_PIXEL / 1e6).max(1.0)));
}
