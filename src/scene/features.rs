//! Which features of the renderer a scene uses, and which ones can be skipped.

use super::{Light, Material};
use serde::Serialize;

/// Largest number of lights in a scene of which each may be sampled at every point.
pub(crate) const MAX_SINGLE_LIGHTS: usize = 64;

/// The features of the renderer that a scene uses. They are determined once, when the scene is
/// complete.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SceneFeatures {
    /// A material is a mirror.
    pub mirror: bool,
    /// A material is glass.
    pub glass: bool,
    /// A material is a rough metal or has a rough coat.
    pub glossy: bool,
    /// A material is frosted glass.
    pub frosted: bool,
    /// A material has a normal map.
    pub normal_maps: bool,
    /// Roughness, metal or transmission of a material varies from place to place.
    pub varied: bool,
    /// A material has a colour texture.
    pub textures: bool,
    /// A material has an alpha texture.
    pub alpha: bool,
    /// A light has an area.
    pub area_lights: bool,
    /// There are more lights than a point samples one by one.
    pub many_lights: bool,
    /// A lamp has a measured profile.
    pub light_profiles: bool,
    /// Rays that leave the scene meet a sky.
    pub sky: bool,
    /// A triangle is a needle ([`Conditioning::needles`](super::Conditioning::needles)), whose hits
    /// must be checked.
    pub needles: bool,
    /// A triangle may lie on one of another material, so that hits on both must be compared.
    pub coincident: bool,
}

impl SceneFeatures {
    /// All features. Measurements compare a scene's own features against them.
    pub const EVERYTHING: Self = Self {
        mirror: true,
        glass: true,
        glossy: true,
        frosted: true,
        normal_maps: true,
        varied: true,
        textures: true,
        alpha: true,
        area_lights: true,
        many_lights: true,
        light_profiles: true,
        sky: true,
        needles: true,
        coincident: true,
    };

    pub(super) fn of(materials: &[Material], lights: &[Light], sky: bool, of_triangles: [bool; 2]) -> Self {
        let [needles, coincident] = of_triangles;
        let any = |test: fn(&Material) -> bool| materials.iter().any(test);
        Self {
            mirror: any(Material::is_mirror),
            glass: any(Material::is_glass),
            glossy: any(Material::is_glossy),
            frosted: any(Material::is_frosted),
            normal_maps: any(|m| m.detail.normal.is_some()),
            varied: any(|m| m.detail.varies()),
            textures: any(|m| {
                let colors = m.diffuse_texture.or(m.emission_texture).or(m.coverage_texture);
                colors.is_some() || m.detail.textures().iter().any(Option::is_some)
            }),
            alpha: any(|m| m.alpha_texture.is_some()),
            area_lights: lights.iter().any(|l| matches!(l, Light::Quad { .. } | Light::Triangles { .. })),
            many_lights: lights.len() > MAX_SINGLE_LIGHTS,
            light_profiles: lights.iter().any(|l| matches!(l, Light::Point { profile: Some(_), .. })),
            sky,
            needles,
            coincident,
        }
    }

    /// True if the hit of a ray on a triangle may have to be rejected.
    pub(crate) fn checks_hits(&self) -> bool {
        self.alpha || self.needles || self.coincident
    }

    /// Returns the names of what the renderer skips because the scene does not need it.
    pub fn left_out(&self) -> Vec<&'static str> {
        [
            (self.mirror || self.glass, "secondary rays"),
            (self.glass, "refraction and solid bodies"),
            (self.glossy || self.frosted, "rough reflection and transmission"),
            (self.normal_maps, "normal maps"),
            (self.varied, "roughness, metal and transmission by picture"),
            (self.textures || self.alpha, "texture coordinates"),
            (self.alpha, "alpha test"),
            (self.area_lights, "area lights"),
            (self.many_lights, "tree of many lamps"),
            (self.light_profiles, "light profiles"),
            (self.sky, "sky"),
            (self.needles, "check of hits on needles"),
            (self.coincident, "order of faces in one place"),
        ]
        .into_iter()
        .filter_map(|(needed, name)| (!needed).then_some(name))
        .collect()
    }
}
