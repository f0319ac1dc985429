//! Interpreting MTL materials: illumination models, transparency, and the usual mistakes of
//! exporters.

use super::mtl::MtlMaterial;
use crate::import::surfaces::{COAT, GLASS_ETA, Gloss, METAL, NEUTRAL, glass_of, thin};
use crate::import::{tally::Tally, trouble::Trouble};
use crate::scene::{Material, MaterialKind};
use glam::Vec3;

/// Diffuse reflectance above which a surface is neither a mirror nor clear glass.
const DARK: f32 = 0.1;

/// How many times as bright as the diffuse reflectance the specular one of a mirror is at least,
/// where both together exceed one.
const MIRROR_DOMINATES: f32 = 2.0;

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

/// Returns the largest diffuse reflectance. `Kd 0` in front of a picture does not count.
fn brightness(m: &MtlMaterial) -> f32 {
    let stated = m.diffuse.filter(|kd| m.map_diffuse.is_none() || *kd != Vec3::ZERO);
    stated.map_or(if m.map_diffuse.is_some() { 1.0 } else { 0.0 }, Vec3::max_element)
}

/// How a material of the PBR extension of MTL reflects; `None` where it does not use it. `Ks` and
/// `Ns` alone say nothing: exporters write them for matte materials too.
fn gloss(m: &MtlMaterial) -> Option<Gloss> {
    let has_picture = m.map_roughness.is_some() || m.map_metallic.is_some();
    if !has_picture && [m.roughness, m.metallic, m.coat].iter().all(Option::is_none) {
        return None;
    }
    let share = |value: Option<f32>, default: f32| value.unwrap_or(default).clamp(0.0, 1.0);
    let metalness = share(m.metallic, if m.map_metallic.is_some() { 1.0 } else { 0.0 });
    let (mut coat, mut roughness) = (Vec3::splat(COAT), share(m.roughness, 1.0));
    let of_coat = share(m.coat_roughness, 0.0);
    if share(m.coat, 0.0) > 0.0 && metalness <= METAL && of_coat < roughness {
        (coat, roughness) = (Vec3::splat(COAT * share(m.coat, 0.0)), of_coat);
    }
    Some(Gloss { metalness, roughness, coat })
}

/// Returns the opacity: `d` where it is given, else `1 - Tr`, else that of Maya.
fn opacity(m: &MtlMaterial) -> f32 {
    m.opacity.or(m.transparency.map(|tr| 1.0 - tr)).or(opacity_of_maya(m)).unwrap_or(1.0)
}

/// Maya writes `illum 4`, `Ni 1.00` and its opacity as `Tf` for all materials that are not metal.
fn opacity_of_maya(m: &MtlMaterial) -> Option<f32> {
    let is_maya = m.illum == Some(4) && m.eta == Some(1.0);
    is_maya.then(|| tint(m)).flatten().map(|tf| tf.element_sum() / 3.0)
}

/// Returns the filter where it says something: exporters write 1 and 0 for "not set".
fn tint(m: &MtlMaterial) -> Option<Vec3> {
    m.filter.map(|tf| tf.min(Vec3::ONE)).filter(|tf| *tf != Vec3::ZERO && *tf != Vec3::ONE)
}

/// The values that belong to an `illum` of mirror or glass. Where an exporter writes the same for
/// a surface that is clearly neither, they mean nothing anywhere in the file.
type Signature = (Option<u32>, Option<Vec3>, Option<f32>, Option<Vec3>);

fn signature(m: &MtlMaterial) -> Signature {
    (m.illum, m.specular, m.eta, m.filter)
}

/// What an exporter writes for `illum` without meaning it.
#[derive(Default)]
pub(super) struct Habits(Vec<Signature>);

impl Habits {
    /// Finds the habits in all materials of a model: the values of those that contradict
    /// themselves.
    pub(super) fn of(all: &[MtlMaterial]) -> Self {
        let mut habits: Vec<Signature> = Vec::new();
        for m in all.iter().filter(|m| Model::of(m) != Model::Matte && !agrees(m)) {
            if !habits.contains(&signature(m)) {
                habits.push(signature(m));
            }
        }
        Self(habits)
    }

    /// True where a material is the mirror or the glass that its `illum` claims.
    fn believe(&self, m: &MtlMaterial) -> bool {
        m.illum.is_none() || opacity(m) < 1.0 || agrees(m) && !self.0.contains(&signature(m))
    }
}

/// True where the other values of a material agree with an `illum` of mirror or glass.
fn agrees(m: &MtlMaterial) -> bool {
    if m.illum.is_none() || opacity(m) < 1.0 {
        return true;
    }
    let (diffuse, specular) = (brightness(m), m.specular.map_or(0.0, Vec3::max_element));
    match Model::of(m) {
        Model::Glass => {
            let is_black = m.diffuse.is_none_or(|kd| kd == Vec3::ZERO);
            let refracts = m.eta.map_or(is_black, |ni| ni != 1.0);
            m.map_diffuse.is_none() && diffuse <= DARK && (refracts || tint(m).is_some())
        }
        Model::Mirror { .. } => {
            // Decimal numbers add up to slightly more than one.
            let fits = diffuse + specular <= 1.01;
            let dominates = m.map_diffuse.is_none() && specular >= MIRROR_DOMINATES * diffuse;
            fits || dominates
        }
        Model::Matte => true,
    }
}

/// Converts a material as written to one that can be traced, without its textures.
pub(super) fn interpret(m: &MtlMaterial, habits: &Habits, tally: &mut Tally) -> Material {
    let mut model = Model::of(m);
    let mut d = opacity(m);
    if model != Model::Matte && !habits.believe(m) {
        tally.add(Trouble::DISTRUSTED, m.line, || m.name.clone());
        model = Model::Matte;
    }
    if m.opacity.or(m.transparency).is_none() && opacity_of_maya(m).is_some() {
        tally.add(Trouble::MAYA_OPACITY, m.line, || m.name.clone());
        model = Model::Matte;
    }
    if m.diffuse == Some(Vec3::ZERO) && m.map_diffuse.is_some() && model == Model::Matte {
        tally.add(Trouble::BLACK_PICTURE, m.line, || m.name.clone());
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
            if gloss.metalness > METAL && m.coat.is_some_and(|coat| coat > 0.0) {
                tally.add(Trouble::METAL_COAT, m.line, || m.name.clone());
            }
            let base = material.diffuse;
            // Pictures are read later: `settle` then makes matte what does not reflect.
            match (m.map_roughness.is_some() || m.map_metallic.is_some(), m.map_diffuse.is_some()) {
                (true, _) => gloss.apply_always(&mut material),
                (false, true) if gloss.metalness > 0.0 => gloss.apply_by_place(&mut material),
                (false, _) => gloss.apply(&mut material, base),
            }
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
    let is_hidden = |kd: &Vec3| m.map_diffuse.is_some() && model == Model::Matte && *kd == Vec3::ZERO;
    m.diffuse.filter(|kd| !is_hidden(kd)).unwrap_or(Vec3::splat(default))
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
