//! `tour --show`: pictures of a tour in false colour on one scale, or in white clay.

use super::failure::Failure;
use super::flags::Flags;
use super::show::CLAY;
use super::show_flags::{Show, ShowArgs, surfaces_of, values_of};
use afterimage::render::aov::display_rows;
use afterimage::render::lighting::under_overcast_sky;
use afterimage::{Frame, Scene, Tracer};
use std::sync::Arc;

/// Draws the frames of a tour.
#[derive(Debug)]
pub(super) struct TourPictures {
    shown: ShowArgs,
    /// End of the scale; `None` before the first picture.
    pub(super) max: Option<f32>,
}

/// A picture of a frame: sRGB colours, their size, and what they show, in words.
pub(super) type TourPicture = (Vec<[u8; 3]>, [u32; 2], Option<String>);

impl TourPictures {
    pub(super) fn new(shown: ShowArgs) -> Self {
        Self { shown, max: None }
    }

    /// The tracer of the frames: of the light that arrives at surfaces where that is shown.
    pub(super) fn tracer(&self, tracer: &Arc<Tracer>) -> Arc<Tracer> {
        match self.shown.show {
            Show::Radiance | Show::Luminance => tracer.clone(),
            Show::Illuminance | Show::Clay => Arc::new(tracer.showing_light(true)),
            Show::DaylightFactor => Arc::new(under_overcast_sky(tracer).showing_light(true)),
        }
    }

    /// Draws a frame. The first one sets an automatic scale for all.
    pub(super) fn draw(
        &mut self,
        frame: &Frame,
        scene: &Scene,
        flags: &Flags,
    ) -> Result<TourPicture, Failure> {
        let show = self.shown.show;
        if !show.has_values() {
            let radiance = match show {
                Show::Clay => &clay(frame, scene),
                _ => &frame.radiance,
            };
            return Ok((display_rows(radiance, flags.exposure_ev(), flags.tone_map), frame.view.size, None));
        }
        let values = values_of(show, frame, scene);
        let max = match self.max {
            Some(max) => max,
            None => self.shown.scale_of(&values)?,
        };
        if self.max.replace(max).is_none() {
            self.shown.say_scale(scene, &values, max);
        }
        let (colors, size, note) = self.shown.false_color(&values, max, &surfaces_of(frame, scene));
        Ok((colors, size, Some(note)))
    }
}

/// The radiance of white clay under the light of a frame.
fn clay(frame: &Frame, scene: &Scene) -> Vec<glam::Vec3> {
    let surfaces = surfaces_of(frame, scene);
    let shade = |(pixel, light): (usize, &glam::Vec3)| match surfaces.scatters(pixel) {
        true => *light * CLAY,
        false => glam::Vec3::ONE,
    };
    frame.radiance.iter().enumerate().map(shade).collect()
}
