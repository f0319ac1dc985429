//! Guth's position index: how much less a glare source disturbs the farther it lies from the line
//! of sight.

use glam::Vec3;

/// Largest index: beyond it the data end.
const MAX_INDEX: f32 = 16.0;

/// Distance below the line of sight, as a share of the distance along it, up to which the slope of
/// the index is [`NEAR_SLOPE`].
const NEAR: f32 = 0.6;
const NEAR_SLOPE: f32 = 0.8;
const FAR_SLOPE: f32 = 1.2;

/// Distance below the line of sight from which the index stays the same.
const FARTHEST: f32 = 3.0;

/// Returns the position index of a source in a unit `direction` for a viewer who looks along the
/// unit vector `ahead`, with the head's unit vector `up` at right angles to it. Behind the viewer it
/// is the largest.
///
/// Source: above the line of sight Luckiesh and Guth 1949 in the form of the IESNA Lighting Handbook
/// (2000); below it Iwata and Tokura 1997, with the limits of Wienold's Evalglare.
pub fn position_index(direction: Vec3, ahead: Vec3, up: Vec3) -> f32 {
    let along = direction.dot(ahead).clamp(-1.0, 1.0);
    if along <= 0.0 {
        return MAX_INDEX;
    }
    let angle = along.acos();
    let index = if direction.dot(up) >= 0.0 {
        let across = direction - ahead * along;
        let from_vertical = across.normalize_or(up).dot(up).clamp(-1.0, 1.0).acos();
        above(from_vertical.to_degrees(), angle.to_degrees())
    } else {
        let share = angle.tan().min(FARTHEST);
        1.0 + share * if share < NEAR { NEAR_SLOPE } else { FAR_SLOPE }
    };
    index.min(MAX_INDEX)
}

/// The index above the line of sight, for the angle between the plane through the source and the
/// line of sight and the vertical one, and for that between the source and the line of sight, both
/// in degrees.
fn above(tau: f32, sigma: f32) -> f32 {
    let linear = 35.2 - 0.31889 * tau - 1.22 * (-2.0 * tau / 9.0).exp();
    let square = 21.0 + 0.26667 * tau - 0.002963 * tau * tau;
    (linear * 1e-3 * sigma + square * 1e-5 * sigma * sigma).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of the CIE (117-1995), for distances above and beside the line of sight as shares
    /// of the distance along it.
    #[test]
    fn the_index_has_the_values_of_the_table() {
        for (above, beside, expected) in [
            (0.0, 0.0, 1.0),
            (0.5, 0.0, 2.86),
            (1.0, 0.0, 7.0),
            (0.3, 0.0, 1.9),
            (0.0, 0.1, 1.05),
            (0.0, 0.2, 1.12),
        ] {
            let direction = Vec3::new(beside, above, -1.0).normalize_or(Vec3::NEG_Z);
            let index = position_index(direction, Vec3::NEG_Z, Vec3::Y);
            assert!((index / expected - 1.0).abs() < 0.03, "{above} {beside}: {index} for {expected}");
        }
    }

    #[test]
    fn the_index_grows_away_from_the_line_of_sight_and_is_symmetric() {
        for turn in [0.0f32, 0.7, 1.5, 2.5] {
            let mut last = 1.0 - 1e-6;
            for step in 0..60 {
                let angle = (step as f32).to_radians();
                let at = |side: f32| {
                    let direction =
                        Vec3::new(side * turn.sin() * angle.sin(), turn.cos() * angle.sin(), -angle.cos());
                    position_index(direction, Vec3::NEG_Z, Vec3::Y)
                };
                assert!(at(1.0) >= last && (at(1.0) - at(-1.0)).abs() < 1e-4, "{turn} {step}");
                last = at(1.0);
            }
        }
        assert_eq!(position_index(Vec3::Z, Vec3::NEG_Z, Vec3::Y), MAX_INDEX);
    }
}
