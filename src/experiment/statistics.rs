//! Medians, percentiles and power laws of a few measurements.

/// Returns the median; for an even number of values, the mean of the two middle ones. `None`
/// without values.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let sorted = sorted(values);
    let half = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[half]),
        _ => Some((sorted[half - 1] + sorted[half]) / 2.0),
    }
}

/// Returns the smallest value that at least `percent` % of all values do not exceed (nearest rank).
/// `None` without values.
pub fn percentile(values: impl IntoIterator<Item = f64>, percent: f64) -> Option<f64> {
    let sorted = sorted(values);
    let rank = (percent / 100.0 * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.clamp(1, sorted.len().max(1)) - 1).copied()
}

/// Returns the geometric mean of positive values. `None` without values.
pub fn geometric_mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.into_iter().fold((0.0, 0u32), |(sum, count), v| (sum + v.ln(), count + 1));
    (count > 0).then(|| (sum / f64::from(count)).exp())
}

/// Returns the 25th and the 75th percentile. `None` without values.
pub fn quartiles(values: impl Iterator<Item = f64> + Clone) -> Option<[f64; 2]> {
    Some([percentile(values.clone(), 25.0)?, percentile(values, 75.0)?])
}

fn sorted(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}

/// A fitted power law `y = c x^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// Exponent of x.
    pub exponent: f64,
    /// Standard error of the exponent, from the distances of the points to the line, not from the
    /// spread of each point.
    pub standard_error: f64,
}

/// Fits a power law to points with positive coordinates, by least squares of the logarithms. `None`
/// for fewer than three points or a single x.
pub fn power_law(points: &[[f64; 2]]) -> Option<PowerLaw> {
    let logs: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::ln)).collect();
    let count = logs.len() as f64;
    let mean = |axis: usize| logs.iter().map(|p| p[axis]).sum::<f64>() / count;
    let (mean_x, mean_y) = (mean(0), mean(1));
    let spread: f64 = logs.iter().map(|p| (p[0] - mean_x).powi(2)).sum();
    if logs.len() < 3 || !(spread > 0.0 && mean_y.is_finite()) {
        return None;
    }
    let exponent = logs.iter().map(|p| (p[0] - mean_x) * (p[1] - mean_y)).sum::<f64>() / spread;
    let off: f64 = logs.iter().map(|p| (p[1] - mean_y - exponent * (p[0] - mean_x)).powi(2)).sum();
    Some(PowerLaw { exponent, standard_error: (off / (count - 2.0) / spread).sqrt() })
}
