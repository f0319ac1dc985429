//! Mean, extremes and uniformity of the readings of a plane.

use super::meter::Reading;

/// What the readings of a plane say together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneStatistics {
    /// Mean illuminance in lux.
    pub mean_lux: f64,
    /// Smallest illuminance in lux.
    pub min_lux: f64,
    /// Largest illuminance in lux.
    pub max_lux: f64,
    /// Smallest over mean illuminance, 0..1: the uniformity of EN 12464-1. Zero in the dark.
    pub uniformity: f64,
    /// Half the width of the 95 % confidence interval of the mean, percent of the mean. It covers
    /// the noise of the measurement, not errors of the model.
    pub error_percent: f64,
    /// The same for a single point: the median over the points that are not black.
    pub point_error_percent: f64,
}

/// Standard errors of a 95 % confidence interval, to each side.
const CONFIDENCE: f64 = 1.96;

impl PlaneStatistics {
    /// Returns the statistics of readings; `None` without any.
    pub fn new(readings: &[Reading]) -> Option<Self> {
        if readings.is_empty() {
            return None;
        }
        let count = readings.len() as f64;
        let mean_lux = readings.iter().map(|r| r.lux).sum::<f64>() / count;
        let min_lux = readings.iter().map(|r| r.lux).fold(f64::INFINITY, f64::min);
        let max_lux = readings.iter().map(|r| r.lux).fold(0.0, f64::max);
        // Readings are independent: each point has random numbers of its own.
        let variance: f64 = readings.iter().map(|r| r.standard_error_lux.powi(2)).sum();
        Some(Self {
            mean_lux,
            min_lux,
            max_lux,
            uniformity: if mean_lux > 0.0 { min_lux / mean_lux } else { 0.0 },
            error_percent: percent(variance.sqrt() / count, mean_lux),
            point_error_percent: median_error(readings),
        })
    }
}

fn percent(standard_error: f64, mean: f64) -> f64 {
    if standard_error == 0.0 { 0.0 } else { 100.0 * CONFIDENCE * standard_error / mean }
}

fn median_error(readings: &[Reading]) -> f64 {
    let mut errors: Vec<f64> =
        readings.iter().filter(|r| r.lux > 0.0).map(|r| percent(r.standard_error_lux, r.lux)).collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniformity_is_the_smallest_over_the_mean() {
        let read = |lux| Reading { lux, standard_error_lux: 1.0 };
        let found = PlaneStatistics::new(&[read(100.0), read(300.0), read(200.0)]).unwrap();
        assert_eq!(
            [found.mean_lux, found.min_lux, found.max_lux, found.uniformity],
            [200.0, 100.0, 300.0, 0.5]
        );
        assert!((found.error_percent - 196.0 * 3f64.sqrt() / 3.0 / 200.0).abs() < 1e-9);
        assert!((found.point_error_percent - 0.98).abs() < 1e-9);
        assert_eq!(PlaneStatistics::new(&[]), None);
        let dark = PlaneStatistics::new(&[Reading::default()]).unwrap();
        assert_eq!([dark.uniformity, dark.error_percent], [0.0, 0.0]);
    }
}
