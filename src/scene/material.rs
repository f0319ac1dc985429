//! Surface materials. The diffuse part does not depend on the viewer, so that references can
//! provide it; the specular part must be traced.

use super::{Detail, Texture, TextureRef};
use glam::{Vec2, Vec3};

/// Index into [`Scene::materials`](super::Scene::materials).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub u32);

/// Roughness, 0 to 1, below which a surface reflects and transmits in single directions. There a
/// rough lobe would be about a thousandth of a radian wide, as a pixel of a picture of 1,280 pixels
/// and 60 degrees.
pub const SMOOTH: f32 = 1.0 / 32.0;

/// The specular part of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaterialKind {
    /// There is no specular part: the radiance does not depend on the viewer.
    Diffuse,
    /// Part of the light is reflected as by a mirror.
    Mirror {
        /// Reflectance at normal incidence, linear Rec. 709.
        reflectance: Vec3,
        /// True if the reflectance rises towards grazing angles by Schlick's approximation.
        fresnel: bool,
    },
    /// The light is reflected or transmitted according to Fresnel's equations.
    Glass {
        /// Index of refraction, 1 to 10.
        eta: f32,
        /// Share of the light that remains after passing one surface, linear Rec. 709.
        transmittance: Vec3,
    },
    /// A rough metal, or a rough clear coat over the diffuse part, which gets what the coat does
    /// not reflect.
    Glossy {
        /// Reflectance at normal incidence, linear Rec. 709. It rises to one at grazing angles.
        reflectance: Vec3,
        /// Roughness, 0 to 1: the square root of the slope of the microfacets.
        roughness: f32,
    },
    /// Glass with a rough surface, which scatters what it reflects and transmits.
    Frosted {
        /// Index of refraction, 1 to 10.
        eta: f32,
        /// Share of the light that remains after passing one surface, linear Rec. 709.
        transmittance: Vec3,
        /// Roughness, 0 to 1: the square root of the slope of the microfacets.
        roughness: f32,
    },
}

/// The material of a surface. The diffuse and the specular part never exceed one together.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the model file.
    pub name: String,
    /// Diffuse reflectance (albedo), linear Rec. 709.
    pub diffuse: Vec3,
    /// Texture multiplied with `diffuse`.
    pub diffuse_texture: Option<TextureRef>,
    /// Texture whose alpha channel removes the surface where it is below one half.
    pub alpha_texture: Option<TextureRef>,
    /// Texture whose alpha channel is the share (0..1) of the surface that is there: it scales what
    /// is reflected and emitted, and the rest of the light passes. The specular part must be glass
    /// with an index of refraction of one; its transmittance does not count.
    pub coverage_texture: Option<TextureRef>,
    /// Emitted radiance, linear Rec. 709: from both sides, unless it leaves the front alone.
    pub emission: Vec3,
    /// True where only the front emits: the side from which the corners run counter-clockwise.
    pub emits_from_front: bool,
    /// Texture multiplied with `emission`.
    pub emission_texture: Option<TextureRef>,
    /// True for glass that is a pane wherever it is: also a closed body refracts nothing.
    pub is_thin: bool,
    /// How the surface varies from place to place, apart from its colour.
    pub detail: Detail,
    /// The specular part.
    pub kind: MaterialKind,
}

impl Material {
    /// Returns a diffuse material.
    pub fn diffuse(name: &str, diffuse: Vec3) -> Self {
        Self {
            name: name.to_owned(),
            diffuse,
            diffuse_texture: None,
            alpha_texture: None,
            coverage_texture: None,
            emission: Vec3::ZERO,
            emits_from_front: false,
            emission_texture: None,
            is_thin: false,
            detail: Detail::default(),
            kind: MaterialKind::Diffuse,
        }
    }

    /// Returns a black material that emits light.
    pub fn emissive(name: &str, radiance: Vec3) -> Self {
        Self { emission: radiance, ..Self::diffuse(name, Vec3::ZERO) }
    }

    /// Returns a mirror with the same reflectance at all angles.
    pub fn mirror(name: &str, reflectance: Vec3) -> Self {
        let kind = MaterialKind::Mirror { reflectance, fresnel: false };
        Self { kind, ..Self::diffuse(name, Vec3::ZERO) }
    }

    /// Returns a clear glass with index of refraction `eta`.
    pub fn glass(name: &str, eta: f32, transmittance: Vec3) -> Self {
        Self { kind: MaterialKind::Glass { eta, transmittance }, ..Self::diffuse(name, Vec3::ZERO) }
    }

    /// True if part of the radiance depends on the viewer, so that it must be traced for each view.
    pub fn is_view_dependent(&self) -> bool {
        !matches!(self.kind, MaterialKind::Diffuse)
    }

    /// True if the second lobe only reflects.
    pub fn is_mirror(&self) -> bool {
        self.is_view_dependent() && !self.is_glass()
    }

    /// True for glass, clear or frosted, which transmits light.
    pub fn is_glass(&self) -> bool {
        matches!(self.kind, MaterialKind::Glass { .. } | MaterialKind::Frosted { .. })
    }

    /// True for a rough metal or coat.
    pub fn is_glossy(&self) -> bool {
        matches!(self.kind, MaterialKind::Glossy { .. })
    }

    /// True for frosted glass.
    pub fn is_frosted(&self) -> bool {
        matches!(self.kind, MaterialKind::Frosted { .. })
    }

    /// True if no light can pass: the material is not glass and has no alpha texture.
    pub fn is_opaque(&self) -> bool {
        self.alpha_texture.is_none() && !self.is_glass()
    }

    /// Largest reflectance of a mirror or a coat over all angles and channels; 0 for other
    /// materials.
    pub fn max_mirror_reflectance(&self) -> f32 {
        match self.kind {
            // At grazing angles the Fresnel reflectance is 1.
            MaterialKind::Mirror { fresnel: true, .. } | MaterialKind::Glossy { .. } => 1.0,
            MaterialKind::Mirror { reflectance, .. } => reflectance.max_element(),
            MaterialKind::Diffuse | MaterialKind::Glass { .. } | MaterialKind::Frosted { .. } => 0.0,
        }
    }

    /// True if the surface emits light.
    pub fn is_emissive(&self) -> bool {
        self.emission.max_element() > 0.0
    }

    /// Returns the radiance emitted at a point; `uv` returns its texture coordinate and is called
    /// for textured materials only.
    #[inline(always)]
    pub fn emission_at(&self, textures: &[Texture], uv: impl FnOnce() -> Vec2) -> Vec3 {
        if self.emits_evenly() { self.emission } else { self.emission * self.emission_texel(textures, uv()) }
    }

    /// True where no texture changes the emission.
    pub(crate) fn emits_evenly(&self) -> bool {
        self.emission_texture.is_none() && self.coverage_texture.is_none()
    }

    /// Returns what the textures multiply the emission with.
    pub(crate) fn emission_texel(&self, textures: &[Texture], uv: Vec2) -> Vec3 {
        let texel = self.emission_texture.map_or(Vec3::ONE, |map| map.color(textures, uv));
        texel * self.coverage_at(textures, || uv)
    }

    /// Returns the share (0..1) of the surface that is there at a point.
    #[inline(always)]
    pub fn coverage_at(&self, textures: &[Texture], uv: impl FnOnce() -> Vec2) -> f32 {
        self.coverage_texture.map_or(1.0, |map| map.alpha(textures, uv()))
    }

    /// Returns the share of light that passes a covered surface at a point; `None` for others.
    #[inline(always)]
    pub(crate) fn gap_at(&self, textures: &[Texture], uv: impl FnOnce() -> Vec2) -> Option<f32> {
        self.coverage_texture.map(|map| 1.0 - map.alpha(textures, uv()))
    }

    /// Returns all uses of textures.
    pub fn textures(&self) -> impl Iterator<Item = TextureRef> {
        self.texture_slots().flatten()
    }

    /// Returns the texture of each use, in a fixed order.
    pub(super) fn texture_slots(&self) -> impl Iterator<Item = Option<TextureRef>> {
        [self.diffuse_texture, self.alpha_texture, self.coverage_texture, self.emission_texture]
            .into_iter()
            .chain(self.detail.textures())
    }

    /// Makes the surface transparent by the alpha channel of a texture, without refraction.
    pub fn cover_by(&mut self, texture: TextureRef) {
        self.coverage_texture = Some(texture);
        self.kind = MaterialKind::Glass { eta: 1.0, transmittance: Vec3::ZERO };
    }

    /// Returns the colour of the specular part: the reflectance at normal incidence, the
    /// transmittance of glass, or zero.
    pub fn specular(&self) -> Vec3 {
        match self.kind {
            MaterialKind::Diffuse => Vec3::ZERO,
            MaterialKind::Mirror { reflectance, .. } | MaterialKind::Glossy { reflectance, .. } => {
                reflectance
            }
            MaterialKind::Glass { transmittance, .. } | MaterialKind::Frosted { transmittance, .. } => {
                transmittance
            }
        }
    }

    /// Gives mutable access to the colour of the specular part, if there is one.
    pub(super) fn specular_mut(&mut self) -> Option<&mut Vec3> {
        match &mut self.kind {
            MaterialKind::Diffuse => None,
            MaterialKind::Mirror { reflectance, .. } | MaterialKind::Glossy { reflectance, .. } => {
                Some(reflectance)
            }
            MaterialKind::Glass { transmittance, .. } | MaterialKind::Frosted { transmittance, .. } => {
                Some(transmittance)
            }
        }
    }

    /// Scales the diffuse and the specular part down so that their sum does not exceed one; neither
    /// does so alone where a coat covers the diffuse part. Returns true if they exceeded it by more
    /// than rounding.
    pub fn scale_to_conserve(&mut self) -> bool {
        /// Files hold decimal numbers: 0.8 and 0.2 may add up to slightly more than one.
        const TOLERANCE: f32 = 1e-4;
        let sum = match self.kind {
            MaterialKind::Glossy { reflectance, .. } => self.diffuse.max(reflectance),
            // Each place transmits one part of its light and scatters the other.
            _ if self.detail.transmission_texture.is_some() => self.diffuse.max(self.specular()),
            _ => self.diffuse + self.specular(),
        };
        let sum = sum.max_element();
        if sum <= 1.0 {
            return false;
        }
        self.diffuse /= sum;
        if let Some(specular) = self.specular_mut() {
            *specular /= sum;
        }
        sum > 1.0 + TOLERANCE
    }

    /// Returns as which types of pixel the material is traced, and why.
    pub fn types(&self) -> (&'static str, &'static str) {
        let has_base = self.has_base();
        match self.kind {
            MaterialKind::Diffuse if self.detail.normal.is_some() => {
                ("Types 1 and 3", "relief: direct light is traced, smooth light is reused")
            }
            MaterialKind::Glossy { .. } if self.detail.metalness > 0.0 && has_base => {
                ("Types 1 and 2", "metal in places, with rays by its roughness there")
            }
            MaterialKind::Diffuse => ("Type 1", "its light does not depend on the viewer"),
            MaterialKind::Mirror { .. } if !has_base => ("Type 2", "a mirror: one ray"),
            MaterialKind::Glass { .. } if !has_base => ("Type 2", "clear glass: two rays"),
            MaterialKind::Frosted { .. } if !has_base => ("Type 2", "frosted glass: rays by its roughness"),
            MaterialKind::Glossy { .. } if !has_base => ("Type 2", "rough metal: rays by its roughness"),
            MaterialKind::Mirror { .. } => ("Types 1 and 2", "a mirror over a diffuse base"),
            MaterialKind::Glossy { .. } => ("Types 1 and 2", "a coat, with rays by its share and roughness"),
            MaterialKind::Glass { .. } | MaterialKind::Frosted { .. } => {
                ("Types 1 and 2", "glass with a diffuse part")
            }
        }
    }

    /// True for a lamp whose back does not emit.
    pub fn has_dark_back(&self) -> bool {
        self.emits_from_front && self.is_emissive()
    }

    /// Returns the name of the kind as `inspect` prints it.
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            _ if self.has_dark_back() => "emissive, from its front",
            _ if self.is_emissive() => "emissive",
            MaterialKind::Diffuse => "diffuse",
            MaterialKind::Mirror { .. } => "mirror",
            MaterialKind::Glass { .. } => "glass",
            MaterialKind::Glossy { .. } if !self.has_base() => "rough metal",
            MaterialKind::Glossy { .. } => "coated",
            MaterialKind::Frosted { .. } => "frosted glass",
        }
    }
}
