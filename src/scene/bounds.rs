//! The bounding box of a model and the scale of scene space.

use super::SceneFrame;
use glam::DVec3;

/// Share of the vertices that is ignored at each end of each axis for the box of the bulk.
const TRIMMED_SHARE: f64 = 1.0 / 1000.0;

/// Ratio of the diagonals of the box of all vertices and the box of the bulk above which centre,
/// scale and views follow the bulk. Examples are a ground plane of a hundred kilometres under a
/// house, or a stray vertex written by a broken exporter.
const OUTLIER_RATIO: f64 = 1024.0;

/// Largest world coordinate in metres. Squares of larger lengths overflow.
const MAX_COORDINATE_M: f64 = 1e100;

/// True if a position is finite and at most 1e100 m from the origin along each axis.
pub(crate) fn is_valid_position(p: DVec3) -> bool {
    p.abs().max_element() <= MAX_COORDINATE_M && p.is_finite()
}

/// Returns the lower and upper corner of the box of all vertices in use, and false; or of the box
/// of the bulk, and true, if a few vertices lie far outside. Returns `None` without triangles.
pub(super) fn of(positions: &[DVec3], triangles: &[[u32; 3]]) -> Option<([DVec3; 2], bool)> {
    let used = || triangles.iter().flatten().map(|&v| positions[v as usize]);
    let first = used().next()?;
    let all = used().fold([first, first], |[lo, hi], p| [lo.min(p), hi.max(p)]);
    let bulk = bulk(used().collect());
    let [whole, inner] = [all, bulk].map(|[low, high]| (high - low).length());
    let ignores_outliers = inner > 0.0 && whole > OUTLIER_RATIO * inner;
    Some((if ignores_outliers { bulk } else { all }, ignores_outliers))
}

/// Returns the box without the outermost vertices of each axis, at least those of one triangle at
/// each end.
fn bulk(points: Vec<DVec3>) -> [DVec3; 2] {
    let trimmed = ((points.len() as f64 * TRIMMED_SHARE) as usize).max(3);
    let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
    for axis in 0..3 {
        let mut along: Vec<f64> = points.iter().map(|p| p[axis]).collect();
        let last = along.len() - 1;
        let (from, to) = (trimmed.min(last / 2), last - trimmed.min(last / 2));
        low[axis] = *along.select_nth_unstable_by(from, f64::total_cmp).1;
        high[axis] = *along.select_nth_unstable_by(to, f64::total_cmp).1;
    }
    [low, high]
}

/// Returns the frame in which the diagonal of the box is 512 to 1024 scene units long and its
/// centre lies near the origin.
pub(super) fn frame_for([low, high]: [DVec3; 2]) -> SceneFrame {
    let diagonal = (high - low).length();
    // A single point has no diagonal; any scale is right for it.
    let exponent = if diagonal > 0.0 { 9 - diagonal.log2().floor() as i32 } else { 0 };
    let units_per_metre = exponent_of_two(exponent.clamp(-1000, 1000));
    let centre = low + (high - low) / 2.0;
    // With an origin of whole scene units, which is exact in f64, a model moved by whole units
    // keeps its bits.
    SceneFrame { origin_in_world_m: (centre * units_per_metre).round() / units_per_metre, units_per_metre }
}

/// Returns 2 to the power of `exponent`, exactly.
fn exponent_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
