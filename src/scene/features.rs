//! What a scene asks of the renderer, and so what can be left out.

use crate::scene::{Light, Material, Sky};
use serde::Serialize;

/// The features a scene uses. Decided once, when the scene is complete.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SceneFeatures {
    /// Some surface mirrors.
    pub mirror: bool,
    /// Some surface lets light through.
    pub glass: bool,
    /// Some surface has a colour texture.
    pub textures: bool,
    /// Some surface is cut out by a texture.
    pub alpha: bool,
    /// Some light has an area.
    pub area_lights: bool,
    /// Rays may leave the scene into a sky.
    pub sky: bool,
    /// Some triangle is a needle ([`crate::scene::Conditioning::needles`]), whose hits are checked.
    pub needles: bool,
}

impl SceneFeatures {
    /// All that there is: what the choice is measured against.
    pub const EVERYTHING: Self = Self {
        mirror: true,
        glass: true,
        textures: true,
        alpha: true,
        area_lights: true,
        sky: true,
        needles: true,
    };

    pub(crate) fn of(materials: &[Material], lights: &[Light], sky: Option<&Sky>, needles: bool) -> Self {
        let any = |test: fn(&Material) -> bool| materials.iter().any(test);
        Self {
            mirror: any(Material::is_mirror),
            glass: any(Material::is_glass),
            textures: any(|m| m.diffuse_texture.is_some()),
            alpha: any(|m| m.alpha_texture.is_some()),
            area_lights: lights.iter().any(|l| matches!(l, Light::Quad { .. } | Light::Triangles { .. })),
            sky: sky.is_some(),
            needles,
        }
    }

    /// True where not every hit of a triangle stands.
    pub(crate) fn checks_hits(&self) -> bool {
        self.alpha || self.needles
    }

    /// In words, what the renderer does not do because the scene does not need it.
    pub fn left_out(&self) -> Vec<&'static str> {
        [
            (self.mirror || self.glass, "secondary rays"),
            (self.glass, "refraction and solid bodies"),
            (self.textures || self.alpha, "texture coordinates"),
            (self.alpha, "alpha test"),
            (self.area_lights, "area lights"),
            (self.sky, "sky"),
            (self.needles, "check of hits on needles"),
        ]
        .into_iter()
        .filter_map(|(needed, what)| (!needed).then_some(what))
        .collect()
    }
}
