//! A sky from a picture in latitude and longitude.
//!
//! The picture is split once: where it is brighter than a multiple of the mean, the excess is a
//! light of its own (its *suns*), sampled by shadow rays in proportion to its luminance; the
//! bounded remainder lights surfaces by rays that escape the scene. Both together are the picture,
//! so that nothing is counted twice.

use super::image::SkyImage;
use crate::raster::color::luminance;
use glam::Vec3;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// A direction of a sky, chosen by its light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkySample {
    /// Unit direction towards the sky.
    pub direction: Vec3,
    /// Radiance from there.
    pub radiance: Vec3,
    /// Probability density with which the direction is chosen, per steradian.
    pub pdf: f32,
}

/// A picture as a sky: turned and scaled.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSky {
    /// The picture.
    pub image: Arc<SkyImage>,
    /// Angle in degrees by which the picture is turned clockwise, seen from above.
    pub rotation_deg: f32,
    /// Radiance of a value of one.
    pub brightness: f32,
}

impl PictureSky {
    /// Returns a picture as it is, in a scene with a luminance of `nits_per_unit` for a radiance of
    /// one. Where the file does not give luminances, its values are radiances.
    pub fn new(image: Arc<SkyImage>, nits_per_unit: f32) -> Self {
        let brightness = image.nits().map_or(1.0, |nits| nits / nits_per_unit);
        Self { image, rotation_deg: 0.0, brightness }
    }

    /// Returns the place of a unit direction in the picture, 0 to 1 both ways.
    fn place(&self, direction: Vec3) -> [f32; 2] {
        let along = direction.x.atan2(-direction.z) / TAU + 0.5 - self.rotation_deg / 360.0;
        [along - along.floor(), direction.y.clamp(-1.0, 1.0).acos() / PI]
    }

    /// Returns the radiance that is seen in a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        self.image.bilinear(self.place(direction)) * self.brightness
    }

    /// Returns the radiance of the remainder in a unit direction, without the suns.
    pub fn diffuse_radiance(&self, direction: Vec3) -> Vec3 {
        let texel = self.image.nearest(self.place(direction));
        texel * (self.image.diffuse_share(texel) * self.brightness)
    }

    /// Returns the direction of the suns for a point `u` of the unit square, chosen by luminance;
    /// none where there are no suns.
    pub fn sample_suns(&self, u: [f32; 2]) -> Option<SkySample> {
        let ([column, row], [along, down]) = self.image.suns.sample(u)?;
        let [width, height] = self.image.size().map(|n| n as f32);
        let azimuth = TAU * ((column as f32 + along) / width - 0.5) + self.rotation_deg.to_radians();
        let edge = |row: f32| (PI * row / height).cos();
        let up = edge(row as f32) + (edge(row as f32 + 1.0) - edge(row as f32)) * down;
        let level = (1.0 - up * up).max(0.0).sqrt();
        let direction = Vec3::new(level * azimuth.sin(), up, -level * azimuth.cos());
        let texel = Vec3::from(self.image.texels[(row * self.image.size()[0] + column) as usize]);
        let (radiance, pdf) = self.suns_and_pdf(texel);
        (pdf > 0.0).then_some(SkySample { direction, radiance, pdf })
    }

    /// Returns the density per steradian with which [`Self::sample_suns`] chooses a unit direction.
    pub fn suns_pdf(&self, direction: Vec3) -> f32 {
        self.suns_and_pdf(self.image.nearest(self.place(direction))).1
    }

    /// Returns the largest radiance.
    pub fn max_radiance(&self) -> f32 {
        self.image.max_value() * self.brightness
    }

    fn suns_and_pdf(&self, texel: Vec3) -> (Vec3, f32) {
        let excess = texel * (1.0 - self.image.diffuse_share(texel));
        (excess * self.brightness, luminance(excess) / self.image.suns.total.max(f32::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests {
    use super::super::image::MAX_DIFFUSE_RATIO;
    use super::*;
    use crate::math::sampling::{BELOW_ONE, cosine_hemisphere, frame_around, lattice};
    use glam::DVec3;
    use std::path::Path;

    const SIZE: [u32; 2] = [64, 32];

    fn image(of: impl Fn(u32, u32) -> Vec3) -> Arc<SkyImage> {
        let texels = (0..SIZE[0] * SIZE[1]).map(|i| of(i % SIZE[0], i / SIZE[0]).to_array()).collect();
        Arc::new(SkyImage::new(Path::new("test.hdr"), SIZE, texels, None).unwrap())
    }

    fn sky(of: impl Fn(u32, u32) -> Vec3) -> PictureSky {
        PictureSky { image: image(of), rotation_deg: 37.0, brightness: 0.5 }
    }

    /// A blue sky with a sun of a few texels, a lamp near the horizon, and dark ground.
    fn blue(x: u32, y: u32) -> Vec3 {
        match (x, y) {
            (20..22, 6..8) => Vec3::new(9e4, 8e4, 6e4),
            (50, 14) => Vec3::new(3e3, 1e2, 1e2),
            (_, 0..16) => Vec3::new(0.3, 0.5, 1.0) * (1.0 + 0.1 * x as f32),
            _ => Vec3::splat(0.2),
        }
    }

    /// Irradiance of level ground by the values of the texels, exactly.
    fn exact_irradiance(sky: &PictureSky, value: impl Fn(Vec3) -> Vec3) -> DVec3 {
        let edge = |row: u32| (std::f64::consts::PI * f64::from(row) / f64::from(SIZE[1])).cos();
        let mut sum = DVec3::ZERO;
        for row in 0..SIZE[1] / 2 {
            let cosine = (edge(row).powi(2) - edge(row + 1).powi(2)) / 2.0;
            let texels = &sky.image.texels[(row * SIZE[0]) as usize..][..SIZE[0] as usize];
            let row_sum: DVec3 = texels.iter().map(|t| value(Vec3::from(*t)).as_dvec3()).sum();
            sum += row_sum * (cosine * std::f64::consts::TAU / f64::from(SIZE[0]));
        }
        sum * f64::from(sky.brightness)
    }

    /// Mean of values, and their variance relative to the squared mean.
    fn mean(values: impl Iterator<Item = Vec3>) -> (DVec3, f64) {
        let (mut sum, mut squares, mut count) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for value in values.map(|v| v.as_dvec3()) {
            (sum, squares, count) = (sum + value, squares + value * value, count + 1.0);
        }
        let (mean, square) = (sum / count, squares / count);
        (mean, (square / (mean * mean).max(DVec3::splat(1e-300)) - 1.0).max_element())
    }

    /// Irradiance of a plane by samples of the suns.
    fn by_suns(sky: &PictureSky, normal: Vec3, samples: u32) -> (DVec3, f64) {
        mean((0..samples).map(|i| {
            let s = sky.sample_suns(lattice(i, samples, [0.5, 0.3])).unwrap();
            s.radiance * (s.direction.dot(normal).max(0.0) / s.pdf)
        }))
    }

    /// Irradiance of a plane by rays of the cosine that escape.
    fn by_remainder(sky: &PictureSky, normal: Vec3, samples: u32) -> (DVec3, f64) {
        mean((0..samples).map(|i| {
            let d = frame_around(normal) * cosine_hemisphere(lattice(i, samples, [0.5, 0.3]));
            sky.diffuse_radiance(d) * PI
        }))
    }

    #[test]
    fn suns_and_remainder_are_the_light_of_the_picture() {
        let (sky, n) = (sky(blue), 1 << 18);
        assert!(sky.image.sun_texels() >= 5);
        let expected = exact_irradiance(&sky, |texel| texel);
        let remainder = by_remainder(&sky, Vec3::Y, n).0;
        let found = by_suns(&sky, Vec3::Y, n).0 + remainder;
        assert!((found / expected - 1.0).abs().max_element() < 1e-3, "{found} {expected}");
        let expected = exact_irradiance(&sky, |texel| texel * sky.image.diffuse_share(texel));
        assert!((remainder / expected - 1.0).abs().max_element() < 1e-3, "{remainder} {expected}");
    }

    #[test]
    fn sampling_the_suns_equals_a_sum_over_all_directions() {
        let (sky, normal) = (sky(blue), Vec3::new(0.6, 0.64, -0.48));
        // Eight by eight directions in each texel, even in solid angle.
        let (mut sum, mut mass, [columns, rows]) = (DVec3::ZERO, 0.0, SIZE.map(|n| 8 * n));
        for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            let edge = |row: u32| (PI * row as f32 / SIZE[1] as f32).cos();
            let [top, bottom] = [edge(i / 8), edge(i / 8 + 1)];
            let up = top + (bottom - top) * ((i % 8) as f32 + 0.5) / 8.0;
            let azimuth = TAU * ((j as f32 + 0.5) / columns as f32 - 0.5) + 37f32.to_radians();
            let (sin, cos) = azimuth.sin_cos();
            let d = Vec3::new(sin, 0.0, -cos) * (1.0 - up * up).sqrt() + Vec3::Y * up;
            let solid_angle = f64::from((top - bottom) / 8.0 * TAU / columns as f32);
            let texel = sky.image.nearest(sky.place(d));
            let suns = texel * ((1.0 - sky.image.diffuse_share(texel)) * sky.brightness);
            sum += suns.as_dvec3() * (f64::from(d.dot(normal).max(0.0)) * solid_angle);
            mass += f64::from(sky.suns_pdf(d)) * solid_angle;
        }
        assert!((mass - 1.0).abs() < 1e-3, "the density integrates to one: {mass}");
        let sampled = by_suns(&sky, normal, 1 << 16).0;
        assert!((sampled / sum - 1.0).abs().max_element() < 2e-3, "{sampled} {sum}");
        for i in 0..64 {
            let s = sky.sample_suns(lattice(i, 64, [0.2, 0.7])).unwrap();
            assert!((s.pdf / sky.suns_pdf(s.direction) - 1.0).abs() < 1e-4);
            assert!((s.direction.length() - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn one_texel_of_a_billion_keeps_the_variance_bounded() {
        for background in [0.0, 1e-3, 1.0] {
            let sky = sky(|x, y| if (x, y) == (40, 5) { Vec3::splat(1e9) } else { Vec3::splat(background) });
            assert_eq!(sky.image.sun_texels(), 1);
            let (light, variance) = by_suns(&sky, Vec3::Y, 1 << 12);
            assert!(variance < 0.01, "all samples find the texel: {variance}");
            let (rest, variance) = by_remainder(&sky, Vec3::Y, 1 << 16);
            assert!(variance < 4.0 * MAX_DIFFUSE_RATIO, "{background}: {variance}");
            let expected = exact_irradiance(&sky, |texel| texel);
            assert!(((light + rest) / expected - 1.0).abs().max_element() < 2e-3, "{background}");
        }
    }

    #[test]
    fn an_even_picture_has_no_suns_and_is_even() {
        let sky = sky(|_, _| Vec3::new(1.0, 2.0, 3.0));
        assert_eq!((sky.image.sun_texels(), sky.sample_suns([0.5, BELOW_ONE])), (0, None));
        for d in [Vec3::Y, -Vec3::Y, Vec3::X, -Vec3::X, Vec3::Z, -Vec3::Z] {
            assert_eq!(sky.diffuse_radiance(d), Vec3::new(0.5, 1.0, 1.5));
            assert!((sky.radiance(d) - Vec3::new(0.5, 1.0, 1.5)).abs().max_element() < 1e-6);
        }
        let black = self::sky(|_, _| Vec3::ZERO);
        assert_eq!((black.radiance(Vec3::X), black.image.sun_texels()), (Vec3::ZERO, 0));
    }

    #[test]
    fn the_centre_is_north_the_right_half_east_and_rotation_is_clockwise() {
        let east = |x: u32, _| if (44..52).contains(&x) { Vec3::ONE } else { Vec3::ZERO };
        let mut sky = PictureSky { image: image(east), rotation_deg: 0.0, brightness: 1.0 };
        let lit = |sky: &PictureSky| {
            [-Vec3::Z, Vec3::X, Vec3::Z, -Vec3::X].map(|d| sky.image.nearest(sky.place(d)).x > 0.0)
        };
        assert_eq!(lit(&sky), [false, true, false, false]);
        sky.rotation_deg = 90.0;
        assert_eq!(lit(&sky), [false, false, true, false], "from east to south");
        sky.rotation_deg = -90.0;
        assert_eq!(lit(&sky), [true, false, false, false]);
        let up =
            PictureSky { image: image(|_, y| Vec3::splat(y as f32)), rotation_deg: 0.0, brightness: 1.0 };
        assert!(up.radiance(Vec3::Y).x < 1.0 && up.radiance(-Vec3::Y).x > 30.0);
    }
}
