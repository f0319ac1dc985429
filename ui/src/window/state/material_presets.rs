//! Materials to choose from, and what is copied from one material to another.

use afterimage::scene::{Material, MaterialKind};
use glam::Vec3;

/// Reflectance of varnish, glaze and most other clear coats at normal incidence: an index of
/// refraction of 1.5.
pub const COAT: f32 = 0.04;

/// A material to choose: how it scatters light, and its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPreset {
    /// Name in the list.
    pub name: &'static str,
    /// Diffuse reflectance, linear Rec. 709; zero where there is no diffuse part.
    pub diffuse: Vec3,
    /// The specular part.
    pub kind: MaterialKind,
}

impl MaterialPreset {
    /// All of them, with the reflectances of usual samples: white paint 0.8, concrete 0.3, red brick
    /// 0.2, limestone 0.45, oak 0.25; metals by their reflectance at normal incidence; clear float
    /// glass of 4 mm, which absorbs about a hundredth at each surface.
    pub const ALL: [Self; 15] = [
        matte("Plaster, white", [0.80, 0.80, 0.78]),
        matte("Concrete", [0.31, 0.30, 0.29]),
        matte("Brick, red", [0.36, 0.15, 0.10]),
        matte("Stone, limestone", [0.50, 0.45, 0.36]),
        coated("Stone, polished granite", [0.12, 0.12, 0.12], 0.1),
        coated("Oak, oiled", [0.38, 0.24, 0.13], 0.45),
        coated("Wood floor, varnished", [0.30, 0.17, 0.09], 0.25),
        coated("Ceramic tiles, white", [0.75, 0.75, 0.74], 0.1),
        matte("Fabric, grey", [0.35, 0.34, 0.32]),
        metal("Steel, brushed", [0.56, 0.57, 0.58], 0.35),
        metal("Brass", [0.89, 0.79, 0.43], 0.2),
        Self {
            name: "Mirror",
            diffuse: Vec3::ZERO,
            kind: MaterialKind::Mirror { reflectance: Vec3::splat(0.9), fresnel: false },
        },
        Self {
            name: "Glass, clear",
            diffuse: Vec3::ZERO,
            kind: MaterialKind::Glass { eta: 1.52, transmittance: Vec3::splat(0.99) },
        },
        Self {
            name: "Glass, frosted",
            diffuse: Vec3::ZERO,
            kind: MaterialKind::Frosted { eta: 1.52, transmittance: Vec3::splat(0.99), roughness: 0.3 },
        },
        Self {
            name: "Water",
            diffuse: Vec3::ZERO,
            kind: MaterialKind::Glass { eta: 1.33, transmittance: Vec3::new(0.96, 0.99, 0.99) },
        },
    ];

    /// Returns a material that is like this one. Its name and its pictures stay.
    pub fn applied_to(&self, material: &Material) -> Material {
        dressed(material, self.kind, self.diffuse)
    }
}

const fn matte(name: &'static str, [r, g, b]: [f32; 3]) -> MaterialPreset {
    MaterialPreset { name, diffuse: Vec3::new(r, g, b), kind: MaterialKind::Diffuse }
}

const fn coated(name: &'static str, [r, g, b]: [f32; 3], roughness: f32) -> MaterialPreset {
    let kind = MaterialKind::Glossy { reflectance: Vec3::splat(COAT), roughness };
    MaterialPreset { name, diffuse: Vec3::new(r, g, b), kind }
}

const fn metal(name: &'static str, [r, g, b]: [f32; 3], roughness: f32) -> MaterialPreset {
    let kind = MaterialKind::Glossy { reflectance: Vec3::new(r, g, b), roughness };
    MaterialPreset { name, diffuse: Vec3::ZERO, kind }
}

/// Returns `into` with the look of another material whose diffuse reflectance, with its pictures,
/// is `color`. Pictures of `into` stay, with its emission: only how they reflect is copied.
pub fn copied(into: &Material, from: &Material, color: Vec3) -> Material {
    // Glass of no refraction stands for what a picture covers.
    let kind = if from.coverage_texture.is_some() { MaterialKind::Diffuse } else { from.kind };
    dressed(into, kind, color)
}

/// Returns a material with another kind and colour. A picture keeps its tint, which is white where
/// there was none.
fn dressed(material: &Material, kind: MaterialKind, color: Vec3) -> Material {
    let has_picture = material.diffuse_texture.is_some() && color != Vec3::ZERO;
    let tint = if material.diffuse == Vec3::ZERO { Vec3::ONE } else { material.diffuse };
    let diffuse = if has_picture { tint } else { color };
    let mut dressed = Material { kind, diffuse, ..material.clone() };
    dressed.scale_to_conserve();
    dressed
}

/// Returns the gloss of a material, 0 for matte to 1 for polished: one minus the roughness.
pub fn gloss_of(material: &Material) -> f32 {
    match material.kind {
        MaterialKind::Diffuse => 0.0,
        MaterialKind::Glossy { roughness, .. } | MaterialKind::Frosted { roughness, .. } => 1.0 - roughness,
        MaterialKind::Mirror { .. } | MaterialKind::Glass { .. } => 1.0,
    }
}

/// Returns a material with another gloss: what was matte gets a clear coat, a mirror becomes a rough
/// metal, and clear glass becomes frosted.
pub fn with_gloss(material: &Material, gloss: f32) -> Material {
    let roughness = 1.0 - gloss;
    let kind = match material.kind {
        MaterialKind::Diffuse => MaterialKind::Glossy { reflectance: Vec3::splat(COAT), roughness },
        MaterialKind::Mirror { reflectance, .. } | MaterialKind::Glossy { reflectance, .. } => {
            MaterialKind::Glossy { reflectance, roughness }
        }
        MaterialKind::Glass { eta, transmittance } | MaterialKind::Frosted { eta, transmittance, .. } => {
            MaterialKind::Frosted { eta, transmittance, roughness }
        }
    };
    Material { kind, ..material.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_reflects_no_more_than_arrives_and_has_a_name_of_its_own() {
        for (i, preset) in MaterialPreset::ALL.iter().enumerate() {
            let material = preset.applied_to(&Material::emissive("lamp", Vec3::X));
            assert_eq!((material.kind, material.diffuse), (preset.kind, preset.diffuse), "{}", preset.name);
            assert!(!material.clone().scale_to_conserve() && material.emission == Vec3::X, "{}", preset.name);
            assert_eq!(material.name, "lamp");
            assert!(MaterialPreset::ALL[..i].iter().all(|other| other.name != preset.name));
        }
    }

    #[test]
    fn a_copy_has_the_look_and_keeps_name_and_light() {
        let from = Material { diffuse: Vec3::splat(0.2), ..Material::mirror("from", Vec3::splat(0.5)) };
        let into = Material::emissive("into", Vec3::Y);
        let copy = copied(&into, &from, from.diffuse);
        assert_eq!((copy.kind, copy.diffuse), (from.kind, from.diffuse));
        assert_eq!((copy.name.as_str(), copy.emission), ("into", Vec3::Y));
        assert_eq!(copied(&copy, &from, from.diffuse), copy);
    }

    #[test]
    fn gloss_is_one_scale_from_matte_to_polished() {
        let metal = Vec3::splat(0.6);
        for material in [
            Material::diffuse("a", Vec3::splat(0.5)),
            Material::mirror("b", metal),
            Material::glass("c", 1.5, Vec3::ONE),
        ] {
            for gloss in [0.0, 0.25, 0.75, 1.0] {
                let glossy = with_gloss(&material, gloss);
                assert_eq!(gloss_of(&glossy), gloss);
                assert_eq!(glossy.diffuse, material.diffuse);
                assert_eq!(glossy.is_glass(), material.is_glass());
            }
        }
        assert_eq!(with_gloss(&Material::mirror("b", metal), 0.5).specular(), metal);
    }
}
