//! False colour: a map from values to colours that grow lighter with the value, and lines of equal
//! value.

/// Colours of the map at equal steps of the value, as sRGB: dark blue, violet, red, orange, yellow,
/// pale yellow. Lightness grows evenly, so that the map reads in grey and with any colour vision.
pub const STOPS: [[u8; 3]; 8] = [
    [13, 16, 62],
    [54, 28, 120],
    [115, 36, 132],
    [171, 50, 114],
    [220, 78, 74],
    [243, 127, 45],
    [248, 187, 71],
    [252, 246, 182],
];

/// Share of the scale above which colours are bright, so that lines on them are black.
pub const BRIGHT: f32 = 0.45;

/// Colour of pixels without a value.
pub const NO_VALUE: [u8; 3] = [90, 90, 90];

/// Returns the colour of a share of the scale; below 0 and above 1 it is that of the ends.
pub fn color(share: f32) -> [u8; 3] {
    let at = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let below = (at as usize).min(STOPS.len() - 2);
    let part = at - below as f32;
    std::array::from_fn(|c| {
        let [a, b] = [STOPS[below][c], STOPS[below + 1][c]].map(f32::from);
        (a + (b - a) * part).round() as u8
    })
}

/// Returns the end of an automatic scale: the 98th percentile of the values, rounded up to 1, 2 or
/// 5 times a power of ten. Values that are not finite or not above zero do not count, and neither
/// do patches that are far brighter than the rest, such as direct sun in a room. `None` where no
/// value is above zero.
pub fn automatic_scale(values: &[f32]) -> Option<f32> {
    Some(round_up(f64::from(usual_maximum(values)?)) as f32)
}

/// Returns the 98th percentile of the values without those that lie far above the rest: above the
/// upper quartile by more than the distance of the quartiles, on a logarithmic scale. `None` where
/// no value is above zero.
///
/// Source: Tukey 1977, "Exploratory Data Analysis". We differ: he allows 1.5 times that distance, at
/// which direct sun in a bright hall still counts.
pub fn usual_maximum(values: &[f32]) -> Option<f32> {
    let mut known: Vec<f32> = values.iter().copied().filter(|v| v.is_finite() && *v > 0.0).collect();
    let (quarter, upper) = (quantile(&mut known, 0.25)?, quantile(&mut known, 0.75)?);
    let fence = upper * (upper / quarter);
    known.retain(|value| *value <= fence);
    quantile(&mut known, 0.98)
}

/// Returns the value below which a share of the values lies; reorders them.
fn quantile(values: &mut [f32], share: f64) -> Option<f32> {
    let at = (values.len().checked_sub(1)? as f64 * share) as usize;
    Some(*values.select_nth_unstable_by(at, f32::total_cmp).1)
}

/// Returns the share (0..1) of the values with a colour that lie above the scale, and the largest
/// of them.
pub fn above_scale(values: &[f32], max: f32) -> (f64, f32) {
    let known = || values.iter().copied().filter(|v| v.is_finite());
    let above = known().filter(|v| *v > max).count();
    (above as f64 / known().count().max(1) as f64, known().fold(0.0, f32::max))
}

/// Returns the distance of lines of equal value on a scale that ends at `max`: about ten of them.
pub fn line_step(max: f32) -> f32 {
    round_up(f64::from(max) / 12.0) as f32
}

/// Returns the smallest number of the form 1, 2 or 5 times a power of ten that is no smaller.
pub fn round_up(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    // A value that is such a number itself is off by its rounding.
    let of = |factor: f64| factor * power;
    [1.0, 2.0, 5.0].map(of).into_iter().find(|&n| n * (1.0 + 1e-9) >= value).unwrap_or(of(10.0))
}

/// Returns a picture of values, row-major, on a scale from 0 to `max`, as sRGB. Values that are not
/// finite are grey. With a `step`, lines are drawn where the value passes a multiple of it between
/// two pixels of one surface, which `are_one` tells.
pub fn picture(
    values: &[f32],
    width: usize,
    max: f32,
    step: Option<f32>,
    are_one: impl Fn(usize, usize) -> bool,
) -> Vec<[u8; 3]> {
    let mut colors: Vec<[u8; 3]> =
        values.iter().map(|v| if v.is_finite() { color(v / max) } else { NO_VALUE }).collect();
    let Some(step) = step else { return colors };
    let band = |at: usize| values.get(at).filter(|v| v.is_finite()).map(|v| (v / step).floor());
    for at in 0..values.len() {
        let passes = |to: usize| is_line(band(at), band(to)) && are_one(at, to);
        if ((at + 1) % width.max(1) != 0 && passes(at + 1)) || passes(at + width) {
            // Black on bright colours, white on dark ones.
            colors[at] = if values[at] / max > BRIGHT { [0; 3] } else { [255; 3] };
        }
    }
    colors
}

fn is_line(here: Option<f32>, there: Option<f32>) -> bool {
    here.zip(there).is_some_and(|(here, there)| here != there)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_grow_lighter_and_stay_at_the_ends() {
        let light = |share| {
            let [r, g, b] = color(share).map(f32::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for i in 0..100 {
            assert!(light(i as f32 / 100.0) < light((i + 1) as f32 / 100.0), "{i}");
        }
        assert_eq!([color(-1.0), color(2.0)], [STOPS[0], STOPS[7]]);
    }

    #[test]
    fn scales_end_at_round_numbers_above_nearly_all_values() {
        for (value, round) in [(1.0, 1.0), (1.01, 2.0), (4.9, 5.0), (5.0, 5.0), (730.0, 1000.0), (0.03, 0.05)]
        {
            assert!((round_up(value) / round - 1.0).abs() < 1e-9, "{value}");
        }
        let mut values: Vec<f32> = (1..=100).map(|v| v as f32).collect();
        values.extend([f32::NAN, f32::INFINITY, -1.0, 0.0]);
        assert_eq!(automatic_scale(&values), Some(100.0));
        assert_eq!(automatic_scale(&[0.0, f32::NAN]), None);
        assert_eq!((line_step(500.0), line_step(1000.0)), (50.0, 100.0));
    }

    #[test]
    fn a_patch_of_sun_does_not_stretch_the_scale() {
        let mut room: Vec<f32> = (0..900).map(|v| 100.0 + v as f32).collect();
        room.extend([60_000.0; 100]);
        assert_eq!(automatic_scale(&room), Some(1000.0));
        assert_eq!(above_scale(&room, 1000.0), (0.1, 60_000.0));
        assert_eq!(automatic_scale(&[3.0; 9]), Some(5.0), "even light is no patch");
    }

    #[test]
    fn lines_lie_where_the_value_passes_a_step() {
        let values: Vec<f32> = (0..20).map(|i| (i % 10) as f32 + 0.5).collect();
        let picture = picture(&values, 10, 10.0, Some(5.0), |_, _| true);
        let lines: Vec<usize> = (0..20).filter(|&at| picture[at] != color(values[at] / 10.0)).collect();
        assert_eq!(lines, [4, 14], "between 4.5 and 5.5, and not at the end of a row");
        let none = super::picture(&[f32::NAN, 1.0], 2, 10.0, Some(0.5), |_, _| true);
        assert_eq!(none[0], NO_VALUE);
        let outlined = super::picture(&values, 10, 10.0, Some(5.0), |_, _| false);
        assert!(outlined.iter().zip(&values).all(|(c, v)| *c == color(v / 10.0)), "no line at outlines");
    }
}
