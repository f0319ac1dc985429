//! Discomfort glare from daylight: vertical illuminance at the eye, glare sources, and DGP.
//!
//! Source: Wienold and Christoffersen 2006, "Evaluation methods and development of a new glare
//! prediction model for daylight environments with the use of CCD cameras". We differ from Wienold's
//! Evalglare: a source is a connected patch, and neighbouring patches are not joined.

use super::fisheye::{Fisheye, SeenSun};
use super::position_index::position_index;
use glam::Vec3;
use std::collections::VecDeque;
use std::f64::consts::PI;

/// Luminance above which a part of the view is a glare source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GlareThreshold {
    /// A luminance in cd/m2.
    Luminance(f32),
    /// A multiple of the mean luminance of the view.
    TimesMean(f32),
}

impl Default for GlareThreshold {
    /// 2,000 cd/m2, as in Evalglare since version 2.
    fn default() -> Self {
        Self::Luminance(2000.0)
    }
}

/// A glare source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlareSource {
    /// Unit vector to its middle, weighted by luminance.
    pub direction: Vec3,
    /// Mean luminance, cd/m2.
    pub luminance: f64,
    /// Solid angle, steradians.
    pub solid_angle: f64,
    /// Position index.
    pub position_index: f64,
    /// True for the disk of the sun.
    pub is_sun: bool,
}

impl GlareSource {
    /// Its part in the contrast term: squared luminance times solid angle over squared index.
    fn weight(&self) -> f64 {
        self.luminance * self.luminance * self.solid_angle / (self.position_index * self.position_index)
    }
}

/// Vertical illuminance in lux for which DGP was developed, at least.
pub const MIN_VALID_LUX: f64 = 380.0;

/// Range of DGP within which it was tested.
pub const VALID_DGP: [f64; 2] = [0.2, 0.8];

/// Returns the daylight glare probability, 0..1, for the vertical illuminance at the eye in lux and
/// the sources. Without light at the eye it is zero.
pub fn daylight_glare_probability(ev_lux: f64, sources: &[GlareSource]) -> f64 {
    if ev_lux <= 0.0 {
        return 0.0;
    }
    let contrast: f64 = sources.iter().map(GlareSource::weight).sum::<f64>() / ev_lux.powf(1.87);
    (5.87e-5 * ev_lux + 9.18e-2 * (1.0 + contrast).log10() + 0.16).clamp(0.0, 1.0)
}

/// The class of a DGP in words (Wienold 2009).
pub fn describe(dgp: f64) -> &'static str {
    match dgp {
        d if d < 0.35 => "imperceptible",
        d if d < 0.40 => "perceptible",
        d if d < 0.45 => "disturbing",
        _ => "intolerable",
    }
}

impl Fisheye {
    /// Returns the glare sources, the most disturbing first, and the threshold in cd/m2 that was
    /// used. `sun` is the disk of a sun that the rays of the picture cannot meet.
    pub fn sources(&self, threshold: GlareThreshold, sun: Option<&SeenSun>) -> (Vec<GlareSource>, f32) {
        let limit = match threshold {
            GlareThreshold::Luminance(luminance) => luminance,
            GlareThreshold::TimesMean(factor) => factor * self.mean_luminance() as f32,
        };
        let mut is_open: Vec<bool> = self.luminance.iter().map(|l| *l > limit).collect();
        let mut sources = Vec::new();
        for start in 0..is_open.len() {
            if is_open[start] {
                sources.push(self.source(start, &mut is_open));
            }
        }
        sources.extend(sun.filter(|sun| sun.luminance > f64::from(limit)).map(|sun| GlareSource {
            direction: sun.direction,
            luminance: sun.luminance,
            solid_angle: sun.solid_angle,
            position_index: f64::from(position_index(sun.direction, self.ahead, self.up)),
            is_sun: true,
        }));
        sources.sort_by(|a, b| b.weight().total_cmp(&a.weight()));
        (sources, limit)
    }

    /// The source that a bright pixel belongs to; closes its pixels.
    fn source(&self, start: usize, is_open: &mut [bool]) -> GlareSource {
        let (mut sum, mut middle, mut count) = (0.0, Vec3::ZERO, 0u32);
        let mut queue = VecDeque::from([start]);
        is_open[start] = false;
        while let Some(pixel) = queue.pop_front() {
            let luminance = self.luminance[pixel];
            sum += f64::from(luminance);
            middle += self.direction(pixel).unwrap_or_default() * luminance;
            count += 1;
            for next in self.neighbours(pixel) {
                if std::mem::take(&mut is_open[next]) {
                    queue.push_back(next);
                }
            }
        }
        let direction = middle.normalize_or(self.ahead);
        GlareSource {
            direction,
            luminance: sum / f64::from(count),
            solid_angle: f64::from(count) * self.pixel_solid_angle(),
            position_index: f64::from(position_index(direction, self.ahead, self.up)),
            is_sun: false,
        }
    }

    /// Mean luminance over the half of all directions that is seen, cd/m2.
    pub fn mean_luminance(&self) -> f64 {
        let seen = (0..self.luminance.len()).filter(|pixel| self.direction(*pixel).is_some());
        seen.map(|pixel| f64::from(self.luminance[pixel])).sum::<f64>() * self.pixel_solid_angle()
            / (2.0 * PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark(side: usize) -> Fisheye {
        Fisheye::new(side, Vec3::NEG_Z, Vec3::Y)
    }

    #[test]
    fn one_small_source_has_the_dgp_of_the_formula_by_hand() {
        let mut view = dark(301);
        let middle = 150 * 301 + 150;
        view.luminance.fill(100.0);
        view.luminance[middle] = 50_000.0;
        let (sources, limit) = view.sources(GlareThreshold::default(), None);
        assert_eq!((sources.len(), limit), (1, 2000.0));
        let omega = 8.0 / (301.0 * 301.0);
        let source = sources[0];
        assert!((source.solid_angle / omega - 1.0).abs() < 1e-6 && source.luminance == 50_000.0);
        assert!((source.position_index - 1.0).abs() < 1e-3);
        let ev = 100.0 * PI + 49_900.0 * omega;
        let contrast = 50_000f64.powi(2) * omega / ev.powf(1.87);
        let expected = 5.87e-5 * ev + 9.18e-2 * (1.0 + contrast).log10() + 0.16;
        assert!((daylight_glare_probability(ev, &sources) - expected).abs() < 1e-4);
        assert_eq!(daylight_glare_probability(0.0, &[]), 0.0);
    }

    #[test]
    fn patches_are_sources_of_their_own_and_the_threshold_may_follow_the_view() {
        let mut view = dark(101);
        view.luminance.fill(10.0);
        for (x, y) in [(50, 30), (51, 30), (52, 31), (50, 70)] {
            view.luminance[y * 101 + x] = 5000.0;
        }
        let (sources, _) = view.sources(GlareThreshold::Luminance(2000.0), None);
        let mut counts: Vec<f64> =
            sources.iter().map(|s| (s.solid_angle / view.pixel_solid_angle()).round()).collect();
        counts.sort_by(f64::total_cmp);
        assert_eq!(counts, [1.0, 3.0], "corners join pixels");
        let (none, limit) = view.sources(GlareThreshold::TimesMean(1000.0), None);
        assert!(none.is_empty() && (f64::from(limit) / view.mean_luminance() / 1000.0 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn classes_are_those_of_the_literature() {
        assert_eq!(
            [0.3, 0.36, 0.42, 0.5].map(describe),
            ["imperceptible", "perceptible", "disturbing", "intolerable"]
        );
    }
}
