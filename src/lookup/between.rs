//! Pixels between traced ones: light is traced for pixels that lie ever closer together, and a
//! pixel takes the mean of those around it where these lie on its surface and agree.
//!
//! The lattice is traced in rounds, each of which halves the area of a cell: pixels four apart,
//! their middles, and so on down to every pixel. Where light varies slowly, one pixel in sixteen is
//! traced; at the edges of shadows and of surfaces, each is. The mean of four has less noise than
//! one pixel that is traced.
//!
//! Source: Akimoto, Mase and Suenaga, "Pixel-Selected Ray Tracing", IEEE CG&A 11 (4), 1991. We
//! differ: light on surfaces is interpolated, not colour, and every pixel has its own first hit.

use super::policy::{DEPTH_ROUNDING, MAX_BEND_BETWEEN, MAX_BETWEEN, MAX_RANGE_BETWEEN, PLANE_TOLERANCE};
use crate::camera::View;
use crate::reference::directory::PackedNormal;
use glam::Vec3;
use std::ops::Range;

/// Rounds in which the pixels of a picture are traced.
const ROUNDS: usize = 5;

/// The round of a pixel, below [`ROUNDS`], by its column and row modulo four.
const ROUND: [[u8; 4]; 4] = [[0, 4, 2, 4], [4, 3, 4, 3], [2, 4, 1, 4], [4, 3, 4, 3]];

/// Steps from a pixel of each round to one of its neighbours in earlier rounds, in both directions
/// of which others lie too.
const STEPS: [[[i32; 2]; 2]; ROUNDS] =
    [[[0, 0], [0, 0]], [[2, 2], [2, -2]], [[2, 0], [0, 2]], [[1, 1], [1, -1]], [[1, 0], [0, 1]]];

/// Rounds whose pixels need all four neighbours; the others, whose neighbours touch them, need two
/// that are opposite.
const WIDE_ROUNDS: usize = 3;

/// The round in which a pixel is traced.
pub(crate) fn round_of(pixel: u32, width: u32) -> usize {
    usize::from(ROUND[(pixel / width % 4) as usize][(pixel % width % 4) as usize])
}

/// The parts of a list of pixels, in the order of their rounds, that belong to each round.
pub(crate) fn rounds_of(pixels: &[u32], width: u32) -> [Range<usize>; ROUNDS] {
    let end = |round: usize| pixels.partition_point(|&pixel| round_of(pixel, width) <= round);
    std::array::from_fn(|round| if round == 0 { 0..end(0) } else { end(round - 1)..end(round) })
}

/// The surfaces that a picture shows, row-major.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PictureSurfaces<'a> {
    pub(crate) view: &'a View,
    /// 1 / depth of each pixel.
    pub(crate) disparity: &'a [f32],
    /// Triangle of each pixel.
    pub(crate) triangle: &'a [u32],
    /// Normal of each triangle.
    pub(crate) normals: &'a [PackedNormal],
}

/// The light that is known at the pixels of a picture, in one unit: irradiance or radiance.
#[derive(Clone, Debug, Default)]
pub(crate) struct LightBetween {
    light: Vec<Vec3>,
    is_known: Vec<bool>,
    size: [u32; 2],
}

impl LightBetween {
    /// Memory per pixel.
    pub(crate) const BYTES_PER_PIXEL: usize = size_of::<Vec3>() + size_of::<bool>();

    /// No light, for a picture of this size.
    pub(crate) fn new(size: [u32; 2]) -> Self {
        let mut between = Self::default();
        between.begin(size);
        between
    }

    /// Forgets all light, for a picture of this size.
    pub(crate) fn begin(&mut self, size: [u32; 2]) {
        let count = size[0] as usize * size[1] as usize;
        self.light.resize(count, Vec3::ZERO);
        self.is_known.clear();
        self.is_known.resize(count, false);
        self.size = size;
    }

    /// Notes the light of a pixel.
    pub(crate) fn set(&mut self, pixel: u32, light: Vec3) {
        (self.light[pixel as usize], self.is_known[pixel as usize]) = (light, true);
    }

    /// The mean of the light around a pixel in the rounds before its own, where it lies on the
    /// pixel's surface and differs by little. `noise` is that of the light relative to sixteen
    /// shadow rays.
    pub(crate) fn mean(&self, pixel: u32, surfaces: &PictureSurfaces<'_>, noise: f32) -> Option<Vec3> {
        let round = round_of(pixel, self.size[0]);
        if round == 0 {
            return None;
        }
        let [first, second] = STEPS[round].map(|step| self.pair(pixel, step, surfaces));
        match (first, second) {
            (Some(first), Some(second)) => mean_of_four(first, second, noise),
            (Some(pair), None) | (None, Some(pair)) if round >= WIDE_ROUNDS => mean_of_two(pair, noise),
            _ => None,
        }
    }

    /// The light of two opposite neighbours of a pixel, if both are known and lie on the plane of
    /// the pixel: over a plane, disparity is linear.
    fn pair(&self, pixel: u32, step: [i32; 2], surfaces: &PictureSurfaces<'_>) -> Option<[Vec3; 2]> {
        let [width, height] = self.size.map(|s| s as i32);
        let (x, y) = (pixel as i32 % width, pixel as i32 / width);
        let [dx, dy] = step;
        let is_inside = |x: i32, y: i32| x >= 0 && y >= 0 && x < width && y < height;
        if !is_inside(x - dx, y - dy) || !is_inside(x + dx, y + dy) {
            return None;
        }
        let (at, apart) = (pixel as usize, dy * width + dx);
        let [a, b] = [pixel as i32 - apart, pixel as i32 + apart].map(|pixel| pixel as usize);
        if !(self.is_known[a] && self.is_known[b] && surfaces.are_alike(at, a) && surfaces.are_alike(at, b)) {
            return None;
        }
        let d = surfaces.disparity;
        let bend = PLANE_TOLERANCE * surfaces.view.scene_from_pixel.x_axis.length() * dx.max(dy) as f32;
        let is_plane = (d[a] + d[b] - 2.0 * d[at]).abs() <= 2.0 * (bend + DEPTH_ROUNDING) * d[at];
        is_plane.then(|| [self.light[a], self.light[b]])
    }
}

/// The mean of two values that differ by little.
fn mean_of_two([a, b]: [Vec3; 2], noise: f32) -> Option<Vec3> {
    let range = (a - b).abs().max_element();
    (range <= MAX_BETWEEN * noise * a.max(b).max_element()).then(|| (a + b) / 2.0)
}

/// The mean of two opposite pairs of values that differ by little, or vary evenly.
fn mean_of_four([a, b]: [Vec3; 2], [c, d]: [Vec3; 2], noise: f32) -> Option<Vec3> {
    let most = a.max(b).max(c.max(d));
    let range = (most - a.min(b).min(c.min(d))).max_element();
    let bend = ((a + b) - (c + d)).abs().max_element() / 2.0;
    let brightest = noise * most.max_element();
    let agree = range <= MAX_RANGE_BETWEEN * brightest && bend <= MAX_BEND_BETWEEN * brightest;
    agree.then(|| ((a + b) + (c + d)) / 4.0)
}

impl PictureSurfaces<'_> {
    /// True where two pixels show one triangle, or two with nearly the same normal.
    fn are_alike(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|pixel| self.triangle[pixel] as usize);
        a == b
            || match (self.normals.get(a), self.normals.get(b)) {
                (Some(a), Some(b)) => a.is_like(*b),
                _ => false,
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    const SIZE: [u32; 2] = [33, 21];

    fn pixels_in_order() -> Vec<u32> {
        let mut pixels: Vec<u32> = (0..SIZE[0] * SIZE[1]).collect();
        pixels.sort_by_key(|&pixel| round_of(pixel, SIZE[0]));
        pixels
    }

    /// Lights a wall that faces the viewer, tracing only where the pixels around disagree. Returns
    /// the light found, and how many pixels were traced.
    fn light_wall(light_at: impl Fn(u32, u32) -> f32) -> (Vec<f32>, usize) {
        let scene = builtin::build("cornell").unwrap();
        let view = View::new(scene.start(), &scene.frame, SIZE);
        let count = view.pixel_count();
        let (disparity, triangle) = (vec![0.125; count], vec![7; count]);
        let surfaces =
            PictureSurfaces { view: &view, disparity: &disparity, triangle: &triangle, normals: &[] };
        let (mut between, mut traced) = (LightBetween::default(), 0);
        between.begin(SIZE);
        for pixel in pixels_in_order() {
            let light = between.mean(pixel, &surfaces, 1.0).unwrap_or_else(|| {
                traced += 1;
                Vec3::splat(light_at(pixel % SIZE[0], pixel / SIZE[0]))
            });
            between.set(pixel, light);
        }
        (between.light.iter().map(|light| light.x).collect(), traced)
    }

    #[test]
    fn the_neighbours_of_a_pixel_are_traced_in_earlier_rounds() {
        let width = 16;
        for pixel in (4..12).flat_map(|y| (4..12).map(move |x| y * width + x)) {
            let round = round_of(pixel, width);
            for [dx, dy] in STEPS[round].into_iter().filter(|_| round > 0) {
                let apart = dy * width as i32 + dx;
                let [a, b] =
                    [pixel as i32 - apart, pixel as i32 + apart].map(|at| round_of(at as u32, width));
                assert!(a < round && b < round, "pixel {pixel}, step {dx}, {dy}");
            }
        }
        let pixels = pixels_in_order();
        let rounds = rounds_of(&pixels, SIZE[0]);
        assert!(rounds.iter().map(Range::len).sum::<usize>() == pixels.len() && rounds[0].len() == 9 * 6);
    }

    #[test]
    fn light_that_varies_little_is_traced_once_in_sixteen_pixels_and_exact_where_it_is_linear() {
        let slope = |x: u32, y: u32| 10.0 + 0.05 * x as f32 - 0.04 * y as f32;
        let (light, traced) = light_wall(slope);
        // Pixels at the border have neighbours on one side only.
        assert!(traced * 8 < light.len(), "{traced} of {}", light.len());
        for (pixel, light) in (0..).zip(light) {
            assert!((light - slope(pixel % SIZE[0], pixel / SIZE[0])).abs() < 1e-4, "pixel {pixel}");
        }
    }

    #[test]
    fn the_edge_of_a_shadow_stays_where_it_is() {
        for edge in 8..16 {
            let shadow = |x: u32, y: u32| if 2 * x + y < 2 * edge { 1.0 } else { 0.2 };
            let (light, traced) = light_wall(shadow);
            assert!(traced < light.len() * 2 / 3, "{traced} of {}", light.len());
            for (pixel, light) in (0..).zip(light) {
                assert!(light == shadow(pixel % SIZE[0], pixel / SIZE[0]), "pixel {pixel}");
            }
        }
    }
}
