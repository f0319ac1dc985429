//! Small scenes of known content.

use afterimage::camera::{CameraKey, CameraPath};
pub(crate) use afterimage::scene::shapes::quad;
use afterimage::scene::{Encoding, Material, MaterialId, Scene, SceneBuilder, Texture, TextureRef, shapes};
use afterimage::{Camera, Tracer};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// A vector of world coordinates.
pub(crate) fn dvec(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A closed box; `inside_out` turns its faces inwards.
pub(crate) fn cuboid(b: &mut SceneBuilder, low: DVec3, high: DVec3, material: MaterialId, inside_out: bool) {
    shapes::cuboid(b, [low, high], material, inside_out);
}

/// Optional contents of [`room`].
pub(crate) struct RoomOptions {
    pub(crate) mirror: bool,
    pub(crate) glass: bool,
}

/// A 6 x 3 x 8 m room with a few boxes and a lamp, and optionally a mirror on a wall and a block of
/// glass.
pub(crate) fn room(options: &RoomOptions) -> Scene {
    let mut b = SceneBuilder::new("test room");
    let wall = b.add_material(Material::diffuse("wall", Vec3::new(0.7, 0.65, 0.6)));
    let red = b.add_material(Material::diffuse("red", Vec3::new(0.6, 0.1, 0.1)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(8.0)));
    cuboid(&mut b, dvec(-3.0, 0.0, -4.0), dvec(3.0, 3.0, 4.0), wall, true);
    cuboid(&mut b, dvec(-1.5, 0.0, -2.0), dvec(-0.5, 1.2, -1.0), red, false);
    cuboid(&mut b, dvec(0.6, 0.0, -0.5), dvec(1.1, 2.0, 0.0), wall, false);
    quad(&mut b, dvec(-0.5, 2.9, -0.5), dvec(1.0, 0.0, 0.0), dvec(0.0, 0.0, 1.0), lamp);
    if options.mirror {
        let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(0.9)));
        quad(&mut b, dvec(-2.0, 0.5, -3.99), dvec(2.0, 0.0, 0.0), dvec(0.0, 1.8, 0.0), mirror);
    }
    if options.glass {
        let glass = b.add_material(Material::glass("glass", 1.5, Vec3::splat(0.98)));
        cuboid(&mut b, dvec(-0.4, 0.6, -1.0), dvec(0.2, 1.4, -0.6), glass, false);
    }
    b.finish().unwrap()
}

/// The tracer of [`room`].
pub(crate) fn room_tracer(mirror: bool, glass: bool) -> Tracer {
    Tracer::new(Arc::new(room(&RoomOptions { mirror, glass })))
}

/// A camera at the end of the room that looks along it.
pub(crate) fn room_camera() -> Camera {
    Camera::look_at(dvec(0.2, 1.5, 3.5), dvec(-0.2, 1.2, -4.0), 65.0)
}

/// Three sheets from which a texture cuts out leaves, without walls, under a lamp.
pub(crate) fn leafy_scene() -> Scene {
    let mut b = SceneBuilder::new("leaves");
    let texel = |i: u32| {
        let (x, y) = (i % 16, i / 16);
        let is_leaf = (x / 3 + y / 5) % 2 == 0 || (x * y) % 7 == 3;
        [90, (100 + 8 * x) as u8, 40, if is_leaf { 255 } else { 0 }]
    };
    let texels = (0..256).map(texel).collect();
    let texture = b.add_texture(Texture { width: 16, height: 16, texels, encoding: Encoding::Srgb });
    let map = Some(TextureRef::plain(texture));
    let leaf = Material { diffuse_texture: map, alpha_texture: map, ..Material::diffuse("leaf", Vec3::ONE) };
    let leaf = b.add_material(leaf);
    for (i, z) in [(0, 0.0), (1, -0.4), (2, -1.3)] {
        quad(&mut b, dvec(-1.5 + 0.2 * f64::from(i), 0.0, z), dvec(3.0, 0.0, 0.1), dvec(0.0, 2.2, 0.0), leaf);
    }
    b.point_lights.push((dvec(0.5, 1.8, 3.0), Vec3::splat(20.0)));
    let key = |x: f64, z: f64| CameraKey::new(dvec(x, 1.1, z), dvec(0.1, 1.0, 0.0));
    b.walk = Some(CameraPath { fov_y_deg: 60.0, frames: 300, keyframes: vec![key(0.0, 2.2), key(0.8, 1.5)] });
    b.finish().unwrap()
}
