//! An axis of a chart: the range it shows, positions of values along it, and tick marks.

use afterimage::experiment::run::report::Scale;

/// Range of an axis. Values are mapped to 0 at the low end and 1 at the high end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    low: f64,
    high: f64,
    scale: Scale,
}

/// Margin at both ends, as a fraction of the range.
const MARGIN: f64 = 0.04;

/// A logarithmic axis whose ends have a smaller ratio gets linear tick marks: it contains too few
/// powers of ten.
const FEW_POWERS: f64 = 5.0;

/// A logarithmic axis whose ends have a larger ratio gets tick marks only at powers of ten.
const MANY_POWERS: f64 = 1000.0;

impl Span {
    /// The range of all values that the scale can show; `None` if there are none.
    pub(super) fn of(values: impl IntoIterator<Item = f64>, scale: Scale) -> Option<Self> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.into_iter().filter(|v| is_shown(*v, scale)) {
            (low, high) = (low.min(value), high.max(value));
        }
        (low <= high).then(|| Self { low, high, scale }.widened())
    }

    fn widened(self) -> Self {
        let [low, high] = [self.low, self.high].map(|v| self.on_axis(v));
        let margin = match high - low {
            0.0 if self.scale == Scale::Logarithmic => std::f64::consts::LN_2,
            0.0 => low.abs().max(1.0) / 2.0,
            length => length * MARGIN,
        };
        // A linear axis of non-negative values does not extend below zero.
        let low =
            if self.scale == Scale::Linear && low >= 0.0 { (low - margin).max(0.0) } else { low - margin };
        Self { low: self.value_at(low), high: self.value_at(high + margin), scale: self.scale }
    }

    pub(super) fn length(self) -> f64 {
        self.high - self.low
    }

    /// Position of a value, 0..1 within the range; `None` if the scale cannot show it.
    pub(super) fn position(self, value: f64) -> Option<f64> {
        let [low, high, at] = [self.low, self.high, value].map(|v| self.on_axis(v));
        is_shown(value, self.scale).then(|| (at - low) / (high - low))
    }

    fn on_axis(self, value: f64) -> f64 {
        if self.scale == Scale::Logarithmic { value.ln() } else { value }
    }

    fn value_at(self, along: f64) -> f64 {
        if self.scale == Scale::Logarithmic { along.exp() } else { along }
    }

    /// Round values within the range, in ascending order.
    pub(super) fn ticks(self) -> Vec<f64> {
        let ratio = self.high / self.low;
        if self.scale == Scale::Linear || ratio < FEW_POWERS {
            return self.linear_ticks();
        }
        let steps: &[f64] = if ratio > MANY_POWERS { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let powers = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let all = powers.flat_map(|p| steps.iter().map(move |s| s * 10f64.powi(p)));
        all.filter(|v| (self.low..=self.high).contains(v)).collect()
    }

    fn linear_ticks(self) -> Vec<f64> {
        /// Approximate maximum number of tick marks.
        const COUNT: f64 = 6.0;
        let rough = self.length() / COUNT;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * power).into_iter().find(|s| *s >= rough);
        let step = step.unwrap_or(10.0 * power);
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step).floor() as i64;
        (first..=last).map(|n| n as f64 * step).collect()
    }
}

fn is_shown(value: f64, scale: Scale) -> bool {
    value.is_finite() && (scale == Scale::Linear || value > 0.0)
}

/// Shortest text of a round value.
pub(super) fn tick_label(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        let text = format!("{value:.2e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'));
    }
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: [f64; 2], scale: Scale) -> Vec<String> {
        Span::of(values, scale).unwrap().ticks().into_iter().map(tick_label).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels([0.0, 10.0], Scale::Linear), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels([-1.0, 1.0], Scale::Linear), ["-1", "-0.5", "0", "0.5", "1"]);
        assert_eq!(
            labels([0.01, 1.0], Scale::Logarithmic),
            ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1"]
        );
        assert_eq!(labels([1e-6, 1.0], Scale::Logarithmic)[..3], ["1e-6", "1e-5", "0.0001"]);
        assert_eq!(labels([30.0, 42.0], Scale::Logarithmic), ["30", "35", "40"]);
    }

    #[test]
    fn positions_are_fractions_of_the_range() {
        let span = Span::of([1.0, 100.0], Scale::Logarithmic).unwrap();
        assert!((span.position(10.0).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(span.position(0.0), None, "a logarithmic axis has no zero");
        assert_eq!(Span::of([f64::NAN, f64::INFINITY], Scale::Linear), None);
        let one = Span::of([5.0], Scale::Linear).unwrap();
        assert_eq!(one.position(5.0), Some(0.5));
    }
}
