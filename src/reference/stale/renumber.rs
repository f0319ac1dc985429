//! The triangles of a model that was loaded again, found by their content.

use super::moved::Moved;
use crate::scene::content::{ContentHash, hashes_of_triangles};
use crate::scene::{Daylight, Light, Material, MaterialId, Scene, Texture, TextureId};
use std::cmp::Ordering;
use std::sync::Arc;

/// No triangle of the other scene.
const NONE: u32 = u32::MAX;

/// Which triangle of one scene is which of another.
#[derive(Debug)]
pub(crate) struct Renumbering {
    /// New number of each old triangle; `u32::MAX` for those that are gone.
    pub(crate) new_of_old: Vec<u32>,
    /// Old number of each new triangle; [`NONE`] for those that were added.
    old_of_new: Vec<u32>,
    /// Boxes around triangles that are in only one of the two scenes; `None` where all are in both.
    pub(crate) moved: Option<Moved>,
}

impl Renumbering {
    /// Finds the triangles of one scene in another. Returns `None` where the two lie differently in
    /// scene space, or where fewer than half of the triangles are in both.
    pub(crate) fn between(old: &Scene, new: &Scene) -> Option<Self> {
        let counts = [old, new].map(|scene| scene.triangles.len());
        if old.frame != new.frame || counts[0] > 2 * counts[1] || counts[1] > 2 * counts[0] {
            return None;
        }
        let hashes = [old, new].map(hashes_of_triangles);
        let (new_of_old, old_of_new) = matched(hashes.each_ref().map(Vec::as_slice));
        let [gone, added] = [&new_of_old, &old_of_new].map(|numbers| unmatched(numbers));
        if gone.len() + added.len() > counts[0] {
            return None;
        }
        let has_moved = !gone.is_empty() || !added.is_empty();
        let moved = has_moved.then(|| Moved::new((old, &gone), (new, &added)));
        Some(Self { new_of_old, old_of_new, moved })
    }

    /// A state of the old scene, with the triangles of the new one. Those that were added have the
    /// materials of the new one, which are appended where they differ from the old ones.
    pub(crate) fn state_of(&self, old: &Scene, new: &Scene) -> Scene {
        let is_point = |light: &&Light| matches!(light, Light::Point { .. });
        let shares_textures = Arc::ptr_eq(&old.textures, &new.textures);
        let adds = self.moved.is_some() && !(shares_textures && old.materials.starts_with(&new.materials));
        let first = if adds { old.materials.len() as u32 } else { 0 };
        let material = |(new_triangle, &t): (usize, &u32)| -> MaterialId {
            match old.triangle_materials.get(t as usize) {
                Some(&material) => material,
                None => MaterialId(first + new.triangle_materials[new_triangle].0),
            }
        };
        let (mut materials, mut textures) = (old.materials.clone(), old.textures.clone());
        if adds {
            let shift = if shares_textures { 0 } else { textures.len() as u32 };
            materials.extend(new.materials.iter().map(|material| with_textures_after(material, shift)));
            if shift > 0 {
                let all: Vec<Texture> = old.textures.iter().chain(new.textures.iter()).cloned().collect();
                textures = Arc::new(all);
            }
        }
        let state = Scene {
            triangle_materials: Arc::new(self.old_of_new.iter().enumerate().map(material).collect()),
            materials,
            textures,
            lights: old.lights.iter().filter(is_point).cloned().collect(),
            ..(*new.at_full()).clone()
        };
        state.with_daylight(Daylight { sun: old.sun, sky: old.sky.clone() })
    }
}

/// Matches equal hashes of two ascending lists, in their order, so that of equal triangles the
/// visible one stays visible. Returns the number in the other list of each triangle.
fn matched([old, new]: [&[(ContentHash, u32)]; 2]) -> (Vec<u32>, Vec<u32>) {
    let (mut new_of_old, mut old_of_new) = (vec![NONE; old.len()], vec![NONE; new.len()]);
    let (mut i, mut j) = (0, 0);
    while let (Some(a), Some(b)) = (old.get(i), new.get(j)) {
        let order = a.0.cmp(&b.0);
        if order == Ordering::Equal {
            new_of_old[a.1 as usize] = b.1;
            old_of_new[b.1 as usize] = a.1;
        }
        i += usize::from(order != Ordering::Greater);
        j += usize::from(order != Ordering::Less);
    }
    (new_of_old, old_of_new)
}

fn unmatched(numbers: &[u32]) -> Vec<u32> {
    (0..).zip(numbers).filter(|(_, other)| **other == NONE).map(|(triangle, _)| triangle).collect()
}

/// A material whose textures come after others.
fn with_textures_after(material: &Material, shift: u32) -> Material {
    let mut shifted = material.clone();
    let Material { diffuse_texture, alpha_texture, coverage_texture, emission_texture, detail, .. } =
        &mut shifted;
    let colors = [diffuse_texture, alpha_texture, coverage_texture, emission_texture];
    let colors = colors.into_iter().map(Option::as_mut);
    for used in colors.chain(detail.textures_mut()).flatten() {
        used.texture = TextureId(used.texture.0 + shift);
    }
    shifted
}
