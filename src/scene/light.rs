//! The light sources of a scene.

use super::{AimedProfile, Material, MaterialId, Sun, Texture};
use crate::math::sampling::uniform_triangle;
use glam::{DVec3, Vec2, Vec3};

/// A light source in scene space. Colours are linear Rec. 709.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// A parallelogram that emits.
    Quad {
        /// Position of one corner.
        corner: Vec3,
        /// Edge from the corner to one of its neighbours.
        edge_u: Vec3,
        /// Edge from the corner to its other neighbour.
        edge_v: Vec3,
        /// Emitted radiance.
        radiance: Vec3,
        /// True where it emits only from the side to which `edge_u` cross `edge_v` points.
        has_one_side: bool,
    },
    /// A connected mesh that emits.
    Triangles {
        /// Corners of each triangle.
        corners: Vec<[Vec3; 3]>,
        /// For each triangle, the share of the area in it and all triangles before it; the last is
        /// 1.
        cumulative_area: Vec<f32>,
        /// Total area in square scene units.
        area: f32,
        /// Emitted radiance, the mean where it has a picture.
        radiance: Vec3,
        /// The picture that it shows; `None` where it emits evenly.
        picture: Option<Box<LightPicture>>,
        /// True where it emits only from the side from which the corners run counter-clockwise.
        has_one_side: bool,
    },
    /// A point light.
    Point {
        /// Position.
        position: Vec3,
        /// Radiant intensity, in radiance times square scene units.
        intensity: Vec3,
        /// The cone of a spot light; `None` shines in all directions.
        beam: Option<Beam>,
        /// How the intensity depends on direction where that was measured.
        profile: Option<Box<AimedProfile>>,
    },
    /// The sun, a disk at infinity.
    Sun {
        /// Unit direction towards the centre of the disk.
        direction: Vec3,
        /// Cosine of the angular radius.
        cos_angular_radius: f32,
        /// Irradiance on a surface that faces the sun.
        irradiance: Vec3,
    },
    /// The sky of the scene, without [`Light::SkySuns`].
    Sky,
    /// The brightest parts of a sky picture, sampled by their light.
    SkySuns,
}

/// The cone of a spot light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Unit direction in which it shines.
    pub direction: Vec3,
    /// Cosine of the angle up to which it shines fully.
    pub cos_inner: f32,
    /// Cosine of the angle from which on it does not shine.
    pub cos_outer: f32,
}

impl Beam {
    /// Returns the cone around a direction (any length) of two half angles in radians.
    pub fn new(direction: Vec3, inner: f32, outer: f32) -> Self {
        let direction = direction.normalize_or(Vec3::NEG_Y);
        Self { direction, cos_inner: inner.cos(), cos_outer: outer.cos() }
    }

    /// Returns the share (0..1) of the intensity towards a direction (any length).
    ///
    /// Source: the fall-off that KHR_lights_punctual recommends.
    pub fn share(&self, towards: Vec3) -> f32 {
        /// Smallest difference of the cosines, which keeps the quotient finite.
        const MIN_WIDTH: f32 = 1e-3;
        let cos = towards.normalize_or_zero().dot(self.direction);
        let share = (cos - self.cos_outer) / (self.cos_inner - self.cos_outer).max(MIN_WIDTH);
        share.clamp(0.0, 1.0).powi(2)
    }
}

/// A spot light of a model: position in world metres, and intensity on its axis in radiance times
/// square metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    /// Position, world metres.
    pub position_m: DVec3,
    /// Intensity on the axis.
    pub intensity: Vec3,
    /// The cone.
    pub beam: Beam,
}

/// The picture of a [`Light::Triangles`], whose triangles are pieces of those of the scene. Its
/// `cumulative_area` is of light instead of area: bright pieces are sampled more often.
#[derive(Clone, Debug, PartialEq)]
pub struct LightPicture {
    /// Material, whose textures are the picture.
    pub(crate) material: MaterialId,
    /// Mean of the picture over the area of the light.
    pub(crate) mean: Vec3,
    /// Corners of the whole triangles, which bound the pieces.
    pub(crate) hull: Vec<[Vec3; 3]>,
    /// Texture coordinates of the corners of each piece.
    pub(crate) uvs: Vec<[Vec2; 3]>,
    /// Area that a sample of each piece stands for, square scene units.
    pub(crate) sampled_area: Vec<f32>,
}

impl Light {
    /// The corners of triangles that bound a light of these: fewer where they are pieces of a
    /// picture.
    pub(crate) fn outline<'a>(
        corners: &'a [[Vec3; 3]],
        picture: &'a Option<Box<LightPicture>>,
    ) -> &'a [[Vec3; 3]] {
        picture.as_ref().map_or(corners, |picture| &picture.hull)
    }
}

impl LightPicture {
    /// Returns the area that a sample of a piece stands for, and its radiance over the mean, at
    /// barycentrics (b1, b2).
    pub(crate) fn sample(
        &self,
        (materials, textures): (&[Material], &[Texture]),
        piece: usize,
        [b1, b2]: [f32; 2],
    ) -> (f32, Vec3) {
        let [a, b, c] = self.uvs[piece];
        let uv = a * (1.0 - b1 - b2) + b * b1 + c * b2;
        let material = &materials[self.material.0 as usize];
        let texel = material.emission_texel(textures, uv);
        let relative = |channel: usize| match self.mean[channel] {
            mean if mean > 0.0 => texel[channel] / mean,
            _ => 0.0,
        };
        (self.sampled_area[piece], Vec3::from_array([0, 1, 2].map(relative)))
    }
}

impl From<Sun> for Light {
    fn from(sun: Sun) -> Self {
        let Sun { direction, angular_radius, irradiance } = sun;
        Self::Sun { direction, cos_angular_radius: angular_radius.cos(), irradiance }
    }
}

/// The fraction of the square root of two, times 2^32. No multiple by a small number is near a
/// whole number, and none is near a multiple of the golden ratio, by which the second coordinate
/// steps.
const ROOT_OF_TWO: u32 = 0x6a09_e667;

/// Maps a point `u` of the unit square to a point of a mesh, uniformly by area. Returns the point,
/// the index of its triangle, and its barycentrics there. `cumulative_area` is that of
/// [`Light::Triangles`].
///
/// The first coordinate selects the triangle, and its place within the triangle's share is the
/// first coordinate there. On a mesh of equal triangles, points in equal steps all have the same
/// place, so it is rotated by a multiple of the square root of two for each triangle (a Weyl
/// sequence): still uniform, and stratified where a triangle holds several points.
pub(crate) fn point_on_mesh(
    corners: &[[Vec3; 3]],
    cumulative_area: &[f32],
    u: [f32; 2],
) -> (Vec3, usize, [f32; 2]) {
    let chosen = cumulative_area.partition_point(|&c| c <= u[0]).min(corners.len() - 1);
    let below = if chosen == 0 { 0.0 } else { cumulative_area[chosen - 1] };
    let within = ((u[0] - below) / (cumulative_area[chosen] - below)).clamp(0.0, 1.0);
    let turn = ((chosen as u32).wrapping_mul(ROOT_OF_TWO) >> 8) as f32 * (1.0 / 16_777_216.0);
    let turned = within + turn;
    let [a, b, c] = corners[chosen];
    let [b1, b2] = uniform_triangle([if turned >= 1.0 { turned - 1.0 } else { turned }, u[1]]);
    (a + (b - a) * b1 + (c - a) * b2, chosen, [b1, b2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{key::Key, sampling::lattice, sequence::Sequence};
    use std::f32::consts::{PI, TAU};

    /// A polygon around the origin, a triangle from there to each side, and its cumulative areas.
    fn polygon(angles: &[f32]) -> (Vec<[Vec3; 3]>, Vec<f32>) {
        let rim = |angle: f32| Vec3::new(angle.cos(), angle.sin(), 0.0);
        let corners: Vec<_> = angles.windows(2).map(|a| [Vec3::ZERO, rim(a[0]), rim(a[1])]).collect();
        let area = |[a, b, c]: &[Vec3; 3]| f64::from((b - a).cross(c - a).length());
        let total: f64 = corners.iter().map(area).sum();
        let mut sum = 0.0;
        let mut share = |triangle: &[Vec3; 3]| {
            sum += area(triangle);
            (sum / total) as f32
        };
        let cumulative = corners.iter().map(&mut share).collect();
        (corners, cumulative)
    }

    fn regular(sides: u32) -> (Vec<[Vec3; 3]>, Vec<f32>) {
        polygon(&(0..=sides).map(|i| i as f32 / sides as f32 * TAU).collect::<Vec<_>>())
    }

    /// Root mean square error, over many shifts, of the means of some functions over the points of
    /// a mesh: both coordinates, the squared distance from the middle, and a disk to one side.
    fn errors(mesh: &(Vec<[Vec3; 3]>, Vec<f32>), count: u32, u: impl Fn(u32, u32) -> [f32; 2]) -> [f64; 4] {
        const SHIFTS: u32 = 1000;
        let functions = |p: Vec3| {
            let is_in_disk = (p - Vec3::X * 0.3).length() < 0.5;
            [p.x, p.y, p.length_squared(), f32::from(u8::from(is_in_disk))].map(f64::from)
        };
        let means: Vec<[f64; 4]> = (0..SHIFTS)
            .map(|shift| {
                let points = (0..count).map(|i| functions(point_on_mesh(&mesh.0, &mesh.1, u(shift, i)).0));
                points.fold([0.0; 4], |s, f| [0, 1, 2, 3].map(|k| s[k] + f[k] / f64::from(count)))
            })
            .collect();
        // The polygons are nearly the unit disk.
        let expected = [0.0, 0.0, 0.5, 0.25];
        [0, 1, 2, 3].map(|k| {
            (means.iter().map(|m| (m[k] - expected[k]).powi(2)).sum::<f64>() / f64::from(SHIFTS)).sqrt()
        })
    }

    #[test]
    fn points_in_equal_steps_and_of_sobols_sequence_are_never_worse_spread_than_random_ones() {
        for (sides, count) in [(64, 16), (64, 64), (64, 4), (48, 16), (32, 16), (1000, 16)] {
            let mesh = regular(sides);
            let key = |shift: u32| Key::of_pixel(9, shift).with(sides);
            let random = errors(&mesh, count, |shift, i| key(shift).with(i).pair());
            let steps = errors(&mesh, count, |shift, i| lattice(i, count, key(shift).pair()));
            let sobol = errors(&mesh, count, |shift, i| Sequence::of_key(key(shift)).pair(i, 3));
            for k in 0..4 {
                // Twice the standard error of both.
                let most = random[k] * 1.07;
                assert!(steps[k] <= most, "{sides} sides, {count}: {steps:.4?}, random {random:.4?}");
                assert!(sobol[k] <= most, "{sides} sides, {count}: {sobol:.4?}, random {random:.4?}");
            }
        }
    }

    /// Pearson's chi-square of points counted in the four quarters of each triangle, by area.
    #[test]
    fn points_are_uniform_by_area() {
        let unequal: Vec<f32> = (0..=20u8).map(|i| (f32::from(i) / 20.0).powi(2) * PI).collect();
        for mesh in [regular(64), polygon(&unequal)] {
            const COUNT: u32 = 1 << 16;
            let mut counts = vec![[0u32; 4]; mesh.0.len()];
            for i in 0..COUNT {
                let (point, chosen, _) = point_on_mesh(&mesh.0, &mesh.1, Key::of_pixel(3, i).pair());
                let [a, b, c] = mesh.0[chosen];
                let whole = (b - a).cross(c - a).z;
                let weights = [(c - b).cross(point - b), (a - c).cross(point - c), (b - a).cross(point - a)];
                let quarter = weights.iter().position(|w| w.z > 0.5 * whole).unwrap_or(3);
                counts[chosen][quarter] += 1;
            }
            let mut chi_square = 0.0;
            for (triangle, counts) in counts.iter().enumerate() {
                let below = if triangle == 0 { 0.0 } else { mesh.1[triangle - 1] };
                let expected = f64::from((mesh.1[triangle] - below) * COUNT as f32 / 4.0);
                chi_square +=
                    counts.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum::<f64>();
            }
            // Mean and four standard deviations of the chi-square distribution.
            let freedom = (4 * mesh.0.len() - 1) as f64;
            assert!(chi_square < freedom + 4.0 * (2.0 * freedom).sqrt(), "{chi_square} for {freedom}");
        }
    }
}
