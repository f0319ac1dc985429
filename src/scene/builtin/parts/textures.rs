//! The textures of the program.

use crate::scene::{
    Encoding, Material, MaterialId, SceneBuilder, SceneError, Texture, TextureId, TextureRef,
};
use glam::{Vec2, Vec3};
use std::path::PathBuf;

/// A PNG file that is part of the program.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene::builtin) struct Asset {
    /// Name of the file without its ending.
    name: &'static str,
    /// Content of the file.
    png: &'static [u8],
}

pub(in crate::scene::builtin) const WOOD: Asset =
    Asset { name: "wood-planks", png: include_bytes!("../../../../assets/textures/wood-planks.png") };
pub(in crate::scene::builtin) const TILES: Asset =
    Asset { name: "stone-tiles", png: include_bytes!("../../../../assets/textures/stone-tiles.png") };
pub(in crate::scene::builtin) const MARBLE: Asset =
    Asset { name: "marble", png: include_bytes!("../../../../assets/textures/marble.png") };
pub(in crate::scene::builtin) const HARBOUR: Asset = Asset {
    name: "painting-harbour",
    png: include_bytes!("../../../../assets/textures/painting-harbour.png"),
};
pub(in crate::scene::builtin) const TIDE: Asset =
    Asset { name: "painting-tide", png: include_bytes!("../../../../assets/textures/painting-tide.png") };

/// Adds a diffuse material with a texture, whose coordinates are multiplied with `scale`.
pub(in crate::scene::builtin) fn textured(
    b: &mut SceneBuilder,
    name: &str,
    texture: TextureId,
    scale: [f32; 2],
    tint: Vec3,
) -> MaterialId {
    let map = TextureRef::new(texture, Vec2::from(scale), Vec2::ZERO);
    b.add_material(Material { diffuse_texture: Some(map), ..Material::diffuse(name, tint) })
}

/// Adds a texture of the program.
pub(in crate::scene::builtin) fn texture(
    b: &mut SceneBuilder,
    asset: &Asset,
) -> Result<TextureId, SceneError> {
    let Asset { name, png } = asset;
    let texture = decode(png).map_err(|e| SceneError::Read {
        file: PathBuf::from(format!("assets/textures/{name}.png")),
        cause: e.to_string(),
        remedy: "the file is part of the program; rebuild the program from a fresh checkout".to_owned(),
    })?;
    Ok(b.add_texture(texture))
}

fn decode(png: &[u8]) -> Result<Texture, png::DecodingError> {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(png));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::ALPHA);
    let mut reader = decoder.read_info()?;
    let [width, height] = [reader.info().width, reader.info().height];
    let mut texels = vec![[0; 4]; (width * height) as usize];
    reader.next_frame(bytemuck::cast_slice_mut(&mut texels))?;
    Ok(Texture { width, height, texels, encoding: Encoding::Srgb })
}
