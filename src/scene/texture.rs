//! Textures: 8 bits a channel, decoded on sampling, bilinear, repeated.

use crate::math::whole::floor;
use crate::raster::color::linear_from_srgb;
use glam::{Vec2, Vec3};
use std::sync::LazyLock;

/// How the stored numbers are to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Colour.
    Srgb,
    /// Anything that is not colour.
    Linear,
}

/// A picture on a surface. The top row is stored first; v = 1 is the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Texels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// RGBA, row-major, `width * height` of them. Alpha is coverage.
    pub texels: Vec<[u8; 4]>,
    /// Of the first three channels; alpha is always linear.
    pub encoding: Encoding,
}

static LINEAR_FROM_SRGB8: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| linear_from_srgb(i as f32 / 255.0)));

impl Texture {
    /// The linear colour at a texture coordinate.
    pub fn color(&self, uv: Vec2) -> Vec3 {
        match self.encoding {
            Encoding::Srgb => {
                let table = &*LINEAR_FROM_SRGB8;
                self.bilinear(uv, |t| {
                    Vec3::new(table[t[0] as usize], table[t[1] as usize], table[t[2] as usize])
                })
            }
            Encoding::Linear => {
                self.bilinear(uv, |t| Vec3::new(t[0].into(), t[1].into(), t[2].into()) / 255.0)
            }
        }
    }

    /// The coverage at a texture coordinate, 0..1.
    pub fn alpha(&self, uv: Vec2) -> f32 {
        self.bilinear(uv, |t| Vec3::splat(f32::from(t[3]) / 255.0)).x
    }

    fn bilinear(&self, uv: Vec2, decode: impl Fn([u8; 4]) -> Vec3) -> Vec3 {
        let (x0, x1, fx) = neighbours(uv.x, self.width);
        let (y0, y1, fy) = neighbours(1.0 - wrap(uv.y), self.height);
        let texel = |x: u32, y: u32| decode(self.texels[(y * self.width + x) as usize]);
        let top = texel(x0, y0).lerp(texel(x1, y0), fx);
        let bottom = texel(x0, y1).lerp(texel(x1, y1), fx);
        top.lerp(bottom, fy)
    }
}

/// The fraction of a coordinate, 0 for one that is not finite: a broken file must not reach an index.
fn wrap(t: f32) -> f32 {
    // Beyond 2^23 a number has no fraction.
    const WHOLE_FROM: f32 = 8_388_608.0;
    if t.abs() < WHOLE_FROM { t - floor(t) as f32 } else { 0.0 }
}

/// The two texels beside a coordinate and the weight of the second.
fn neighbours(t: f32, count: u32) -> (u32, u32, f32) {
    let at = wrap(t) * count as f32 - 0.5;
    let low = floor(at);
    let first = u32::try_from(low).map_or(count - 1, |low| low.min(count - 1));
    let second = if first + 1 == count { 0 } else { first + 1 };
    (first, second, at - low as f32)
}
