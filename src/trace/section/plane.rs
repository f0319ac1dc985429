//! The planes of a section, in world metres, and the region that they keep.

use crate::math::Ray;
use crate::scene::SceneFrame;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// A plane across one of the world's axes, and the side of it that is kept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CutPlane {
    /// Axis that the plane is perpendicular to: 0 for x, 1 for y (up), 2 for z.
    pub axis: usize,
    /// Coordinate of the plane along that axis, world metres.
    pub at_m: f64,
    /// True where the part with greater coordinates is kept.
    pub keeps_above: bool,
}

impl std::fmt::Display for CutPlane {
    /// The plane as the flag `--section` takes it, such as `x=2.5,keep=low`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let axis = ['x', 'y', 'z'].get(self.axis).copied().unwrap_or('?');
        write!(f, "{axis}={},keep={}", self.at_m, if self.keeps_above { "high" } else { "low" })
    }
}

impl CutPlane {
    /// The plane that removes the side on which `eye` (world metres) is, so that one looks in.
    pub fn away_from(axis: usize, at_m: f64, eye: DVec3) -> Self {
        Self { axis, at_m, keeps_above: eye[axis] < at_m }
    }

    /// The six planes that keep what lies between two corners (world metres).
    pub fn of_box([low, high]: [DVec3; 2]) -> [Self; 6] {
        std::array::from_fn(|i| {
            let (axis, keeps_above) = (i % 3, i < 3);
            Self { axis, at_m: if keeps_above { low[axis] } else { high[axis] }, keeps_above }
        })
    }
}

/// Distance in scene units by which the kept region ends before its planes: a face that lies in a
/// plane is removed, and not kept or removed by the rounding of its hits. A model is 512 to 1024
/// units wide, so this is 0.3 mm in a house of 20 m.
const INSET: f32 = 1.0 / 64.0;

/// A half-space that is kept: `sign * (p[axis] - at) >= 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HalfSpace {
    axis: usize,
    at: f32,
    sign: f32,
}

/// The convex region that a section keeps, in scene space.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Region {
    half_spaces: Vec<HalfSpace>,
}

/// Where a ray passes through a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    /// First `t` inside; 0 where the ray begins inside.
    pub(super) start: f32,
    /// Last `t` inside; infinite where the ray stays inside.
    pub(super) end: f32,
    /// Index of the plane through which the ray enters; `None` where it begins inside.
    pub(super) entered: Option<usize>,
}

impl Region {
    pub(super) fn new(planes: &[CutPlane], frame: &SceneFrame) -> Self {
        let half_space = |plane: &CutPlane| {
            let mut point = frame.origin_in_world_m;
            point[plane.axis] = plane.at_m;
            let sign = if plane.keeps_above { 1.0 } else { -1.0 };
            let at = frame.scene_from_world_f64(point)[plane.axis] as f32 + sign * INSET;
            HalfSpace { axis: plane.axis, at, sign }
        };
        Self { half_spaces: planes.iter().map(half_space).collect() }
    }

    /// Clips a ray against the region. `None` where it misses it. The region is convex, so what is
    /// left is one piece.
    pub(super) fn clip(&self, ray: &Ray) -> Option<Interval> {
        let mut piece = Interval { start: 0.0, end: f32::INFINITY, entered: None };
        for (plane, HalfSpace { axis, at, sign }) in self.half_spaces.iter().enumerate() {
            let (depth, step) = (sign * (ray.origin[*axis] - at), sign * ray.direction[*axis]);
            if depth < 0.0 {
                if step <= 0.0 {
                    return None;
                }
                let t = -depth / step;
                if t > piece.start {
                    (piece.start, piece.entered) = (t, Some(plane));
                }
            } else if step < 0.0 {
                piece.end = piece.end.min(-depth / step);
            }
        }
        (piece.start < piece.end).then_some(piece)
    }

    /// Axis of a plane, and where the kept region begins at it, scene units.
    pub(super) fn plane(&self, index: usize) -> (usize, f32) {
        (self.half_spaces[index].axis, self.half_spaces[index].at)
    }

    /// The end of a ray that leaves a surface of the region.
    pub(super) fn end_of(&self, ray: &Ray) -> f32 {
        let end = |half: &HalfSpace| {
            let depth = (half.sign * (ray.origin[half.axis] - half.at)).max(0.0);
            let step = half.sign * ray.direction[half.axis];
            if step < 0.0 { -depth / step } else { f32::INFINITY }
        };
        self.half_spaces.iter().map(end).fold(f32::INFINITY, f32::min)
    }

    /// True where a box (scene space) and the region have a point in common.
    pub(super) fn meets(&self, [low, high]: [Vec3; 2]) -> bool {
        self.half_spaces.iter().all(|half| {
            let nearest = if half.sign > 0.0 { high[half.axis] } else { low[half.axis] };
            half.sign * (nearest - half.at) > 0.0
        })
    }

    /// True where a box (scene space) lies in the region.
    pub(super) fn contains(&self, [low, high]: [Vec3; 2]) -> bool {
        self.half_spaces.iter().all(|half| {
            let farthest = if half.sign > 0.0 { low[half.axis] } else { high[half.axis] };
            half.sign * (farthest - half.at) >= -INSET
        })
    }
}
