//! A view as the rasteriser sees it, and the bounds of its rounding errors.
//!
//! The bounds are derived in the documentation of [`super`]; `u` is [`UNIT`].

use crate::camera::View;
use crate::math::Ray;
use crate::trace::bvh::{TILE_RAYS, TILE_SIDE};
use arrayvec::ArrayVec;
use glam::{DMat3, Mat3, Vec3};

/// Side of a bin in pixels.
pub(super) const BIN_SIDE: usize = 64;

/// Number of pixels of a bin.
pub(super) const BIN_PIXELS: usize = BIN_SIDE * BIN_SIDE;

/// Tiles in a row of a bin.
pub(super) const BIN_TILES: usize = BIN_SIDE / TILE_SIDE;

/// Half the distance between one and the next number in f32: the largest relative rounding error.
pub(super) const UNIT: f32 = f32::EPSILON / 2.0;

/// What all bins of a view have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    view: View,
    /// Picture point from a position relative to the eye.
    pixel_from_scene: DMat3,
    /// The sum of the magnitudes of which a direction is made, in the 1-norm: `D`.
    magnitude: f32,
}

impl Lens {
    /// Prepares a view; `None` where a number is not finite, or the view has no inverse.
    pub(super) fn new(view: &View) -> Option<Self> {
        let [w, h] = view.size.map(|s| (s as usize).next_multiple_of(BIN_SIDE) as f32);
        let m = view.scene_from_pixel;
        let magnitude = one_norm(m.x_axis) * w + one_norm(m.y_axis) * h + one_norm(m.z_axis);
        let pixel_from_scene = m.as_dmat3().inverse();
        let is_sound = view.eye.is_finite() && magnitude.is_finite() && pixel_from_scene.is_finite();
        is_sound.then_some(Self { view: *view, pixel_from_scene, magnitude })
    }

    /// The bin whose top left pixel is (x0, y0).
    pub(super) fn bin(&self, [x0, y0]: [u32; 2]) -> BinView {
        let (x0, y0, side) = (x0 as f32, y0 as f32, BIN_SIDE as f32);
        let Mat3 { x_axis: dx, y_axis: dy, .. } = self.view.scene_from_pixel;
        let at = |x: f32, y: f32| self.view.direction_of_point(x0 + x * side, y0 + y * side);
        let corners = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        let middle = self.view.scene_from_pixel.as_dmat3()
            * Vec3::new(x0 + side / 2.0, y0 + side / 2.0, 1.0).as_dvec3();
        let middle = middle.as_vec3();
        // Move the origin of the picture to the bin's corner.
        let m = self.pixel_from_scene.transpose();
        let (x, y) = (m.x_axis - m.z_axis * f64::from(x0), m.y_axis - m.z_axis * f64::from(y0));
        let rows = [x.as_vec3(), y.as_vec3(), m.z_axis.as_vec3()];
        // Bound the directions of the bin.
        let spread = one_norm(middle) + (one_norm(dx) + one_norm(dy)) * (side / 2.0);
        let largest = corners.iter().fold(0.0, |most: f32, c| most.max(c.abs().max_element()));
        let row = one_norm(rows[0]).max(one_norm(rows[1])) + side * one_norm(rows[2]);
        BinView {
            view: self.view,
            corner: [x0, y0],
            eye: self.view.eye,
            middle,
            dx,
            dy,
            rows,
            edge_error: UNIT * (44.0 * spread + 6.0 * self.magnitude + 52.0 * largest),
            depth_error: UNIT * 1.1 * (17.0 + 32.0 * spread + 5.3 * self.magnitude),
            pixel_error: UNIT * row * (32.0 + 8.0 * self.magnitude),
            sides: sides(&corners),
            reaches: reaches(&corners, 1.0 - UNIT * (16.0 + 6.0 * self.magnitude)),
        }
    }
}

/// A square of pixels: its rays, and the bounds of rounding errors there.
#[derive(Clone, Debug)]
pub(super) struct BinView {
    view: View,
    /// Top left pixel.
    corner: [f32; 2],
    /// Origin of all rays.
    pub(super) eye: Vec3,
    /// Direction through the middle of the bin.
    pub(super) middle: Vec3,
    /// Change of the direction from one pixel to the next to the right.
    pub(super) dx: Vec3,
    /// Change of the direction from one pixel to the one below.
    pub(super) dy: Vec3,
    /// Projection of a position relative to the eye, in rows: picture x and y from the corner of
    /// the bin, both times depth, and depth.
    pub(super) rows: [Vec3; 3],
    /// Error of an edge function, as a share of `M L`.
    pub(super) edge_error: f32,
    /// Relative error of a disparity that is due to corners and directions, as a share of `M |N| /
    /// |V|`.
    pub(super) depth_error: f32,
    /// Error of a projected corner in pixels, as a share of `M` over its depth.
    pub(super) pixel_error: f32,
    /// Normals of the planes through the eye and the sides of the bin, facing inwards.
    pub(super) sides: [Vec3; 4],
    /// Lower bounds of the distance at which any ray of the bin meets a point. All hold where their
    /// axis is a ray's largest, so the least is the bound.
    pub(super) reaches: ArrayVec<Reach, 3>,
}

impl BinView {
    /// The ray through the centre of a pixel, given by its index in the bin.
    pub(super) fn ray(&self, pixel: usize) -> Ray {
        let (tile, within) = (pixel / TILE_RAYS, pixel % TILE_RAYS);
        let x = tile % BIN_TILES * TILE_SIDE + within % TILE_SIDE;
        let y = tile / BIN_TILES * TILE_SIDE + within / TILE_SIDE;
        let [x0, y0] = self.corner;
        Ray::new(self.eye, self.view.direction_of_point(x0 + x as f32 + 0.5, y0 + y as f32 + 0.5))
    }
}

/// The bound `x[axis] * scale` for a position `x` relative to the eye.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    pub(super) axis: usize,
    pub(super) scale: f32,
}

/// Sum of the magnitudes of the components.
fn one_norm(v: Vec3) -> f32 {
    v.abs().element_sum()
}

fn sides(corners: &[Vec3; 4]) -> [Vec3; 4] {
    let inside = corners[0] + corners[1] + corners[2] + corners[3];
    std::array::from_fn(|i| {
        let normal = corners[i].cross(corners[(i + 1) % 4]);
        if normal.dot(inside) < 0.0 { -normal } else { normal }
    })
}

/// One bound for each axis that may be the largest of a ray between the corners, times `rounding`.
fn reaches(corners: &[Vec3; 4], rounding: f32) -> ArrayVec<Reach, 3> {
    let low = corners.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = corners.iter().copied().reduce(Vec3::max).unwrap_or_default();
    let most = low.abs().max(high.abs());
    let has_one_sign = |axis: usize| (low[axis] > 0.0) == (high[axis] > 0.0);
    let least = |axis: usize| if has_one_sign(axis) { low[axis].abs().min(high[axis].abs()) } else { 0.0 };
    let may_be_largest = |&axis: &usize| (0..3).all(|other| most[axis] >= least(other));
    let reach = |axis: usize| {
        let scale = if has_one_sign(axis) { (rounding / most[axis]).copysign(high[axis]) } else { 0.0 };
        Reach { axis, scale }
    };
    (0..3).filter(may_be_largest).map(reach).collect()
}
