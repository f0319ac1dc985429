//! Saves what the viewport shows in false colour or clay: the newest frame, with its scale.

use super::{AppEvent, Parts};
use crate::window::rendering::{FrameValues, TaskError};
use crate::window::state::AppState;
use afterimage::raster::color::{ToneMap, srgb8};
use afterimage::raster::false_color::{line_step, picture};
use afterimage::raster::legend::{Legend, beside};
use afterimage::raster::rgb9e5;
use afterimage::raster::save::encode_png;

/// What is saved, apart from the pixels.
struct Shown {
    values: FrameValues,
    size: [u32; 2],
    /// End of the scale; `None` for clay.
    max: Option<f32>,
    has_isolines: bool,
    exposure_ev: f32,
    tone_map: ToneMap,
}

/// Saves the newest frame in the folder of pictures.
pub(super) fn save_shown(app: &mut Parts) {
    let state = &app.state;
    let frame = state.frame.as_ref().filter(|frame| frame.values.quantity == state.options.quantity);
    let Some(frame) = frame.filter(|frame| frame.stats.is_complete) else {
        return app.state.info("the view is still being rendered; save it again in a moment");
    };
    let (shown, pixels) = (shown(state, frame.values, frame.size), frame.radiance.clone());
    let destination = app.services.destination(state);
    app.services.spawn("saving a picture", move || {
        let (colors, size, note) = shown.draw(&pixels);
        let notes = [("Description", note)];
        let png = encode_png(size, &colors, &notes).map_err(TaskError::failed)?;
        match destination.write_new("png", &png) {
            Ok(path) => Ok(AppEvent::Saved(path)),
            Err(Some(error)) => Err(TaskError::failed(error)),
            Err(None) => Err(TaskError::Failed("there is no folder to save pictures in".to_owned())),
        }
    });
}

fn shown(state: &AppState, values: FrameValues, size: [u32; 2]) -> Shown {
    Shown {
        values,
        size,
        max: state.lighting.max_of(values.quantity),
        has_isolines: state.options.has_isolines,
        exposure_ev: state.exposure_ev(),
        tone_map: state.quality.tone_map,
    }
}

impl Shown {
    /// Returns the picture, its size, and what it shows in words.
    fn draw(&self, pixels: &[u32]) -> (Vec<[u8; 3]>, [u32; 2], String) {
        let Some(max) = self.max else {
            let color = |pixel: &u32| srgb8(rgb9e5::unpack(*pixel), self.exposure_ev, self.tone_map);
            return (pixels.iter().map(color).collect(), self.size, "white clay".to_owned());
        };
        let values: Vec<f32> = pixels.iter().map(|p| self.values.value(*p).unwrap_or(f32::NAN)).collect();
        let step = self.has_isolines.then(|| line_step(max));
        // The packed pixels know where surfaces end to the right and below.
        let are_one = |a: usize, b: usize| FrameValues::goes_on(pixels[a])[usize::from(b != a + 1)];
        let colors = picture(&values, self.size[0] as usize, max, step, are_one);
        let (unit, is_relative) = (self.values.quantity.unit(), self.values.is_relative);
        let (colors, size) = beside(&colors, self.size, Legend { max, unit, is_relative });
        let relative = if is_relative { ", relative" } else { "" };
        let name = self.values.quantity.name().to_lowercase();
        (colors, size, format!("{name} in false colour from 0 to {max} {unit}{relative}"))
    }
}
