//! A material as it is at one place, where its detail varies it.

use super::{Detail, Material, MaterialKind, Texture};
use glam::{Vec2, Vec3};
use std::borrow::Cow;

/// Largest factor of the tilt of a normal map, of either sign.
const MAX_STRENGTH: f32 = 64.0;

impl Material {
    /// False where the diffuse part is black everywhere.
    pub fn has_base(&self) -> bool {
        let is_all_metal = self.detail.metalness >= 1.0 && self.detail.metalness_texture.is_none();
        self.diffuse != Vec3::ZERO && !(is_all_metal && self.is_glossy())
    }

    /// Returns what pictures vary, apart from colour, alpha and emission.
    pub fn varies_by_picture(&self) -> Vec<&'static str> {
        let Detail { normal, metalness_texture, roughness_texture, transmission_texture, .. } = self.detail;
        let is_metal = self.is_glossy() && self.detail.metalness > 0.0 && self.diffuse_texture.is_some();
        [
            (normal.is_some(), "relief"),
            (metalness_texture.is_some(), "metal"),
            (roughness_texture.is_some(), "roughness"),
            (transmission_texture.is_some(), "transmission"),
            (is_metal, "the colour of metal"),
        ]
        .into_iter()
        .filter_map(|(varies, name)| varies.then_some(name))
        .collect()
    }

    /// Returns the material as it is at one place; `uv` returns the texture coordinate and is
    /// called where the specular part varies.
    #[inline(always)]
    pub fn at(&self, textures: &[Texture], uv: impl FnOnce() -> Vec2) -> Cow<'_, Self> {
        if self.detail.varies() { Cow::Owned(self.at_place(textures, uv())) } else { Cow::Borrowed(self) }
    }

    /// The material with the diffuse and the specular part of one place, without a name.
    fn at_place(&self, textures: &[Texture], uv: Vec2) -> Self {
        let detail = &self.detail;
        let base = self.diffuse * self.diffuse_texture.map_or(Vec3::ONE, |map| map.color(textures, uv));
        let roughness_of = |roughness: f32| {
            roughness * detail.roughness_texture.map_or(1.0, |map| map.value(textures, uv).y)
        };
        let through = |transmittance: Vec3| match detail.transmission_texture {
            None => transmittance,
            Some(_) => transmittance * base * detail.transmission_at(textures, uv),
        };
        let kind = match self.kind {
            MaterialKind::Glossy { reflectance, roughness } => {
                let metalness = detail.metalness_at(textures, uv);
                let reflectance =
                    if metalness > 0.0 { reflectance.lerp(base, metalness) } else { reflectance };
                MaterialKind::Glossy { reflectance, roughness: roughness_of(roughness) }
            }
            MaterialKind::Glass { eta, transmittance } => {
                MaterialKind::Glass { eta, transmittance: through(transmittance) }
            }
            MaterialKind::Frosted { eta, transmittance, roughness } => {
                let (transmittance, roughness) = (through(transmittance), roughness_of(roughness));
                MaterialKind::Frosted { eta, transmittance, roughness }
            }
            kind => kind,
        };
        let diffuse = base * detail.base_at(textures, uv);
        let none = Detail::default();
        Self { name: String::new(), diffuse, diffuse_texture: None, kind, detail: none, ..*self }
    }

    /// Removes what of the detail does not fit the kind of the material, and clamps the rest.
    /// Returns the number of values that were out of range.
    pub(super) fn sanitize_detail(&mut self) -> usize {
        let (kind, detail) = (self.kind, &mut self.detail);
        let mut clamped = 0;
        let mut within = |value: &mut f32, [low, high]: [f32; 2], instead: f32| {
            let right = if value.is_nan() { instead } else { value.clamp(low, high) };
            clamped += usize::from(right != *value);
            *value = right;
        };
        within(&mut detail.metalness, [0.0, 1.0], 0.0);
        within(&mut detail.transmission, [0.0, 1.0], 0.0);
        if let Some(map) = &mut detail.normal {
            within(&mut map.strength, [-MAX_STRENGTH, MAX_STRENGTH], 1.0);
        }
        detail.normal = detail.normal.filter(|map| map.strength != 0.0);
        let (is_glossy, is_glass) = match kind {
            MaterialKind::Glossy { .. } => (true, false),
            MaterialKind::Glass { .. } | MaterialKind::Frosted { .. } => (false, true),
            MaterialKind::Diffuse | MaterialKind::Mirror { .. } => (false, false),
        };
        if !is_glossy || detail.metalness == 0.0 {
            (detail.metalness, detail.metalness_texture) = (0.0, None);
        }
        if !is_glossy && !matches!(kind, MaterialKind::Frosted { .. }) {
            detail.roughness_texture = None;
        }
        if !is_glass || detail.transmission_texture.is_none() {
            (detail.transmission, detail.transmission_texture) = (0.0, None);
        }
        clamped
    }
}
