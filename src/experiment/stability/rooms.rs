//! Scenes that the cases share: random triangles, and a room of any size at any place.

use crate::camera::Camera;
use crate::experiment::run::ExperimentError;
use crate::import::{ImportOptions, load};
use crate::math::key::Key;
pub(super) use crate::scene::shapes::{cuboid, quad, sphere as ball};
use crate::scene::{Material, MaterialId, Scene, SceneBuilder, SceneError};
use crate::trace::{NO_TRIANGLE, Tracer};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

pub(super) fn dvec(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Adds a triangle without normals; its corners may be invalid.
pub(super) fn triangle(b: &mut SceneBuilder, corners: [DVec3; 3], material: MaterialId) {
    let vertices = corners.map(|p| b.add_vertex(p, Vec3::ZERO, Vec2::ZERO));
    b.add_triangle(vertices, material);
}

/// Adds a quad in a plane of constant z that faces +z: its lower left corner, width and height.
pub(super) fn wall(b: &mut SceneBuilder, corner: DVec3, [width, height]: [f64; 2], material: MaterialId) {
    quad(b, corner, DVec3::X * width, DVec3::Y * height, material);
}

/// A room of 6 x 3 x 8 m, before scaling, with two boxes and a lamp.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    pub(super) scale: f64,
    pub(super) shift: DVec3,
    pub(super) has_mirror: bool,
    pub(super) has_glass: bool,
}

impl Room {
    pub(super) const PLAIN: Self =
        Self { scale: 1.0, shift: DVec3::ZERO, has_mirror: false, has_glass: false };
    pub(super) const SHINY: Self = Self { has_mirror: true, has_glass: true, ..Self::PLAIN };

    pub(super) fn at(&self, x: f64, y: f64, z: f64) -> DVec3 {
        dvec(x, y, z) * self.scale + self.shift
    }

    pub(super) fn builder(&self) -> SceneBuilder {
        let mut b = SceneBuilder::new("room");
        let wall = b.add_material(Material::diffuse("wall", Vec3::new(0.7, 0.65, 0.6)));
        let red = b.add_material(Material::diffuse("red", Vec3::new(0.6, 0.1, 0.1)));
        let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(8.0)));
        let along = |x: f64, y: f64, z: f64| dvec(x, y, z) * self.scale;
        cuboid(&mut b, [self.at(-3.0, 0.0, -4.0), self.at(3.0, 3.0, 4.0)], wall, true);
        cuboid(&mut b, [self.at(-1.5, 0.0, -2.0), self.at(-0.5, 1.25, -1.0)], red, false);
        cuboid(&mut b, [self.at(0.625, 0.0, -0.5), self.at(1.125, 2.0, 0.0)], wall, false);
        quad(&mut b, self.at(-0.5, 2.875, -0.5), along(1.0, 0.0, 0.0), along(0.0, 0.0, 1.0), lamp);
        b.point_lights.push((self.at(1.5, 2.0, 2.0), Vec3::splat(2.0) * (self.scale * self.scale) as f32));
        if self.has_mirror {
            let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(0.9)));
            quad(&mut b, self.at(-2.0, 0.5, -3.875), along(2.0, 0.0, 0.0), along(0.0, 1.75, 0.0), mirror);
        }
        if self.has_glass {
            let glass = b.add_material(Material::glass("glass", 1.5, Vec3::splat(0.98)));
            cuboid(&mut b, [self.at(-0.375, 0.625, -1.0), self.at(0.25, 1.375, -0.625)], glass, false);
        }
        b
    }

    pub(super) fn tracer(&self) -> Result<Tracer, SceneError> {
        tracer(self.builder())
    }

    /// Returns the camera that looks into the room from its end.
    pub(super) fn camera(&self) -> Camera {
        Camera::look_at(self.at(0.25, 1.5, 3.5), self.at(-0.25, 1.25, -4.0), 65.0)
    }

    /// Returns that camera moved forward, in metres before scaling, and turned, in radians.
    pub(super) fn moved(&self, forward: f64, turn: f64) -> Camera {
        let camera = self.camera();
        let eye = camera.eye + camera.forward() * (forward * self.scale);
        Camera { eye, yaw: camera.yaw + turn, ..camera }
    }

    /// Returns the tracer and the camera of [`Self::camera`].
    pub(super) fn stage(&self) -> Result<(Tracer, Camera), SceneError> {
        Ok((self.tracer()?, self.camera()))
    }
}

pub(super) fn tracer(builder: SceneBuilder) -> Result<Tracer, SceneError> {
    Ok(Tracer::new(Arc::new(builder.finish()?)))
}

/// Returns true if a triangle has a material of this name; the sky has none.
pub(super) fn is_named(tracer: &Tracer, triangle: u32, name: &str) -> bool {
    triangle != NO_TRIANGLE && tracer.scene().material_of(triangle).name == name
}

/// Makes a folder that is deleted with the returned value.
pub(super) fn temporary_folder() -> Result<tempfile::TempDir, ExperimentError> {
    tempfile::tempdir()
        .map_err(|e| ExperimentError::Unsuitable(format!("cannot make a temporary folder: {e}")))
}

/// Imports a model from text; the first file is the model.
pub(super) fn imported(files: &[(&str, &str)]) -> Result<Scene, ExperimentError> {
    let folder = temporary_folder()?;
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::write(&path, text).map_err(|e| ExperimentError::at(&path, e))?;
    }
    Ok(load(&folder.path().join(files[0].0), &ImportOptions::default(), &|_, _| true)?)
}

/// Returns the random vector of a number, each component in -1..1.
pub(super) fn random(key: Key, index: u32) -> Vec3 {
    let [x, y] = key.with(2 * index).pair();
    let [z, _] = key.with(2 * index + 1).pair();
    Vec3::new(x, y, z) * 2.0 - 1.0
}

/// Returns random triangles in a cube from -1 to 1.
pub(super) fn soup(count: u32, size: f32, seed: u64) -> Vec<[Vec3; 3]> {
    let triangle = |i| {
        let key = Key::of_pixel(seed, i);
        [1, 2, 3].map(|k| random(key, 0) + random(key, k) * size)
    };
    (0..count).map(triangle).collect()
}
