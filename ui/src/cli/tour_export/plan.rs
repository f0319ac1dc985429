//! Where the views of a tour stand, seen from above.

use glam::DVec3;

/// Width and height of the plan's drawing area, in its own units.
const SIDE: f64 = 100.0;

/// Distance of the outermost dots from the edge, in the same units.
const RIM: f64 = 12.0;

/// Returns the place of each eye, in world metres, on a plan of 100 by 100 units, x to the right and
/// z downwards, as the window's plan has them. North is not marked: few models know it.
pub(super) fn dots(eyes: impl Iterator<Item = DVec3>) -> Vec<[f64; 2]> {
    let places: Vec<[f64; 2]> = eyes.map(|eye| [eye.x, eye.z]).collect();
    let range = |axis: usize| {
        let values = places.iter().map(|place| place[axis]);
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max))
    };
    let (ranges, inner) = ([range(0), range(1)], SIDE - 2.0 * RIM);
    let span = ranges.map(|(low, high)| high - low).into_iter().fold(0.0, f64::max);
    let scale = if span > 0.0 { inner / span } else { 0.0 };
    let at = |place: &[f64; 2], axis: usize| {
        let (low, high) = ranges[axis];
        SIDE / 2.0 + (place[axis] - f64::midpoint(low, high)) * scale
    };
    let round = |value: f64| (value * 100.0).round() / 100.0;
    places.iter().map(|place| [round(at(place, 0)), round(at(place, 1))]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plan_keeps_proportions_and_one_place_is_its_middle() {
        let eye = |x: f64, z: f64| DVec3::new(x, 1.6, z);
        assert_eq!(dots([eye(3.0, 4.0)].into_iter()), [[50.0, 50.0]]);
        let found = dots([eye(0.0, 0.0), eye(8.0, 0.0), eye(8.0, 4.0)].into_iter());
        assert_eq!(found, [[12.0, 31.0], [88.0, 31.0], [88.0, 69.0]]);
    }
}
