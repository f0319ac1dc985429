//! Surface materials: a diffuse part that references can lend, and a specular part that must be traced.

use super::TextureId;
use glam::{Vec2, Vec3};

/// What happens to light at a surface beside diffuse reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaterialKind {
    /// Nothing: the radiance does not depend on the viewer.
    Diffuse,
    /// Part of the light is mirrored.
    Mirror {
        /// Reflectance, straight on.
        reflectance: Vec3,
        /// With Schlick's rise towards grazing angles.
        fresnel: bool,
    },
    /// Part of the light passes or is mirrored by Fresnel's equations.
    Glass {
        /// Index of refraction, 1..10.
        eta: f32,
        /// Share of light that a passage through one surface keeps.
        transmittance: Vec3,
    },
}

/// One surface material. `diffuse` and the specular part never exceed one together.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// As in the file.
    pub name: String,
    /// Diffuse reflectance (albedo), linear Rec. 709.
    pub diffuse: Vec3,
    /// Multiplied with `diffuse`.
    pub diffuse_texture: Option<TextureRef>,
    /// The alpha channel of this texture cuts the surface away where it is below one half.
    pub alpha_texture: Option<TextureRef>,
    /// Emitted radiance, both sides.
    pub emission: Vec3,
    /// The specular part.
    pub kind: MaterialKind,
}

impl Material {
    /// A matte material.
    pub fn diffuse(name: &str, diffuse: Vec3) -> Self {
        Self {
            name: name.to_owned(),
            diffuse,
            diffuse_texture: None,
            alpha_texture: None,
            emission: Vec3::ZERO,
            kind: MaterialKind::Diffuse,
        }
    }

    /// A black body that emits.
    pub fn emissive(name: &str, radiance: Vec3) -> Self {
        Self { emission: radiance, ..Self::diffuse(name, Vec3::ZERO) }
    }

    /// A perfect mirror.
    pub fn mirror(name: &str, reflectance: Vec3) -> Self {
        let kind = MaterialKind::Mirror { reflectance, fresnel: false };
        Self { kind, ..Self::diffuse(name, Vec3::ZERO) }
    }

    /// Clear glass.
    pub fn glass(name: &str, eta: f32, transmittance: Vec3) -> Self {
        Self { kind: MaterialKind::Glass { eta, transmittance }, ..Self::diffuse(name, Vec3::ZERO) }
    }

    /// True where a viewer-dependent ray must be traced.
    pub fn is_specular(&self) -> bool {
        !matches!(self.kind, MaterialKind::Diffuse)
    }

    /// True for mirrors, with or without Fresnel's rise.
    pub fn is_mirror(&self) -> bool {
        matches!(self.kind, MaterialKind::Mirror { .. })
    }

    /// True for dielectrics, which let light pass.
    pub fn is_glass(&self) -> bool {
        matches!(self.kind, MaterialKind::Glass { .. })
    }

    /// True if no light passes anywhere: the material is not glass and no alpha texture cuts holes.
    pub fn is_opaque(&self) -> bool {
        self.alpha_texture.is_none() && !self.is_glass()
    }

    /// Factor of the specular part: the mirror's reflectance facing the surface, the glass's transmittance, or
    /// zero for diffuse materials.
    pub fn specular(&self) -> Vec3 {
        match self.kind {
            MaterialKind::Diffuse => Vec3::ZERO,
            MaterialKind::Mirror { reflectance, .. } => reflectance,
            MaterialKind::Glass { transmittance, .. } => transmittance,
        }
    }

    /// True where the surface gives light of its own.
    pub fn is_emissive(&self) -> bool {
        self.emission.max_element() > 0.0
    }

    /// Scales diffuse and specular part down to one in sum; true where that was needed by more than rounding.
    pub fn scale_to_conserve(&mut self) -> bool {
        /// Files are written in decimals: 0.8 and 0.2 may sum to a hair above one.
        const SLACK: f32 = 1e-4;
        let sum = (self.diffuse + self.specular()).max_element();
        if sum <= 1.0 {
            return false;
        }
        self.diffuse /= sum;
        match &mut self.kind {
            MaterialKind::Diffuse => {}
            MaterialKind::Mirror { reflectance: part, .. }
            | MaterialKind::Glass { transmittance: part, .. } => {
                *part /= sum;
            }
        }
        sum > 1.0 + SLACK
    }

    /// The word that `inspect` uses.
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            _ if self.is_emissive() => "emissive",
            MaterialKind::Diffuse => "diffuse",
            MaterialKind::Mirror { .. } => "mirror",
            MaterialKind::Glass { .. } => "glass",
        }
    }
}

/// A texture as a material uses it: coordinates are `uv * scale + offset`, repeated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Which one.
    pub texture: TextureId,
    /// Applied first.
    pub scale: Vec2,
    /// Applied second.
    pub offset: Vec2,
}

impl TextureRef {
    /// The texture as it is.
    pub fn plain(texture: TextureId) -> Self {
        Self { texture, scale: Vec2::ONE, offset: Vec2::ZERO }
    }
}
