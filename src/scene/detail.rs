//! Textures that vary a surface from place to place, in addition to its colour: relief, metal,
//! roughness and transmission.

use super::{Texture, TextureRef};
use glam::{Vec2, Vec3};

/// Texture of directions that tilt the shading normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// Red and green are the components along u and v of the picture, blue is the one along the
    /// normal; each from -1 to 1.
    pub texture: TextureRef,
    /// Factor of red and green, -64 to 64.
    pub strength: f32,
}

impl NormalMap {
    /// Returns the direction at a texture coordinate, of any length; +Z for a flat map, bit for
    /// bit.
    pub fn direction(&self, textures: &[Texture], uv: Vec2) -> Vec3 {
        self.texture.direction(textures, uv) * Vec3::new(self.strength, self.strength, 1.0)
    }
}

/// How a surface varies from place to place. What does not fit the kind of the material has no
/// effect and is removed when a scene is built.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Detail {
    /// Directions that tilt the shading normal.
    pub normal: Option<NormalMap>,
    /// Share (0..1) of a glossy surface that is metal: it reflects by its base colour, and the
    /// rest is the base below the coat.
    pub metalness: f32,
    /// Texture whose blue channel is multiplied with `metalness`.
    pub metalness_texture: Option<TextureRef>,
    /// Texture whose green channel is multiplied with the roughness of the material.
    pub roughness_texture: Option<TextureRef>,
    /// Share (0..1) of glass that transmits; counts only with a texture, and in its base colour.
    pub transmission: f32,
    /// Texture whose red channel is multiplied with `transmission`. What does not transmit is
    /// diffuse.
    pub transmission_texture: Option<TextureRef>,
}

impl Detail {
    /// Returns all uses of textures.
    pub fn textures(&self) -> [Option<TextureRef>; 4] {
        let normal = self.normal.map(|map| map.texture);
        [normal, self.metalness_texture, self.roughness_texture, self.transmission_texture]
    }

    /// Gives mutable access to all uses of textures.
    pub fn textures_mut(&mut self) -> [Option<&mut TextureRef>; 4] {
        let normal = self.normal.as_mut().map(|map| &mut map.texture);
        let [metalness, roughness, transmission] =
            [&mut self.metalness_texture, &mut self.roughness_texture, &mut self.transmission_texture];
        [normal, metalness.as_mut(), roughness.as_mut(), transmission.as_mut()]
    }

    /// Returns the numbers that are not parts of a texture's use.
    pub(crate) fn numbers(&self) -> [f32; 3] {
        [self.normal.map_or(0.0, |map| map.strength), self.metalness, self.transmission]
    }

    /// True where the diffuse part and the specular part share the surface by a texture or by
    /// metalness.
    #[inline(always)]
    pub(crate) fn mixes(&self) -> bool {
        self.metalness > 0.0 || self.transmission_texture.is_some()
    }

    /// True where the specular part differs from place to place.
    #[inline(always)]
    pub(crate) fn varies(&self) -> bool {
        self.mixes() || self.roughness_texture.is_some()
    }

    /// Share (0..1) of a place that is metal.
    pub(super) fn metalness_at(&self, textures: &[Texture], uv: Vec2) -> f32 {
        self.metalness * self.metalness_texture.map_or(1.0, |map| map.value(textures, uv).z)
    }

    /// Share (0..1) of a place that transmits.
    pub(super) fn transmission_at(&self, textures: &[Texture], uv: Vec2) -> f32 {
        self.transmission_texture.map_or(0.0, |map| self.transmission * map.value(textures, uv).x)
    }

    /// Share (0..1) of a place that is the diffuse base.
    pub(crate) fn base_at(&self, textures: &[Texture], uv: Vec2) -> f32 {
        (1.0 - self.metalness_at(textures, uv)) * (1.0 - self.transmission_at(textures, uv))
    }
}
