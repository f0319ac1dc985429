//! The exposure of the view: measured in the picture that is shown, so that a house that is entered
//! from the sun does not stay black.
//!
//! The eye adapts, but not wholly: a room stays darker than the garden. Near the exposure of the
//! scene nothing is changed, so that most pictures are those of the command line.

use crate::window::rendering::PublishedFrame;
use afterimage::raster::color::luminance;
use afterimage::raster::exposure::Metered;
use afterimage::raster::rgb9e5;

/// Points of the picture that are measured, horizontally and vertically, in its middle.
const POINTS: [u32; 2] = [24, 16];

/// Share of width and height that counts as the middle.
const MIDDLE: f32 = 0.7;

/// Smallest share of the points that must show surfaces; otherwise the sky counts as well.
const MIN_SURFACES: f32 = 1.0 / 16.0;

/// Difference from the exposure of the scene, in stops, that is left: what is darker stays darker.
const LEFT_EV: f32 = 1.0;

/// Largest difference from the exposure of the scene, in stops. Noise of a black room is not light.
const MAX_EV: f32 = 10.0;

/// Difference in stops at which the exposure begins to follow, and at which it has arrived.
const BEGINS_EV: f32 = 0.4;
const ENDS_EV: f32 = 0.02;

/// Time in seconds in which two thirds of a change are done.
const FADE_SECS: f32 = 0.35;

/// The exposure that follows the view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewExposure {
    /// Exposure that the newest picture asks for, stops; `None` before the first.
    metered: Option<f32>,
    /// Exposure that is shown, stops.
    shown: Option<f32>,
    follows: bool,
}

impl ViewExposure {
    /// Returns the exposure that is shown, in stops.
    pub fn shown_ev(&self) -> Option<f32> {
        self.shown
    }

    /// Returns the exposure that suits the newest picture alone, in stops.
    pub fn metered_ev(&self) -> Option<f32> {
        self.metered
    }

    /// Measures a picture.
    pub fn meter(&mut self, frame: &PublishedFrame) {
        self.metered = metered(frame).or(self.metered);
    }

    /// Follows the view for `secs`, in a scene of an exposure. True while it moves.
    pub fn advance(&mut self, of_scene: f32, secs: f32, is_at_once: bool) -> bool {
        let wanted = self.metered.map_or(of_scene, |metered| adapted(of_scene, metered));
        let shown = self.shown.unwrap_or(wanted);
        let difference = wanted - shown;
        let followed = self.follows;
        self.follows = difference.abs() > if followed { ENDS_EV } else { BEGINS_EV };
        self.shown = Some(match (self.follows, followed) {
            (true, _) if !is_at_once => shown + difference * (1.0 - (-secs / FADE_SECS).exp()),
            (false, false) => shown,
            _ => wanted,
        });
        self.follows && !is_at_once
    }
}

/// Returns the exposure between that of the scene and that of the view.
fn adapted(of_scene: f32, of_view: f32) -> f32 {
    let difference = (of_view - of_scene).clamp(-MAX_EV, MAX_EV);
    of_scene + difference.signum() * (difference.abs() - LEFT_EV).max(0.0)
}

/// Returns the exposure that suits a picture: by the surfaces in its middle, or by the sky where it
/// shows little else. `None` where all of it is black.
fn metered(frame: &PublishedFrame) -> Option<f32> {
    let [width, height] = frame.size;
    if width == 0 || height == 0 {
        return None;
    }
    let (_, depths) = frame.depth_ranges.levels().next()?;
    let row = crate::window::rendering::depth_ranges::DepthRanges::padded(frame.size)[0];
    let mut surfaces = [0.0; (POINTS[0] * POINTS[1]) as usize];
    let mut all = surfaces;
    let (mut count, mut of_surfaces) = (0, 0);
    for at in 0..POINTS[0] * POINTS[1] {
        let place = |i: u32, of: u32, size: u32| {
            let part = 0.5 + ((i as f32 + 0.5) / of as f32 - 0.5) * MIDDLE;
            ((part * size as f32) as u32).min(size - 1)
        };
        let [x, y] = [place(at % POINTS[0], POINTS[0], width), place(at / POINTS[0], POINTS[1], height)];
        let light = f64::from(luminance(rgb9e5::unpack(frame.radiance[(y * width + x) as usize])));
        all[count] = light;
        count += 1;
        if depths[(y * row + x) as usize][0] > 0.0 {
            surfaces[of_surfaces] = light;
            of_surfaces += 1;
        }
    }
    let is_enough = of_surfaces as f32 >= MIN_SURFACES * count as f32;
    let of_view = |values: &mut [f64]| Metered::of_view(values).map(Metered::ev);
    if is_enough { of_view(&mut surfaces[..of_surfaces]) } else { of_view(&mut all[..count]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn frame(light: impl Fn(u32) -> f32) -> PublishedFrame {
        let mut frame = PublishedFrame { size: [64, 48], ..PublishedFrame::empty() };
        frame.radiance = (0..64 * 48).map(|i| rgb9e5::pack(Vec3::splat(light(i)))).collect();
        frame.depth_ranges.fill(&vec![1.0; 64 * 48], [64, 48]);
        frame
    }

    /// Follows a view for ten seconds and returns the exposures on the way.
    fn followed(exposure: &mut ViewExposure, of_scene: f32) -> Vec<f32> {
        (0..600)
            .map(|_| {
                exposure.advance(of_scene, 1.0 / 60.0, false);
                exposure.shown_ev().unwrap()
            })
            .collect()
    }

    #[test]
    fn half_the_light_is_one_stop_more() {
        let of = |light: f32| metered(&frame(|i| light * (1.0 + (i % 7) as f32))).unwrap();
        assert!((of(0.5) - of(1.0) - 1.0).abs() < 0.06 && (of(1e-4) - of(1.0) - 13.3).abs() < 0.1);
        assert_eq!(metered(&frame(|_| 0.0)), None);
    }

    #[test]
    fn a_view_as_bright_as_the_scene_keeps_its_exposure_and_a_dark_one_is_adapted_to() {
        let mut exposure = ViewExposure::default();
        exposure.meter(&frame(|_| 0.5));
        let usual = exposure.metered_ev().unwrap();
        assert!(followed(&mut exposure, usual + 0.8).iter().all(|ev| *ev == usual + 0.8));
        exposure.meter(&frame(|_| 0.5 / 64.0));
        let way = followed(&mut exposure, usual);
        assert!(way.windows(2).all(|pair| pair[1] >= pair[0]), "it never turns back");
        assert!((way[599] - usual - 5.0).abs() < 0.1, "six stops less one: {}", way[599] - usual);
        assert!(way[0] < usual + 1.5, "not at once: {}", way[0] - usual);
    }

    #[test]
    fn noise_does_not_flicker() {
        let mut exposure = ViewExposure::default();
        exposure.meter(&frame(|_| 0.01));
        followed(&mut exposure, 0.0);
        let before = exposure.shown_ev();
        for pass in 0..50 {
            exposure.meter(&frame(|i| 0.01 * (0.8 + 0.4 * ((i * 7 + pass * 13) % 10) as f32 / 10.0)));
            exposure.advance(0.0, 1.0 / 60.0, false);
            assert_eq!(exposure.shown_ev(), before);
        }
    }
}
