//! Materials and textures of the gallery.

use crate::scene::builtin::parts::{HARBOUR, MARBLE, Materials, TIDE, TILES, WOOD, texture, textured};
use crate::scene::{Material, MaterialId, SceneBuilder, SceneError, TextureRef};
use glam::{Vec2, Vec3};

/// The materials of the gallery, named after their use.
#[derive(Clone, Debug)]
pub(super) struct Palette {
    pub(super) white: MaterialId,
    pub(super) red: MaterialId,
    pub(super) blue: MaterialId,
    pub(super) sand: MaterialId,
    pub(super) green: MaterialId,
    pub(super) outside: MaterialId,
    pub(super) ceiling: MaterialId,
    pub(super) coffer: MaterialId,
    pub(super) trim: MaterialId,
    pub(super) stone: MaterialId,
    pub(super) reveal: MaterialId,
    pub(super) wood_floor: MaterialId,
    pub(super) dark_wood_floor: MaterialId,
    pub(super) tile_floor: MaterialId,
    pub(super) marble_floor: MaterialId,
    pub(super) marble: MaterialId,
    pub(super) wood: MaterialId,
    pub(super) iron: MaterialId,
    pub(super) gilt: MaterialId,
    pub(super) black: MaterialId,
    pub(super) plaster: MaterialId,
    pub(super) terracotta: MaterialId,
    pub(super) bronze: MaterialId,
    pub(super) ultramarine: MaterialId,
    pub(super) ochre: MaterialId,
    pub(super) jade: MaterialId,
    pub(super) mirror: MaterialId,
    pub(super) glass: MaterialId,
    pub(super) paintings: Vec<MaterialId>,
}

impl Palette {
    pub(super) fn add_to(b: &mut SceneBuilder) -> Result<Self, SceneError> {
        let wood = texture(b, &WOOD)?;
        let tiles = texture(b, &TILES)?;
        let marble = texture(b, &MARBLE)?;
        let paintings = paintings(b)?;
        let mut matte =
            |name: &str, r, g, blue| b.add_material(Material::diffuse(name, Vec3::new(r, g, blue)));
        Ok(Self {
            white: matte("wall white", 0.76, 0.74, 0.70),
            red: matte("wall red", 0.46, 0.07, 0.06),
            blue: matte("wall blue-grey", 0.26, 0.35, 0.44),
            sand: matte("wall sand", 0.70, 0.60, 0.44),
            green: matte("wall green-grey", 0.36, 0.44, 0.36),
            outside: matte("outside plaster", 0.62, 0.6, 0.56),
            ceiling: matte("ceiling", 0.72, 0.71, 0.69),
            coffer: matte("coffer", 0.74, 0.72, 0.67),
            trim: matte("trim", 0.80, 0.78, 0.73),
            stone: matte("limestone", 0.66, 0.62, 0.55),
            reveal: matte("door reveal", 0.50, 0.47, 0.42),
            iron: matte("wrought iron", 0.055, 0.055, 0.06),
            gilt: matte("gilt", 0.62, 0.43, 0.16),
            black: matte("black lacquer", 0.04, 0.04, 0.045),
            plaster: matte("plaster", 0.82, 0.80, 0.76),
            terracotta: matte("terracotta", 0.60, 0.27, 0.15),
            bronze: matte("bronze patina", 0.26, 0.22, 0.15),
            ultramarine: matte("ultramarine", 0.06, 0.10, 0.46),
            ochre: matte("ochre", 0.68, 0.44, 0.12),
            jade: matte("jade", 0.24, 0.48, 0.36),
            wood_floor: textured(b, "oak floor", wood, [0.5, 0.5], Vec3::splat(0.85)),
            dark_wood_floor: textured(b, "walnut floor", wood, [0.5, 0.5], Vec3::new(0.62, 0.55, 0.5)),
            tile_floor: textured(b, "tile floor", tiles, [0.5, 0.5], Vec3::new(0.72, 0.70, 0.67)),
            marble_floor: textured(b, "marble floor", marble, [0.8, 0.8], Vec3::new(0.72, 0.7, 0.67)),
            marble: textured(b, "marble", marble, [1.4, 1.4], Vec3::new(0.95, 0.93, 0.9)),
            wood: textured(b, "walnut", wood, [0.7, 0.7], Vec3::new(0.7, 0.6, 0.52)),
            mirror: b.add_material(Material::mirror("mirror", Vec3::splat(0.9))),
            glass: b.add_material(Material::glass("vitrine glass", 1.5, Vec3::new(0.98, 0.995, 0.985))),
            paintings,
        })
    }

    /// Returns the materials of the parts that other galleries use as well.
    pub(super) fn parts(&self) -> Materials {
        Materials {
            stone: self.stone,
            plaster: self.plaster,
            white: self.white,
            wood: self.wood,
            iron: self.iron,
            gilt: self.gilt,
            bronze: self.bronze,
            jade: self.jade,
            black: self.black,
            cloth: self.red,
            glass: self.glass,
        }
    }
}

/// Adds materials that show two paintings as a whole and in parts.
fn paintings(b: &mut SceneBuilder) -> Result<Vec<MaterialId>, SceneError> {
    let harbour = texture(b, &HARBOUR)?;
    let tide = texture(b, &TIDE)?;
    let crops = [
        (harbour, [1.0, 1.0], [0.0, 0.0], [1.0, 1.0, 1.0]),
        (tide, [1.0, 1.0], [0.0, 0.0], [1.0, 1.0, 1.0]),
        (harbour, [0.45, 0.45], [0.45, 0.45], [1.0, 0.97, 0.9]),
        (tide, [0.5, 0.5], [0.3, 0.1], [1.0, 0.9, 0.75]),
        (tide, [-0.6, 0.6], [0.9, 0.4], [0.75, 0.9, 1.0]),
        (harbour, [-0.5, 0.5], [0.62, 0.02], [0.95, 1.0, 0.92]),
    ];
    Ok(crops
        .iter()
        .enumerate()
        .map(|(i, &(texture, scale, offset, tint))| {
            let map = TextureRef::new(texture, Vec2::from(scale), Vec2::from(offset));
            b.add_material(Material {
                diffuse_texture: Some(map),
                ..Material::diffuse(&format!("painting {}", i + 1), Vec3::from(tint))
            })
        })
        .collect())
}
