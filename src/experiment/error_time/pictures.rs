//! The middle view in every mode, and the part of it in which the modes differ most, with error
//! maps.

use super::plan::{DEFAULT_REFERENCES, REUSING, poses, view_share};
use crate::experiment::measure::{FramePictures, References, Trial, truth_of};
use crate::experiment::run::{CellOutcome, ExperimentContext, ExperimentError, RunRecord};
use crate::raster::color::{ToneMap, srgb8};
use crate::render::{Mode, Renderer};

/// A part of a picture: left, top, width, height in pixels.
type Part = [u32; 4];

/// Sides of the part: the sides of the picture divided by this number.
const PART_SHARE: u32 = 4;

/// Saves the pictures and returns a record for every mode.
pub(super) fn run(context: &ExperimentContext<'_>) -> CellOutcome {
    let (trace, size) = (context.settings.trace(), context.settings.size);
    let (camera, poses) =
        poses(context, view_share(context, context.settings.views / 2), DEFAULT_REFERENCES)?;
    let Some(truth) = truth_of(context, &camera) else { return Ok(None) };
    let Some(references) = References::trace(context, &poses, &trace) else { return Ok(None) };
    let (none, exposure_ev) = (References::none(context), context.settings.exposure_ev);
    let mut all = Vec::new();
    for mode in [Mode::Full].into_iter().chain(REUSING) {
        let references = if mode == Mode::Full { &none } else { &references };
        let mut renderer = Renderer::default();
        let trial = Trial { mode, trace, camera, references };
        let Some(frame) = trial.render(context, &mut renderer) else { return Ok(None) };
        all.push(FramePictures::of(mode.name(), frame, &truth, exposure_ev)?);
    }
    let part = worst_part(size, &all);
    let truth: Vec<[u8; 3]> = truth.iter().map(|v| srgb8(*v, exposure_ev, ToneMap::Aces)).collect();
    context.save_picture("truth.png", size, &truth)?;
    save_part(context, "truth", &truth, part)?;
    for pictures in &all {
        pictures.save(context)?;
        save_part(context, &pictures.name, &pictures.shown, part)?;
        save_part(context, &format!("{}-error", pictures.name), &pictures.error(), part)?;
    }
    let record = |p: &FramePictures| {
        let mean = p.flip.iter().map(|v| f64::from(*v)).sum::<f64>() / p.flip.len() as f64;
        RunRecord::default().with("mode", p.name.as_str()).with("flip_mean", mean).with("part", part.to_vec())
    };
    Ok(Some(all.iter().map(record).collect()))
}

/// Returns the part in which the errors of the modes differ most. A part in which all have the same
/// error would show nothing.
fn worst_part([width, height]: [u32; 2], all: &[FramePictures]) -> Part {
    let size = [width, height].map(|side| (side / PART_SHARE).max(side.min(16)));
    let spread = |pixel: usize| {
        let of = all.iter().map(|s| s.flip[pixel]);
        of.clone().fold(0.0f32, f32::max) - of.fold(1.0f32, f32::min)
    };
    let sum = |[left, top]: [u32; 2]| -> f64 {
        let rows = top..top + size[1];
        let pixels = rows.flat_map(|y| (left..left + size[0]).map(move |x| (y * width + x) as usize));
        pixels.map(|p| f64::from(spread(p))).sum()
    };
    let steps = |side: u32, part: u32| (0..=side - part).step_by((part / 4).max(1) as usize);
    let places = steps(height, size[1]).flat_map(|y| steps(width, size[0]).map(move |x| [x, y]));
    let best = places.max_by(|a, b| sum(*a).total_cmp(&sum(*b))).unwrap_or([0, 0]);
    [best[0], best[1], size[0], size[1]]
}

/// Saves a part of a picture as `NAME-part.png`.
fn save_part(
    context: &ExperimentContext<'_>,
    name: &str,
    picture: &[[u8; 3]],
    [left, top, w, h]: Part,
) -> Result<(), ExperimentError> {
    let [width, _] = context.settings.size;
    let row = |y: u32| {
        let start = (y * width + left) as usize;
        picture[start..start + w as usize].iter().copied()
    };
    let part: Vec<[u8; 3]> = (top..top + h).flat_map(row).collect();
    context.save_picture(&format!("{name}-part.png"), [w, h], &part)
}
