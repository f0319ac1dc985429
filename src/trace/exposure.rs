//! The automatic exposure: from the light in the scene, measured by a fixed set of rays.

use super::{RayCounts, TraceSettings, Tracer, parallel::Stop};
use crate::camera::{Camera, View};
use crate::raster::{
    color::luminance,
    exposure::{Exposure, Metered},
};
use glam::Vec3;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Side of a square of rays whose mean is one measurement, in rays. Of 256 paths, enough find the
/// windows of a living room: its exposure is within 0.2 stops of that with 64 times as many rays.
const SQUARE: u32 = 16;

/// Squares of each of the four pictures around the start view, horizontally and vertically. They
/// are as many as those of all other places together.
const START_SQUARES: [u32; 2] = [4, 3];

/// Largest number of other places. A longer walk is thinned evenly.
const MAX_OTHERS: usize = 12;

/// Vertical field of view of a picture in degrees.
const FOV_Y_DEG: f64 = 65.0;

/// Settings of the rays, whatever those of the exposed pictures are. Four bounces bring most of the
/// light of a room.
const TRACE: TraceSettings = TraceSettings { samples: 1, bounces: 4, seed: 0x6c69_6768_7400_0000 };

/// Smallest share of rays that must meet a surface that scatters light diffusely.
const MIN_SURFACES: f64 = 1.0 / 16.0;

/// Sums over the rays of a square.
#[derive(Clone, Copy, Debug, Default)]
struct Square {
    surfaces: f64,
    light: f64,
    luminance: f64,
    /// Luminance of all rays, whatever they meet.
    seen: f64,
}

impl Tracer {
    /// The exposure that suits the light in the scene, once [`Self::measure_light`] has found it.
    pub fn metered(&self) -> Option<Metered> {
        self.metered.get().copied()
    }

    /// Measures the light in the scene, unless that is done. False after a stop.
    ///
    /// The exposure that follows is a function of the scene alone: the same at any number of
    /// threads and for all settings of pictures. At most 25,000 paths go out from places where one
    /// can be: the start view, and the views and the key frames of the walk that the model brings,
    /// in four directions each. Surfaces that emit, mirrors and glass, and a ground that was added,
    /// count only where there is nothing else. `progress` receives the share that is done, 0..1.
    pub fn measure_light(&self, progress: &(dyn Fn(f32) + Sync), stop: Stop<'_>) -> bool {
        // Not `get_or_init`, which would wait on itself where a thread of rayon steals a job that
        // calls this.
        if self.metered().is_none() {
            let Some(metered) = self.meter(progress, stop) else { return false };
            let _ = self.metered.set(metered);
        }
        true
    }

    /// Returns the number of stops of an exposure; `None` for the automatic one of a scene whose
    /// light is not measured yet.
    pub fn stops(&self, exposure: Exposure) -> Option<f32> {
        exposure.stops().or_else(|| self.metered().map(Metered::ev))
    }

    /// Traces all squares. `None` after a stop.
    fn meter(&self, progress: &(dyn Fn(f32) + Sync), stop: Stop<'_>) -> Option<Metered> {
        let (planned, done) = (self.squares_to_meter(), AtomicUsize::new(0));
        let measured = planned.par_iter().map(|(view, seed, corner)| {
            let square = self.square(view, *seed, *corner, stop);
            progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / planned.len() as f32);
            square
        });
        let squares = measured.collect::<Option<Vec<Square>>>()?;
        let all_rays = f64::from(SQUARE * SQUARE);
        let counted = || squares.iter().filter(|s| s.surfaces >= MIN_SURFACES * all_rays);
        if counted().next().is_none() {
            // Everything emits, reflects like a mirror, or is sky.
            let seen = || squares.iter().map(|s| s.seen / all_rays).collect();
            return Some(Metered::of(seen(), seen()));
        }
        let mean = |sum: fn(&Square) -> f64| counted().map(|s| sum(s) / s.surfaces).collect();
        Some(Metered::of(mean(|s| s.light), mean(|s| s.luminance)))
    }

    /// Returns the squares of four pictures around each place: the picture, the seed of its random
    /// numbers, and the column and row of the upper left ray.
    fn squares_to_meter(&self) -> Vec<(View, u64, [u32; 2])> {
        let scene = self.scene();
        let views = scene.views[1..].iter().filter(|_| scene.brings_view).map(|v| v.camera);
        let keys = scene.walk.keyframes.iter().filter(|_| scene.brings_walk);
        let others: Vec<Camera> =
            views.chain(keys.map(|key| Camera::look_at(key.eye, key.at, FOV_Y_DEG))).collect();
        let count = others.len().min(MAX_OTHERS);
        let places = std::iter::once((*scene.start(), START_SQUARES))
            .chain((0..count).map(|i| (others[i * others.len() / count], [1, 1])));
        let pictures = places.flat_map(|(camera, squares)| {
            (0..4).map(move |turn| {
                let pitch = if turn == 0 { camera.pitch } else { 0.0 };
                let yaw = camera.yaw + f64::from(turn) * FRAC_PI_2;
                (Camera { yaw, pitch, fov_y: FOV_Y_DEG.to_radians(), ..camera }, squares)
            })
        });
        let split = |(number, (camera, [columns, rows])): (u64, (Camera, [u32; 2]))| {
            let view = View::new(&camera, &scene.frame, [columns * SQUARE, rows * SQUARE]);
            let corners = (0..columns * rows).map(move |i| [i % columns * SQUARE, i / columns * SQUARE]);
            corners.map(move |corner| (view, TRACE.seed + number, corner))
        };
        (0..).zip(pictures).flat_map(split).collect()
    }

    /// Traces the rays of a square. `None` after a stop.
    fn square(&self, view: &View, seed: u64, [left, top]: [u32; 2], stop: Stop<'_>) -> Option<Square> {
        let (settings, mut sums) = (TraceSettings { seed, ..TRACE }, Square::default());
        for ray in 0..SQUARE * SQUARE {
            if stop() {
                return None;
            }
            let pixel = (top + ray / SQUARE) * view.size[0] + left + ray % SQUARE;
            let traced = self.pixel(view, pixel, &settings, &mut RayCounts::default());
            sums.seen += f64::from(luminance(traced.radiance));
            let scatters = traced.hit.is_some_and(|hit| {
                let albedo = self.albedo(&hit, view.direction_of_pixel(pixel));
                let scene = self.scene();
                let is_model = !scene.is_added_ground(hit.triangle);
                is_model && !scene.material_of(hit.triangle).is_emissive() && albedo != Vec3::ZERO
            });
            if scatters {
                sums.surfaces += 1.0;
                sums.light += f64::from(luminance(traced.light.total()));
                sums.luminance += f64::from(luminance(traced.radiance));
            }
        }
        Some(sums)
    }
}
