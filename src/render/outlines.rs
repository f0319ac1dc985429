//! Lines where the surfaces of a picture end or bend: contours by depth, creases by normal. They
//! are as wide in pixels near and far.
//!
//! Source: Saito and Takahashi, "Comprehensible Rendering of 3-D Shapes", SIGGRAPH 1990. We differ:
//! a step of depth is one that neither of the two surfaces' planes explains, so that a floor seen at
//! a grazing angle has no lines.

use super::frame::Frame;
use crate::camera::{Camera, View};
use crate::trace::{NO_TRIANGLE, TILE_RAYS, TILE_SIDE, TileHits, Tracer, primary_tile};
use glam::Vec3;
use rayon::prelude::*;

/// Largest cosine of the angle between two faces whose common edge is a crease: 25 degrees.
const CREASE: f32 = 0.906;

/// Largest relative difference of depth between a surface and the plane of its neighbour that is
/// not a step.
const STEP: f32 = 0.01;

/// Points across a pixel at which the surfaces of a picture are compared.
const POINTS: usize = 2;

/// Rows of pixels that are done as one piece.
const BAND: usize = 32;

/// Widest line, pixels.
pub const MAX_OUTLINE_WIDTH: u32 = 16;

/// What a point of the picture shows.
#[derive(Clone, Copy, Default)]
struct Shown {
    /// 1 / depth; 0 for the sky.
    disparity: f32,
    /// Unit normal on the viewer's side; zero for the cap of a section.
    normal: Vec3,
    /// Distance of the plane from the eye along the normal; negative.
    height: f32,
}

impl Shown {
    fn new(tracer: &Tracer, eye: Vec3, triangle: u32, disparity: f32) -> Self {
        if triangle == NO_TRIANGLE {
            return Self { disparity, ..Self::default() };
        }
        let [a, b, c] = tracer.scene().corners(triangle);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let height = normal.dot(a - eye);
        let (normal, height) = if height > 0.0 { (-normal, -height) } else { (normal, height) };
        Self { disparity, normal, height }
    }

    /// True where a line runs between two neighbouring points, seen along these directions.
    fn differs(&self, other: &Self, directions: [Vec3; 2]) -> bool {
        let [sky, other_sky] = [self, other].map(|shown| shown.disparity <= 0.0);
        let [cap, other_cap] = [self, other].map(|shown| shown.normal == Vec3::ZERO);
        if sky || other_sky || cap || other_cap {
            return (sky, cap) != (other_sky, other_cap);
        }
        let leaves = |from: &Self, to: &Self, direction: Vec3| {
            let expected = from.normal.dot(direction) / from.height;
            (expected / to.disparity - 1.0).abs() > STEP
        };
        self.normal.dot(other.normal) < CREASE
            || leaves(self, other, directions[1]) && leaves(other, self, directions[0])
    }
}

/// Points of some rows of a picture.
struct Grid<'a> {
    view: &'a View,
    first_row: usize,
    width: usize,
    shown: Vec<Shown>,
}

impl Grid<'_> {
    fn rows(&self) -> usize {
        self.shown.len() / self.width.max(1)
    }

    fn direction(&self, x: usize, y: usize) -> Vec3 {
        self.view.direction_of_point(x as f32 + 0.5, (self.first_row + y) as f32 + 0.5)
    }

    /// Marks the points on both sides of every line, or where `is_thin` the nearer side.
    fn marks(&self, is_thin: bool) -> Vec<bool> {
        let mut marks = vec![false; self.shown.len()];
        for y in 0..self.rows() {
            for x in 0..self.width {
                let at = y * self.width + x;
                let right = (x + 1 < self.width).then_some((at + 1, [x + 1, y]));
                let down = (y + 1 < self.rows()).then_some((at + self.width, [x, y + 1]));
                for (other, [i, j]) in right.into_iter().chain(down) {
                    let (a, b) = (&self.shown[at], &self.shown[other]);
                    if a.differs(b, [self.direction(x, y), self.direction(i, j)]) {
                        marks[at] |= !is_thin || a.disparity >= b.disparity;
                        marks[other] |= !is_thin || a.disparity < b.disparity;
                    }
                }
            }
        }
        marks
    }
}

/// Returns how much of each pixel of a view is covered by lines, 0..1, row-major. Lines are `width`
/// pixels wide, at most [`MAX_OUTLINE_WIDTH`].
pub fn outlines_of_view(tracer: &Tracer, camera: &Camera, size: [u32; 2], width: u32) -> Vec<f32> {
    let fine = size.map(|side| side * POINTS as u32);
    let view = View::new(camera, &tracer.scene().frame, fine);
    let reach = (width.clamp(1, MAX_OUTLINE_WIDTH) as usize - 1) * POINTS / 2;
    let columns = size[0] as usize;
    let mut covered = vec![0.0; columns * size[1] as usize];
    covered.par_chunks_mut((columns * BAND).max(1)).enumerate().for_each(|(band, covered)| {
        let first = band * BAND * POINTS;
        let grid = points(tracer, &view, first.saturating_sub(reach + 1), first + BAND * POINTS + reach + 1);
        let marks = widened(&grid.marks(false), grid.width, reach);
        for (i, covered) in covered.iter_mut().enumerate() {
            let (x, y) = (i % columns * POINTS, i / columns * POINTS + first - grid.first_row);
            let inside =
                (0..POINTS * POINTS).filter(|k| marks[(y + k / POINTS) * grid.width + x + k % POINTS]);
            *covered = inside.count() as f32 / (POINTS * POINTS) as f32;
        }
    });
    covered
}

/// Traces the points of some rows of a view, cut off at its end.
fn points<'a>(tracer: &Tracer, view: &'a View, first: usize, end: usize) -> Grid<'a> {
    let first = first - first % TILE_SIDE;
    let end = end.min(view.size[1] as usize);
    let width = view.size[0] as usize;
    let mut shown = vec![Shown::default(); width * (end - first)];
    let (mut tile, mut hits) = (primary_tile(view, [0, 0]), TileHits::NONE);
    for y0 in (first..end).step_by(TILE_SIDE) {
        for x0 in (0..width).step_by(TILE_SIDE) {
            tracer.closest_in_tile(view, [x0 as u32, y0 as u32], &mut tile, &mut hits);
            for ray in 0..TILE_RAYS {
                let (x, y) = (x0 + ray % TILE_SIDE, y0 + ray / TILE_SIDE);
                if x < width && y < end {
                    let disparity = match hits.hit(ray) {
                        Some(hit) => 1.0 / hit.t,
                        None => tracer.cap(&tile.ray(ray)).map_or(0.0, |cap| 1.0 / cap.t),
                    };
                    shown[(y - first) * width + x] =
                        Shown::new(tracer, view.eye, hits.triangle[ray], disparity);
                }
            }
        }
    }
    Grid { view, first_row: first, width, shown }
}

/// The marks, and all points at most `reach` rows and columns away.
fn widened(marks: &[bool], width: usize, reach: usize) -> Vec<bool> {
    if reach == 0 {
        return marks.to_vec();
    }
    let rows = marks.len() / width.max(1);
    let along = |from: &[bool], at: usize, count: usize, at_step: &dyn Fn(usize) -> usize| {
        (at.saturating_sub(reach)..(at + reach + 1).min(count)).any(|i| from[at_step(i)])
    };
    let wide: Vec<bool> =
        (0..marks.len()).map(|i| along(marks, i % width, width, &|x| i - i % width + x)).collect();
    (0..marks.len()).map(|i| along(&wide, i / width, rows, &|y| y * width + i % width)).collect()
}

/// Returns whether each pixel of a rendered frame lies on a line; lines are one pixel wide.
pub fn outlines_of_frame(tracer: &Tracer, frame: &Frame) -> Vec<bool> {
    let view = &frame.view;
    let of_pixel = |(&triangle, &disparity): (&u32, &f32)| Shown::new(tracer, view.eye, triangle, disparity);
    let shown = frame.triangle.par_iter().zip(&frame.disparity).map(of_pixel).collect();
    Grid { view, first_row: 0, width: view.size[0] as usize, shown }.marks(true)
}
