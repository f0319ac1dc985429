//! Medians and percentiles of a handful of measurements.

/// The middle value; the mean of the two middle ones of an even number. `None` without values.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let sorted = sorted(values);
    let half = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[half]),
        _ => Some((sorted[half - 1] + sorted[half]) / 2.0),
    }
}

/// The smallest value that at least `percent` of all values do not exceed (nearest rank). `None` without values.
pub fn percentile(values: impl IntoIterator<Item = f64>, percent: f64) -> Option<f64> {
    let sorted = sorted(values);
    let rank = (percent / 100.0 * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.clamp(1, sorted.len().max(1)) - 1).copied()
}

fn sorted(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}

/// `y = c x^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// Of x.
    pub exponent: f64,
    /// Of the exponent, from how far the points lie off the line; not from how much each of them varies.
    pub standard_error: f64,
}

/// The power law nearest to points with positive coordinates, by least squares of the logarithms. `None` for fewer than
/// three points or one x.
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
