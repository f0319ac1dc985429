//! Cases D of the catalogue that concern surfaces that vary by picture: normal maps of garbage,
//! relief at grazing views, and roughness, metal and transmission by picture.

use super::case::{Case, Outcome, Trial, case};
use super::pictures::{bad_values, exact, full};
use super::rooms::{Room, tracer};
use crate::camera::Camera;
use crate::experiment::run::ExperimentError;
use crate::math::key::Key;
use crate::scene::{
    Detail, Encoding, Material, MaterialKind, NormalMap, SceneBuilder, Texture, TextureId, TextureRef,
};
use glam::{Vec2, Vec3};

pub(super) const CASES: &[Case] = &[
    case("D17 normal maps of zeros, noise and directions inward", "bad values, full and exact", 0.0, garbage),
    case("D17 normal maps on texture coordinates without area", "bad values, full and exact", 0.0, no_area),
    case("D18 relief at grazing views", "bad values, full and exact", 0.0, grazing),
    case("D19 roughness 0 to 1 and metal by picture", "bad values, full and exact", 0.0, by_picture),
    case("D19 glass that transmits by picture", "bad values, full and exact", 0.0, in_part),
];

/// Strengths of normal maps, sane and not.
const STRENGTHS: [f32; 6] = [1.0, -1.0, 1e9, f32::NAN, f32::INFINITY, 1e-30];

fn add(b: &mut SceneBuilder, side: u32, texel: impl FnMut(u32) -> [u8; 4]) -> TextureId {
    let texels = (0..side * side).map(texel).collect();
    b.add_texture(Texture { width: side, height: side, texels, encoding: Encoding::Linear })
}

fn noise(b: &mut SceneBuilder) -> TextureId {
    add(b, 16, |i| {
        let [[x, y], [z, _]] = [0, 1].map(|n| Key::of_pixel(7, i).with(n).pair());
        [x, y, z, 1.0].map(|part| (part * 255.0) as u8)
    })
}

fn normal(texture: TextureId, scale: Vec2, strength: f32) -> Option<NormalMap> {
    Some(NormalMap { texture: TextureRef::new(texture, scale, Vec2::ZERO), strength })
}

fn glossy(roughness: f32) -> MaterialKind {
    MaterialKind::Glossy { reflectance: Vec3::splat(0.04), roughness }
}

/// Bad values in both modes, along the floor, a thousandth of its length above it, and from the
/// usual view.
fn bad(b: SceneBuilder) -> Result<usize, ExperimentError> {
    let (tracer, room) = (tracer(b)?, Room::PLAIN);
    let low = |x: f64| Camera::look_at(room.at(x, 0.005, 3.9), room.at(0.0, 0.0, -3.0), 60.0);
    let views = [[low(0.0), low(0.1)], [room.camera(), low(0.0)]];
    let found = views.map(|[now, before]| {
        bad_values(&full(&tracer, &now)) + bad_values(&exact(&tracer, &before, &now, 0.0))
    });
    Ok(found.iter().sum())
}

fn garbage(_: &Trial) -> Outcome {
    let mut found = 0;
    for strength in STRENGTHS {
        for texel in [[128; 4], [0; 4], [255, 255, 0, 255], [128, 128, 0, 255], [255, 128, 128, 255]] {
            let mut b = Room::PLAIN.builder();
            let texture = add(&mut b, 1, |_| texel);
            b.materials[0].detail.normal = normal(texture, Vec2::ONE, strength);
            found += bad(b)?;
        }
    }
    Ok(found.into())
}

fn no_area(_: &Trial) -> Outcome {
    let mut found = 0;
    for scale in [Vec2::ZERO, Vec2::new(1.0, 0.0), Vec2::splat(1e-38), Vec2::splat(1e30), Vec2::NAN] {
        for kind in [MaterialKind::Diffuse, glossy(0.3)] {
            let mut b = Room::PLAIN.builder();
            let texture = noise(&mut b);
            b.materials[0].detail.normal = normal(texture, scale, 1.0);
            b.materials[0].kind = kind;
            found += bad(b)?;
        }
    }
    Ok(found.into())
}

fn grazing(_: &Trial) -> Outcome {
    let mut found = 0;
    for kind in [MaterialKind::Diffuse, glossy(0.0), glossy(0.1), glossy(1.0)] {
        let mut b = Room::SHINY.builder();
        let texture = noise(&mut b);
        for material in &mut b.materials {
            material.detail.normal = normal(texture, Vec2::splat(3.0), 4.0);
        }
        b.materials[0].kind = kind;
        found += bad(b)?;
    }
    Ok(found.into())
}

fn by_picture(_: &Trial) -> Outcome {
    let mut found = 0;
    for metalness in [0.0, 0.5, 1.0, f32::NAN, 1e9] {
        let mut b = Room::PLAIN.builder();
        let map = Some(TextureRef::plain(noise(&mut b)));
        let detail =
            Detail { metalness, metalness_texture: map, roughness_texture: map, ..Detail::default() };
        b.materials[0] = Material { kind: glossy(1.0), detail, ..Material::diffuse("wall", Vec3::ONE) };
        found += bad(b)?;
    }
    Ok(found.into())
}

fn in_part(_: &Trial) -> Outcome {
    let (eta, transmittance, mut found) = (1.5, Vec3::ONE, 0);
    let clear = MaterialKind::Glass { eta, transmittance };
    let frosted = |roughness: f32| MaterialKind::Frosted { eta, transmittance, roughness };
    for kind in [clear, frosted(0.2), frosted(1.0)] {
        for transmission in [1.0, 0.3, f32::NAN] {
            let mut b = Room::PLAIN.builder();
            let transmission_texture = Some(TextureRef::plain(noise(&mut b)));
            let detail = Detail { transmission, transmission_texture, ..Detail::default() };
            b.materials[1] = Material { kind, detail, ..Material::diffuse("box", Vec3::ONE) };
            found += bad(b)?;
        }
    }
    Ok(found.into())
}
