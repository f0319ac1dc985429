//! Textures with 8 bits per channel, decoded when they are sampled, with bilinear filtering and
//! repetition.

use crate::math::rounding::floor;
use crate::raster::color::linear_from_srgb;
use glam::{Vec2, Vec3};
use std::sync::LazyLock;

/// Index into [`Scene::textures`](super::Scene::textures).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextureId(pub u32);

/// A use of a texture by a material. The texture is sampled at `uv * scale + offset` and repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index of the texture.
    pub texture: TextureId,
    /// Factor of the texture coordinates.
    pub scale: Vec2,
    /// Offset added to the scaled texture coordinates.
    pub offset: Vec2,
}

impl TextureRef {
    /// Returns a use without scale and offset.
    pub fn plain(texture: TextureId) -> Self {
        Self { texture, scale: Vec2::ONE, offset: Vec2::ZERO }
    }

    /// Returns the linear colour at a texture coordinate of the surface.
    #[inline(always)]
    pub fn color(&self, textures: &[Texture], uv: Vec2) -> Vec3 {
        textures[self.texture.0 as usize].color(uv * self.scale + self.offset)
    }

    /// Returns the coverage at a texture coordinate of the surface, 0 to 1.
    pub fn alpha(&self, textures: &[Texture], uv: Vec2) -> f32 {
        textures[self.texture.0 as usize].alpha(uv * self.scale + self.offset)
    }
}

/// How the stored numbers of a texture are decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Colours with the transfer function of sRGB.
    Srgb,
    /// Linear numbers.
    Linear,
}

/// An image on a surface. The first row is the top one, where v is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Number of texels per row, at least 1.
    pub width: u32,
    /// Number of rows, at least 1.
    pub height: u32,
    /// `width * height` texels of red, green, blue and alpha, row by row. Alpha is coverage.
    pub texels: Vec<[u8; 4]>,
    /// Encoding of red, green and blue. Alpha is always linear.
    pub encoding: Encoding,
}

static LINEAR_FROM_SRGB8: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| linear_from_srgb(i as f32 / 255.0)));

impl Texture {
    /// Returns the linear colour at a texture coordinate.
    pub fn color(&self, uv: Vec2) -> Vec3 {
        match self.encoding {
            Encoding::Srgb => {
                let table = &*LINEAR_FROM_SRGB8;
                self.bilinear(uv, |[r, g, b, _]| Vec3::from([r, g, b].map(|c| table[c as usize])))
            }
            Encoding::Linear => {
                self.bilinear(uv, |[r, g, b, _]| Vec3::from([r, g, b].map(f32::from)) / 255.0)
            }
        }
    }

    /// Returns the coverage at a texture coordinate, 0 to 1.
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

/// Returns the fractional part of a coordinate, or 0 if it is not finite, so that no index is out
/// of range.
fn wrap(t: f32) -> f32 {
    /// From 2^23 on, every f32 is an integer.
    const INTEGERS_FROM: f32 = 8_388_608.0;
    if t.abs() < INTEGERS_FROM { t - floor(t) as f32 } else { 0.0 }
}

/// Returns the two texels nearest to a coordinate, and the weight of the second one.
fn neighbours(t: f32, count: u32) -> (u32, u32, f32) {
    let at = wrap(t) * count as f32 - 0.5;
    let low = floor(at);
    let first = u32::try_from(low).map_or(count - 1, |low| low.min(count - 1));
    let second = if first + 1 == count { 0 } else { first + 1 };
    (first, second, at - low as f32)
}
