//! What the cases share: a room at any place and size, pictures of it, and what must hold of every picture.

use super::case::Measured;
use crate::camera::{Camera, View};
use crate::math::key::Key;
use crate::raster::color::ToneMap;
use crate::reference::ReferenceFrame;
use crate::render::aov::display_picture;
use crate::render::{Frame, FrameRequest, Mode, RenderSettings, Renderer};
pub(super) use crate::scene::shapes::{cuboid, quad, sphere as ball};
use crate::scene::{Material, SceneBuilder, SceneError, Sky};
use crate::trace::parallel::NEVER;
use crate::trace::{TraceSettings, Tracer};
use glam::{DVec3, Vec3};
use std::sync::Arc;

pub(super) const SIZE: [u32; 2] = [72, 48];
pub(super) const TRACE: TraceSettings = TraceSettings { samples: 2, bounces: 0, seed: 5 };

pub(super) fn dvec(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A room of 6 x 3 x 8 m with two boxes and a lamp.
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

    /// Looks into the room from its end.
    pub(super) fn camera(&self) -> Camera {
        Camera::look_at(self.at(0.25, 1.5, 3.5), self.at(-0.25, 1.25, -4.0), 65.0)
    }

    /// The same, so many metres of the room further and turned.
    pub(super) fn moved(&self, forward: f64, turn: f64) -> Camera {
        let camera = self.camera();
        let eye = camera.eye + camera.forward() * (forward * self.scale);
        Camera { eye, yaw: camera.yaw + turn, ..camera }
    }
}

pub(super) fn tracer(builder: SceneBuilder) -> Result<Tracer, SceneError> {
    Ok(Tracer::new(Arc::new(builder.finish()?)))
}

pub(super) fn view(tracer: &Tracer, camera: &Camera) -> View {
    View::new(camera, &tracer.scene().frame, SIZE)
}

/// A dense reference; tracing is never stopped here.
pub(super) fn reference(tracer: &Tracer, camera: &Camera, size: [u32; 2]) -> ReferenceFrame {
    ReferenceFrame::trace(tracer, camera, size, &TRACE, NEVER)
        .unwrap_or_else(|| unreachable!("nobody stops it"))
}

pub(super) fn full(tracer: &Tracer, camera: &Camera) -> Frame {
    picture(tracer, camera, SIZE, Mode::Full, &[])
}

pub(super) fn paper(tracer: &Tracer, camera: &Camera, references: &[&ReferenceFrame]) -> Frame {
    picture(tracer, camera, SIZE, Mode::Paper, references)
}

pub(super) fn picture(
    tracer: &Tracer,
    camera: &Camera,
    size: [u32; 2],
    mode: Mode,
    references: &[&ReferenceFrame],
) -> Frame {
    let mut renderer = Renderer::default();
    renderer.render(
        &FrameRequest::new(tracer, camera, size, &RenderSettings { mode, trace: TRACE }).warping(references),
    );
    renderer.into_frame()
}

/// Values that no picture may hold: negative, infinite or not a number.
pub(super) fn bad_values(frame: &Frame) -> usize {
    frame.radiance.iter().filter(|r| !(r.is_finite() && r.min_element() >= 0.0)).count()
}

/// Pixels whose radiance differs in a bit, and bad values of either.
pub(super) fn differing(a: &Frame, b: &Frame) -> usize {
    let differ = a.radiance.iter().zip(&b.radiance).filter(|(a, b)| a != b).count();
    differ + a.radiance.len().abs_diff(b.radiance.len()) + bad_values(a) + bad_values(b)
}

/// The share of pixels in percent that see another triangle.
pub(super) fn other_triangles_percent(a: &Frame, b: &Frame) -> f64 {
    percent(a.triangle.iter().zip(&b.triangle).filter(|(a, b)| a != b).count(), a.triangle.len())
}

/// The share of pixels in percent that are shown off by more than one of 255 steps.
pub(super) fn off_percent(a: &Frame, b: &Frame) -> f64 {
    let [a, b] = [a, b].map(srgb);
    let is_off = |(a, b): &(&[u8; 3], &[u8; 3])| a.iter().zip(b.iter()).any(|(a, b)| a.abs_diff(*b) > 1);
    percent(a.iter().zip(&b).filter(is_off).count(), a.len())
}

pub(super) fn percent(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}

pub(super) fn srgb(frame: &Frame) -> Vec<[u8; 3]> {
    display_picture(frame, 0.0, ToneMap::Aces)
}

/// The random vector of a number, each part in -1..1.
pub(super) fn random(key: Key, index: u32) -> Vec3 {
    let [x, y] = key.with(2 * index).pair();
    let [z, _] = key.with(2 * index + 1).pair();
    Vec3::new(x, y, z) * 2.0 - 1.0
}

/// Triangles strewn over a cube from -1 to 1.
pub(super) fn soup(count: u32, size: f32, seed: u64) -> Vec<[Vec3; 3]> {
    let triangle = |i| {
        let key = Key::of_pixel(seed, i);
        [1, 2, 3].map(|k| random(key, 0) + random(key, k) * size)
    };
    (0..count).map(triangle).collect()
}

/// In white light from everywhere nothing that is clear may be seen: the share of pixels in percent that are off by more
/// than 2 %, which is what cutting weak branches may cost.
pub(super) fn seen_in_white(mut b: SceneBuilder, camera: &Camera) -> Result<Measured, SceneError> {
    b.sky = Some(Sky { zenith: Vec3::ONE, horizon: Vec3::ONE, ground: Vec3::ONE });
    let frame = full(&tracer(b)?, camera);
    let off = |r: &Vec3| (*r - Vec3::ONE).abs().max_element();
    let seen = frame.radiance.iter().filter(|r| off(r) > 0.02).count() + bad_values(&frame);
    let worst = frame.radiance.iter().map(off).fold(0.0, f32::max);
    let note = format!("the worst pixel is off by {:.1} %", 100.0 * worst);
    Ok(Measured { value: percent(seen, frame.radiance.len()), note, picture: Some((SIZE, srgb(&frame))) })
}
