//! Interpreting MTL materials: illumination models, transparency, and the usual mistakes of
//! exporters.

use super::mtl::MtlMaterial;
use crate::import::surfaces::{COAT, GLASS_ETA, Gloss, METAL, NEUTRAL, glass_of, thin};
use crate::import::{tally::Tally, trouble::Trouble};
use crate::scene::{Material, MaterialKind};
use glam::Vec3;

/// Diffuse reflectance above which a surface is neither a mirror nor clear glass.
const DARK: f32 = 0.1;

/// Share of all materials above which an improbable claim is a habit of the exporter.
const DISTRUST_SHARE: f32 = 0.8;

/// Illumination model that `illum` selects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Model {
    Matte,
    Mirror { fresnel: bool },
    Glass,
}

impl Model {
    fn of(m: &MtlMaterial) -> Self {
        match m.illum {
            Some(3 | 8) => Self::Mirror { fresnel: false },
            Some(5) => Self::Mirror { fresnel: true },
            Some(4 | 6 | 7 | 9) => Self::Glass,
            _ => Self::Matte,
        }
    }
}

/// How a material of the PBR extension of MTL reflects; `None` where it does not use it. `Ks` and `Ns`
/// alone say nothing: exporters write them for matte materials too.
fn gloss(m: &MtlMaterial) -> Option<Gloss> {
    if [m.roughness, m.metallic, m.coat].iter().all(Option::is_none) {
        return None;
    }
    let share = |value: Option<f32>, default: f32| value.unwrap_or(default).clamp(0.0, 1.0);
    let metalness = share(m.metallic, 0.0);
    let (mut coat, mut roughness) = (Vec3::splat(COAT), share(m.roughness, 1.0));
    let of_coat = share(m.coat_roughness, 0.0);
    if share(m.coat, 0.0) > 0.0 && metalness <= METAL && of_coat < roughness {
        (coat, roughness) = (Vec3::splat(COAT * share(m.coat, 0.0)), of_coat);
    }
    Some(Gloss { metalness, roughness, coat })
}

fn is_bright(m: &MtlMaterial) -> bool {
    m.diffuse.map_or(m.map_diffuse.is_some(), |kd| kd.max_element() > DARK)
}

/// Returns the opacity: `d` where it is given, else `1 - Tr`.
fn opacity(m: &MtlMaterial) -> f32 {
    m.opacity.or(m.transparency.map(|tr| 1.0 - tr)).unwrap_or(1.0)
}

/// True where more than [`DISTRUST_SHARE`] of all materials are bright and claim to be mirrors or
/// glass: then the claim means nothing.
pub(super) fn distrusted(all: &[MtlMaterial]) -> bool {
    let claims = |m: &&MtlMaterial| Model::of(m) != Model::Matte && m.illum.is_some() && is_bright(m);
    all.iter().filter(claims).count() as f32 > DISTRUST_SHARE * all.len() as f32
}

/// Converts a material as written to one that can be traced, without its textures.
pub(super) fn interpret(m: &MtlMaterial, distrusted: bool, tally: &mut Tally) -> Material {
    let mut model = Model::of(m);
    let mut d = opacity(m);
    if distrusted && model != Model::Matte && is_bright(m) && d >= 1.0 {
        tally.add(Trouble::DISTRUSTED, m.line, || m.name.clone());
        model = Model::Matte;
    }
    if d <= 0.0 && model != Model::Glass {
        tally.add(Trouble::INVERTED_TRANSPARENCY, m.line, || m.name.clone());
        d = 1.0;
    }
    let mut material = Material::diffuse(&m.name, diffuse_of(m, model));
    // A texture of emission alone gives its own colours.
    material.emission = m.emission.unwrap_or(if m.map_emission.is_some() { Vec3::ONE } else { Vec3::ZERO });
    match model {
        Model::Glass => glass(&mut material, m, d, tally),
        _ if d < 1.0 => thin(&mut material, d),
        // The extension knows better than the model, of which exporters write the nearest.
        _ if let Some(gloss) = gloss(m) => {
            let base = material.diffuse;
            gloss.apply(&mut material, base);
        }
        Model::Mirror { fresnel } => mirror(&mut material, m, fresnel),
        Model::Matte => {}
    }
    if material.scale_to_conserve() {
        tally.add(Trouble::TOO_BRIGHT, m.line, || m.name.clone());
    }
    material
}

fn diffuse_of(m: &MtlMaterial, model: Model) -> Vec3 {
    let default = match model {
        _ if m.map_diffuse.is_some() => 1.0,
        Model::Matte if m.emission.is_none_or(|ke| ke == Vec3::ZERO) => NEUTRAL,
        _ => 0.0,
    };
    m.diffuse.unwrap_or(Vec3::splat(default))
}

fn mirror(material: &mut Material, m: &MtlMaterial, fresnel: bool) {
    let reflectance = m.specular.unwrap_or(Vec3::ZERO);
    if reflectance.max_element() > 0.0 {
        material.kind = MaterialKind::Mirror { reflectance, fresnel };
    }
}

fn glass(material: &mut Material, m: &MtlMaterial, d: f32, tally: &mut Tally) {
    // Only a `d` between 0 and 1 is the share of pigment; exporters leave 1 on clear glass.
    material.diffuse *= if d > 0.0 && d < 1.0 { d } else { 0.0 };
    let eta = m.eta.unwrap_or(GLASS_ETA);
    if !(1.0..=10.0).contains(&eta) {
        tally.add(Trouble::INDEX_OF_REFRACTION, m.line, || format!("'{}', Ni {eta}", m.name));
    }
    // Exporters write `Tf 0 0 0` for "not set".
    let filter = m.filter.filter(|tf| *tf != Vec3::ZERO).unwrap_or(Vec3::ONE).min(Vec3::ONE);
    let transmittance = filter.min((Vec3::ONE - material.diffuse).max(Vec3::ZERO));
    let roughness = m.roughness.unwrap_or(0.0).clamp(0.0, 1.0);
    material.kind = glass_of(eta.clamp(1.0, 10.0), transmittance, roughness);
}
