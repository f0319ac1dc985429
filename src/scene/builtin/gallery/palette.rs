//! Materials and textures of the gallery.

use super::plan::RoomName;
use super::{paintings, parquet, weave};
use crate::scene::builtin::parts::{HARBOUR, MARBLE, Materials, TILES, WOOD, texture, textured};
use crate::scene::{Material, MaterialId, MaterialKind, SceneBuilder, SceneError, TextureId, TextureRef};
use glam::Vec3;

/// The materials of the gallery, named after their use.
#[derive(Clone, Debug)]
pub(super) struct Palette {
    pub(super) parts: Materials,
    /// Walls of each room, in the order of [`RoomName`].
    pub(super) walls: [MaterialId; 6],
    /// Floors of each room, in the order of [`RoomName`].
    pub(super) floors: [MaterialId; 6],
    /// Panelling of the mirror room, the salon and the treasury.
    panelling: [MaterialId; 3],
    pub(super) ceiling: MaterialId,
    pub(super) trim: MaterialId,
    pub(super) beam: MaterialId,
    pub(super) outside: MaterialId,
    pub(super) brass: MaterialId,
    pub(super) brushed_brass: MaterialId,
    pub(super) shade: MaterialId,
    /// White paint on iron.
    pub(super) iron_white: MaterialId,
    pub(super) mirror: MaterialId,
    pub(super) window_glass: MaterialId,
    pub(super) frosted_glass: MaterialId,
    pub(super) curtain: MaterialId,
    pub(super) screen: MaterialId,
    pub(super) marble: MaterialId,
    pub(super) terracotta: MaterialId,
    pub(super) ultramarine: MaterialId,
    pub(super) ochre: MaterialId,
    pub(super) rug: MaterialId,
    pub(super) rug_border: MaterialId,
    pub(super) velvet: MaterialId,
    pub(super) soil: MaterialId,
    pub(super) bark: MaterialId,
    pub(super) leaves: [MaterialId; 2],
    pub(super) lawn: MaterialId,
    pub(super) gravel: MaterialId,
    pub(super) paper: MaterialId,
    pub(super) paintings: Vec<MaterialId>,
}

/// Textures of stone and wood.
struct Surfaces {
    wood: TextureId,
    parquet: TextureId,
    tiles: TextureId,
    marble: TextureId,
}

impl Palette {
    pub(super) fn add_to(b: &mut SceneBuilder) -> Result<Self, SceneError> {
        let [wood, tiles, marble] = [texture(b, &WOOD)?, texture(b, &TILES)?, texture(b, &MARBLE)?];
        let parquet = b.add_texture(parquet::herringbone());
        let surfaces = Surfaces { wood, parquet, tiles, marble };
        let paintings = paintings::add_to(b)?;
        let parts = parts(b, &surfaces);
        let floors = floors(b, &surfaces);
        Ok(Self {
            parts,
            walls: walls(b),
            floors,
            panelling: [
                matte(b, "panelling sage", [0.50, 0.56, 0.46]),
                matte(b, "panelling ivory", [0.74, 0.69, 0.60]),
                matte(b, "panelling blue-grey", [0.33, 0.41, 0.49]),
            ],
            ceiling: matte(b, "ceiling", [0.80, 0.79, 0.76]),
            trim: matte(b, "trim", [0.78, 0.76, 0.71]),
            beam: textured(b, "oak beam", wood, [0.7, 0.7], Vec3::new(0.62, 0.56, 0.5)),
            outside: matte(b, "outside plaster", [0.68, 0.63, 0.54]),
            brass: matte(b, "brass", [0.58, 0.44, 0.2]),
            brushed_brass: rough(b, "brushed brass", [0.0; 3], [0.88, 0.7, 0.38], 0.35),
            shade: matte(b, "lamp shade", [0.80, 0.74, 0.62]),
            iron_white: matte(b, "painted iron", [0.66, 0.67, 0.66]),
            mirror: b.add_material(Material::mirror("mirror", Vec3::new(0.88, 0.9, 0.89))),
            window_glass: b.add_material(Material::glass("window glass", 1.5, Vec3::new(0.97, 0.985, 0.98))),
            frosted_glass: frosted(b),
            curtain: curtain(b),
            screen: screen(b)?,
            marble: textured(b, "marble", marble, [1.4, 1.4], Vec3::new(0.95, 0.93, 0.9)),
            terracotta: matte(b, "terracotta", [0.60, 0.28, 0.16]),
            ultramarine: matte(b, "ultramarine", [0.08, 0.13, 0.46]),
            ochre: matte(b, "ochre", [0.68, 0.46, 0.14]),
            rug: matte(b, "rug", [0.22, 0.055, 0.055]),
            rug_border: matte(b, "rug border", [0.50, 0.40, 0.25]),
            velvet: matte(b, "green velvet", [0.09, 0.24, 0.17]),
            soil: matte(b, "soil", [0.09, 0.065, 0.045]),
            bark: matte(b, "bark", [0.20, 0.15, 0.11]),
            leaves: [matte(b, "leaves", [0.14, 0.20, 0.07]), matte(b, "dark leaves", [0.065, 0.11, 0.05])],
            lawn: matte(b, "lawn", [0.17, 0.22, 0.08]),
            gravel: matte(b, "gravel", [0.36, 0.32, 0.26]),
            paper: matte(b, "label", [0.8, 0.79, 0.75]),
            paintings,
        })
    }

    /// Returns the material of a room's panelling, if it has any.
    pub(super) fn panelling(&self, room: RoomName) -> Option<MaterialId> {
        let [mirrors, salon, treasury] = self.panelling;
        match room {
            RoomName::Mirrors => Some(mirrors),
            RoomName::Salon => Some(salon),
            RoomName::Treasury => Some(treasury),
            RoomName::LongGallery | RoomName::Hall | RoomName::GardenRoom => None,
        }
    }
}

fn matte(b: &mut SceneBuilder, name: &str, color: [f32; 3]) -> MaterialId {
    b.add_material(Material::diffuse(name, Vec3::from(color)))
}

/// Adds a metal, whose base is black, or a coat over a base.
fn rough(
    b: &mut SceneBuilder,
    name: &str,
    base: [f32; 3],
    reflectance: [f32; 3],
    roughness: f32,
) -> MaterialId {
    let kind = MaterialKind::Glossy { reflectance: Vec3::from(reflectance), roughness };
    b.add_material(Material { kind, ..Material::diffuse(name, Vec3::from(base)) })
}

fn frosted(b: &mut SceneBuilder) -> MaterialId {
    let kind = MaterialKind::Frosted { eta: 1.5, transmittance: Vec3::splat(0.96), roughness: 0.3 };
    b.add_material(Material { kind, ..Material::diffuse("frosted glass", Vec3::ZERO) })
}

fn curtain(b: &mut SceneBuilder) -> MaterialId {
    let texture = b.add_texture(weave::sheer());
    let mut material = Material::diffuse("sheer curtain", Vec3::splat(0.8));
    material.cover_by(TextureRef::plain(texture));
    b.add_material(material)
}

/// Adds a screen that shows a picture as bright as the walls around it.
fn screen(b: &mut SceneBuilder) -> Result<MaterialId, SceneError> {
    let picture = texture(b, &HARBOUR)?;
    let emission_texture = Some(TextureRef::plain(picture));
    Ok(b.add_material(Material { emission_texture, ..Material::emissive("screen", Vec3::splat(1.6)) }))
}

fn parts(b: &mut SceneBuilder, surfaces: &Surfaces) -> Materials {
    Materials {
        stone: matte(b, "limestone", [0.66, 0.61, 0.53]),
        plaster: matte(b, "plaster", [0.80, 0.78, 0.73]),
        white: matte(b, "plinth white", [0.76, 0.74, 0.70]),
        wood: textured(b, "walnut", surfaces.wood, [0.7, 0.7], Vec3::new(0.75, 0.66, 0.58)),
        iron: matte(b, "wrought iron", [0.06, 0.06, 0.065]),
        gilt: matte(b, "gilt", [0.62, 0.44, 0.17]),
        bronze: matte(b, "bronze patina", [0.26, 0.23, 0.16]),
        jade: matte(b, "jade", [0.26, 0.48, 0.37]),
        black: matte(b, "black lacquer", [0.045, 0.045, 0.05]),
        cloth: matte(b, "red cloth", [0.46, 0.09, 0.08]),
        glass: b.add_material(Material::glass("vitrine glass", 1.5, Vec3::new(0.98, 0.995, 0.985))),
    }
}

fn walls(b: &mut SceneBuilder) -> [MaterialId; 6] {
    [
        ("wall sage", [0.62, 0.67, 0.57]),
        ("wall rose", [0.74, 0.47, 0.40]),
        ("wall blue-grey", [0.49, 0.57, 0.65]),
        ("wall straw", [0.78, 0.68, 0.49]),
        ("wall ivory", [0.79, 0.76, 0.69]),
        ("wall mint", [0.70, 0.75, 0.68]),
    ]
    .map(|(name, color)| matte(b, name, color))
}

fn floors(b: &mut SceneBuilder, s: &Surfaces) -> [MaterialId; 6] {
    let oak = textured(b, "oak floor", s.parquet, [0.5, 0.5], Vec3::splat(0.9));
    let walnut = textured(b, "walnut floor", s.parquet, [0.5, 0.5], Vec3::new(0.62, 0.52, 0.45));
    let varnished = varnished(b, "varnished walnut floor", walnut);
    let tiles = textured(b, "tile floor", s.tiles, [0.62, 0.62], Vec3::new(0.9, 0.88, 0.84));
    let marble = textured(b, "marble floor", s.marble, [0.8, 0.8], Vec3::new(0.66, 0.61, 0.53));
    [oak, varnished, walnut, oak, tiles, marble]
}

/// Adds a material again, under satin varnish.
fn varnished(b: &mut SceneBuilder, name: &str, base: MaterialId) -> MaterialId {
    let kind = MaterialKind::Glossy { reflectance: Vec3::splat(0.04), roughness: 0.25 };
    let material = Material { name: name.to_owned(), kind, ..b.materials[base.0 as usize].clone() };
    b.add_material(material)
}
