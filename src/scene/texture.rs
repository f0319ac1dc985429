//! Textures with 8 bits per channel, decoded when they are sampled, with bilinear filtering and
//! repetition.

use crate::math::rounding::floor;
use crate::raster::color::linear_from_srgb;
use glam::{Vec2, Vec3};
use std::sync::LazyLock;

/// Index into [`Scene::textures`](super::Scene::textures).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextureId(pub u32);

/// What a texture shows beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// It repeats.
    #[default]
    Repeat,
    /// The texels at its edge are repeated.
    Clamp,
    /// It repeats, mirrored every other time.
    Mirror,
}

/// How a use of a texture reads it. The default repeats and filters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sampling {
    /// What lies beyond the edges, along u and v.
    pub wrap: [Wrap; 2],
    /// True where texels are seen as squares, without a filter between them.
    pub is_nearest: bool,
    /// Angle in radians by which texture coordinates are turned after they are scaled.
    pub turn: f32,
}

impl Sampling {
    /// Returns edges and filter as a number, for hashes and files.
    pub(crate) fn code(self) -> u8 {
        let [u, v] = self.wrap.map(|wrap| wrap as u8);
        u | v << 2 | u8::from(self.is_nearest) << 4
    }

    /// Returns the sampling of a code and an angle; `None` for an impossible code.
    pub(crate) fn of_code(code: u8, turn: f32) -> Option<Self> {
        let wrap = |bits| [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror].get(usize::from(bits & 3)).copied();
        (code < 32 && turn.is_finite()).then_some(())?;
        Some(Self { wrap: [wrap(code)?, wrap(code >> 2)?], is_nearest: code & 16 != 0, turn })
    }
}

/// A use of a texture by a material. The texture is sampled at `uv * scale + offset`, turned where
/// `sampling` says so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index of the texture.
    pub texture: TextureId,
    /// Factor of the texture coordinates.
    pub scale: Vec2,
    /// Offset added to the scaled texture coordinates.
    pub offset: Vec2,
    /// Edges, filter and rotation.
    pub sampling: Sampling,
}

impl TextureRef {
    /// Returns a use that repeats and filters.
    pub fn new(texture: TextureId, scale: Vec2, offset: Vec2) -> Self {
        Self { texture, scale, offset, sampling: Sampling::default() }
    }

    /// Returns a use without scale and offset.
    pub fn plain(texture: TextureId) -> Self {
        Self::new(texture, Vec2::ONE, Vec2::ZERO)
    }

    /// Returns the linear colour at a texture coordinate of the surface.
    #[inline(always)]
    pub fn color(&self, textures: &[Texture], uv: Vec2) -> Vec3 {
        let texture = &textures[self.texture.0 as usize];
        if self.sampling == Sampling::default() {
            return texture.color(uv * self.scale + self.offset);
        }
        texture.color_sampled(self.place(uv), self.sampling)
    }

    /// Returns the coverage at a texture coordinate of the surface, 0 to 1.
    pub fn alpha(&self, textures: &[Texture], uv: Vec2) -> f32 {
        textures[self.texture.0 as usize].alpha_sampled(self.place(uv), self.sampling)
    }

    /// Returns the stored numbers at a texture coordinate of the surface as they are, 0 to 1,
    /// whatever the texture's encoding.
    pub fn value(&self, textures: &[Texture], uv: Vec2) -> Vec3 {
        let texture = &textures[self.texture.0 as usize];
        let decode = |[r, g, b, _]: [u8; 4]| Vec3::from([r, g, b].map(f32::from)) / 255.0;
        texture.filtered(self.place(uv), self.sampling, decode)
    }

    /// Returns the direction that a texel of a normal map stores at a texture coordinate of the
    /// surface; its length is not 1. Both middle values of a channel stand for zero.
    pub(crate) fn direction(&self, textures: &[Texture], uv: Vec2) -> Vec3 {
        let part = |byte: u8| {
            let off = f32::from(byte) - 127.5;
            (off.abs() - 0.5) / 127.0 * off.signum()
        };
        let decode = |[r, g, b, _]: [u8; 4]| Vec3::from([r, g, b].map(part));
        textures[self.texture.0 as usize].filtered(self.place(uv), self.sampling, decode)
    }

    /// Returns the difference in the texture that belongs to one of texture coordinates.
    pub(crate) fn along(&self, uv: Vec2) -> Vec2 {
        self.turned(uv * self.scale)
    }

    /// Returns the place in the texture.
    fn place(&self, uv: Vec2) -> Vec2 {
        self.turned(uv * self.scale) + self.offset
    }

    fn turned(&self, scaled: Vec2) -> Vec2 {
        if self.sampling.turn == 0.0 { scaled } else { Vec2::from_angle(self.sampling.turn).rotate(scaled) }
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
    /// Returns the linear colour at a texture coordinate, repeated and filtered.
    pub fn color(&self, uv: Vec2) -> Vec3 {
        self.color_sampled(uv, Sampling::default())
    }

    /// Returns the linear colour at a texture coordinate.
    #[inline]
    fn color_sampled(&self, uv: Vec2, sampling: Sampling) -> Vec3 {
        match self.encoding {
            Encoding::Srgb => {
                let table = &*LINEAR_FROM_SRGB8;
                self.filtered(uv, sampling, |[r, g, b, _]| Vec3::from([r, g, b].map(|c| table[c as usize])))
            }
            Encoding::Linear => {
                self.filtered(uv, sampling, |[r, g, b, _]| Vec3::from([r, g, b].map(f32::from)) / 255.0)
            }
        }
    }

    /// Returns the coverage at a texture coordinate, 0 to 1.
    pub fn alpha(&self, uv: Vec2) -> f32 {
        self.alpha_sampled(uv, Sampling::default())
    }

    #[inline]
    fn alpha_sampled(&self, uv: Vec2, sampling: Sampling) -> f32 {
        self.filtered(uv, sampling, |t| Vec3::splat(f32::from(t[3]) / 255.0)).x
    }

    #[inline]
    fn filtered(&self, uv: Vec2, sampling: Sampling, decode: impl Fn([u8; 4]) -> Vec3) -> Vec3 {
        let ([x0, x1], mut fx) = match sampling.wrap[0] {
            Wrap::Repeat => neighbours(uv.x, self.width),
            wrap => edge_neighbours(uv.x, self.width, wrap),
        };
        let ([y0, y1], mut fy) = match sampling.wrap[1] {
            Wrap::Repeat => neighbours(1.0 - wrap(uv.y), self.height),
            wrap => edge_neighbours(1.0 - uv.y, self.height, wrap),
        };
        if sampling.is_nearest {
            (fx, fy) = (fx.round(), fy.round());
        }
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
fn neighbours(t: f32, count: u32) -> ([u32; 2], f32) {
    let at = wrap(t) * count as f32 - 0.5;
    let low = floor(at);
    let first = u32::try_from(low).map_or(count - 1, |low| low.min(count - 1));
    let second = if first + 1 == count { 0 } else { first + 1 };
    ([first, second], at - low as f32)
}

/// [`neighbours`] in a texture that does not simply repeat.
fn edge_neighbours(t: f32, count: u32, wrap: Wrap) -> ([u32; 2], f32) {
    let folded = match wrap {
        // Every other repetition runs backwards.
        Wrap::Mirror => {
            let within = self::wrap(t / 2.0) * 2.0;
            if within > 1.0 { 2.0 - within } else { within }
        }
        _ if t.is_nan() => 0.0,
        _ => t.clamp(0.0, 1.0),
    };
    let at = (folded * count as f32 - 0.5).clamp(0.0, (count - 1) as f32);
    let first = at as u32;
    ([first, (first + 1).min(count - 1)], at - first as f32)
}
