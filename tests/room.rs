//! A small room of our own: white walls, a mirror, one lamp, and a walk through it.

use afterimage::camera_path::{CameraKey, CameraPath};
use afterimage::scene::{Material, MaterialId, SceneBuilder};
use afterimage::{Scene, Tracer};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// 4 m wide, 3 m high, 8 m long; the walk goes 2 m along it.
pub(crate) fn scene() -> Scene {
    let mut b = SceneBuilder::new("room");
    let wall = b.add_material(Material::diffuse("wall", Vec3::new(0.7, 0.6, 0.5)));
    let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(0.8)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(8.0)));
    let mut quad = |corners: [[f64; 3]; 4], material: MaterialId| {
        b.add_quad(corners.map(DVec3::from_array), Vec2::ONE, material);
    };
    let (x, y, z) = (2.0, 3.0, 4.0);
    quad([[-x, 0.0, z], [x, 0.0, z], [x, 0.0, -z], [-x, 0.0, -z]], wall);
    quad([[-x, y, -z], [x, y, -z], [x, y, z], [-x, y, z]], wall);
    quad([[-x, 0.0, -z], [x, 0.0, -z], [x, y, -z], [-x, y, -z]], wall);
    quad([[x, 0.0, z], [-x, 0.0, z], [-x, y, z], [x, y, z]], wall);
    quad([[-x, 0.0, z], [-x, 0.0, -z], [-x, y, -z], [-x, y, z]], wall);
    quad([[x, 0.0, -z], [x, 0.0, z], [x, y, z], [x, y, -z]], wall);
    quad([[1.9, 0.5, -2.0], [1.9, 0.5, 1.0], [1.9, 2.5, 1.0], [1.9, 2.5, -2.0]], mirror);
    quad([[-0.5, 2.9, -1.0], [0.5, 2.9, -1.0], [0.5, 2.9, 0.0], [-0.5, 2.9, 0.0]], lamp);
    let key = |z: f64| CameraKey { eye: DVec3::new(0.0, 1.6, z), at: DVec3::new(0.4, 1.4, z - 3.0) };
    b.walk = Some(CameraPath { fov_y_deg: 60.0, frames: 12, keyframes: vec![key(3.0), key(1.0)] });
    b.finish().unwrap()
}

/// The room, ready for rays.
pub(crate) fn tracer() -> Arc<Tracer> {
    Arc::new(Tracer::new(Arc::new(scene())))
}
