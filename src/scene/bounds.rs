//! Where a model is and how large: the box of its vertices, or of the bulk of them where a few lie far outside.

use super::SceneFrame;
use glam::DVec3;

/// Each end of each axis gives up so large a share of the vertices for the box of the bulk.
const TRIMMED: f64 = 1.0 / 1000.0;

/// The box of all is this many times the bulk's, or more: a ground plane of a hundred kilometres under a house, or a
/// vertex that a broken exporter threw away. Centre, scale and views then follow the bulk.
const OUTLYING: f64 = 1024.0;

/// Lower and upper corner of what the scene is about, metres, and whether vertices outside were ignored. `None`
/// without a vertex.
pub(super) fn of(positions: &[DVec3], triangles: &[[u32; 3]]) -> Option<([DVec3; 2], bool)> {
    let used = || triangles.iter().flatten().map(|&v| positions[v as usize]);
    let first = used().next()?;
    let all = used().fold([first, first], |[lo, hi], p| [lo.min(p), hi.max(p)]);
    let bulk = bulk(used().collect());
    let [whole, inner] = [all, bulk].map(|[low, high]| (high - low).length());
    let ignores = inner > 0.0 && whole > OUTLYING * inner;
    Some((if ignores { bulk } else { all }, ignores))
}

/// The box without the outermost vertices of each axis, at least one triangle's on either side.
fn bulk(points: Vec<DVec3>) -> [DVec3; 2] {
    let trimmed = ((points.len() as f64 * TRIMMED) as usize).max(3);
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

/// The frame that brings the box's diagonal to 512..1024 scene units and its centre near the origin.
pub(super) fn frame_for([low, high]: [DVec3; 2]) -> SceneFrame {
    let diagonal = (high - low).length();
    // A single point has no diagonal; any scale serves.
    let exponent = if diagonal > 0.0 { 9 - diagonal.log2().floor() as i32 } else { 0 };
    let units_per_metre = exponent_of_two(exponent.clamp(-1000, 1000));
    let centre = low + (high - low) / 2.0;
    // Whole scene units: the origin is then exact in f64, and a model moved by whole units keeps its bits.
    SceneFrame { origin_in_world_m: (centre * units_per_metre).round() / units_per_metre, units_per_metre }
}

fn exponent_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
