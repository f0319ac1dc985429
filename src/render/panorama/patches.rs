//! The pinhole pictures that cover a panorama, band by band.

use super::projection::Equirectangular;
use crate::camera::Camera;
use glam::{DMat3, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

/// Latitude bands of a small panorama: 30 degrees each, so that the pixels in a patch's corners are
/// at most 1.3 times as dense as those in its middle.
const MIN_BANDS: u32 = 6;

/// Rows of the panorama in a band at most. The patch at a pole is about 2.4 times as wide.
const MAX_BAND_ROWS: u32 = 700;

/// Pixels of a patch beyond the part that is shown, on each side: interpolation reads two.
const MARGIN: f64 = 3.0;

/// Points on each edge of a patch at which its field of view is measured.
const EDGE_POINTS: u32 = 16;

/// A pinhole picture that shows a rectangle of a panorama.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Patch {
    /// Columns of the panorama that it shows.
    pub(super) columns: Range<u32>,
    pub(super) camera: Camera,
    pub(super) size: [u32; 2],
}

/// Returns the rows of each band of a panorama, from the top. Each band is a range of latitudes
/// within one half of the sphere.
pub(super) fn bands(projection: &Equirectangular) -> Vec<Range<u32>> {
    let height = projection.size()[1];
    let count = MIN_BANDS.max(height.div_ceil(MAX_BAND_ROWS).next_multiple_of(2)).min(height.max(2));
    let edge = |i: u32| (u64::from(height) * u64::from(i) / u64::from(count)) as u32;
    (0..count).map(|i| edge(i)..edge(i + 1)).filter(|rows| !rows.is_empty()).collect()
}

/// Returns the patches of a band. In its middle, each has pixels as dense as the panorama's on the
/// horizon, and denser ones elsewhere.
pub(super) fn patches(projection: &Equirectangular, eye: DVec3, rows: &Range<u32>) -> Vec<Patch> {
    let [width, height] = projection.size();
    let (low, high) = (projection.pitch_of(rows.end.into()), projection.pitch_of(rows.start.into()));
    let is_pole = rows.start == 0 || rows.end == height;
    let across = if low.signum() == high.signum() { low.abs().min(high.abs()).cos() } else { 1.0 };
    let count =
        if is_pole { 1 } else { ((TAU * across / (high - low)).round() as u32).clamp(4, width.max(4)) };
    let edge = |i: u32| (u64::from(width) * u64::from(i) / u64::from(count)) as u32;
    let columns = (0..count).map(|i| edge(i)..edge(i + 1)).filter(|columns| !columns.is_empty());
    columns.map(|columns| patch(projection, eye, (rows, columns), (low, high))).collect()
}

fn patch(
    projection: &Equirectangular,
    eye: DVec3,
    (rows, columns): (&Range<u32>, Range<u32>),
    (low, high): (f64, f64),
) -> Patch {
    let is_whole = columns == (0..projection.size()[0]);
    let pitch = match is_whole {
        true if high > 0.0 => FRAC_PI_2,
        true => -FRAC_PI_2,
        false => f64::midpoint(low, high),
    };
    let yaw = projection.yaw_of(f64::from(columns.start + columns.end) / 2.0);
    let camera = Camera { eye, yaw, pitch, fov_y: PI / 3.0, roll: 0.0 };
    let reach = reach(projection, &camera.world_from_camera(), rows, &columns);
    let pixels_per_unit = 1.0 / projection.column_angle();
    let size = reach.map(|tan| 2 * (tan * pixels_per_unit + MARGIN).ceil() as u32);
    let fov_y = 2.0 * (f64::from(size[1]) / 2.0 / pixels_per_unit).atan();
    Patch { columns, camera: Camera { fov_y, ..camera }, size }
}

/// The largest distance of a shown point from the middle of the picture plane at depth one, across
/// and upwards.
fn reach(projection: &Equirectangular, axes: &DMat3, rows: &Range<u32>, columns: &Range<u32>) -> [f64; 2] {
    let between = |range: &Range<u32>, i: u32| {
        let part = f64::from(i) / f64::from(EDGE_POINTS);
        f64::from(range.start) + part * f64::from(range.end - range.start)
    };
    let mut reach = [0.0f64; 2];
    for i in 0..=EDGE_POINTS {
        let (x, y) = (between(columns, i), between(rows, i));
        let (left, right) = (columns.start.into(), columns.end.into());
        let (top, bottom) = (rows.start.into(), rows.end.into());
        for point in [[x, top], [x, bottom], [left, y], [right, y]] {
            let local = axes.transpose() * projection.direction(point);
            reach[0] = reach[0].max((local.x / local.z).abs());
            reach[1] = reach[1].max((local.y / local.z).abs());
        }
    }
    reach
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{SceneFrame, View};

    /// Every pixel of a panorama lies in its patch, two pixels and more from the edge, and patches
    /// are neither coarser than the panorama nor needlessly large.
    #[test]
    fn patches_cover_every_pixel_with_a_margin() {
        let frame = SceneFrame { origin_in_world_m: DVec3::ZERO, units_per_metre: 1.0 };
        for (size, stride) in [([64, 32], 1), ([8, 4], 1), ([1024, 512], 7), ([16384, 8192], 509)] {
            let camera = Camera::look_at(DVec3::ONE, DVec3::new(3.0, 1.0, 2.0), 60.0);
            let projection = Equirectangular::new(&camera, size);
            let (mut pixels, mut next_row) = (0, 0);
            for rows in bands(&projection) {
                assert_eq!(rows.start, next_row);
                next_row = rows.end;
                let mut next_column = 0;
                for patch in patches(&projection, camera.eye, &rows) {
                    assert_eq!(patch.columns.start, next_column);
                    next_column = patch.columns.end;
                    assert!(patch.camera.is_valid(), "{size:?} {patch:?}");
                    pixels += patch.size.map(u64::from).iter().product::<u64>();
                    let view = View::new(&patch.camera, &frame, patch.size);
                    let inverse = view.scene_from_pixel_f64.inverse();
                    let inside = |at: f64, side: u32| at >= 2.0 && at <= f64::from(side) - 2.0;
                    for y in rows.clone().step_by(stride).chain([rows.end - 1]) {
                        for x in patch.columns.clone().step_by(stride).chain([patch.columns.end - 1]) {
                            let direction = projection.direction([f64::from(x) + 0.5, f64::from(y) + 0.5]);
                            let q = inverse * direction;
                            let is_inside =
                                inside(q.x / q.z, patch.size[0]) && inside(q.y / q.z, patch.size[1]);
                            assert!(q.z > 0.0 && is_inside, "{size:?} {x} {y} {patch:?}");
                        }
                    }
                }
                assert_eq!(next_column, size[0]);
            }
            assert_eq!(next_row, size[1]);
            let shown = size.map(u64::from).iter().product::<u64>();
            assert!(size[0] < 1024 || pixels < shown * 6 / 5, "{size:?}: {pixels} for {shown}");
        }
    }
}
