//! Orthographic pictures: plans and elevations, whose rays are parallel.
//!
//! Parallel rays have no common eye, so that no pinhole view, no warp and no look-up applies to
//! them: every pixel is traced in full.

use super::accumulate::offset_of_pass;
use super::panorama::{PanoramaBand, PanoramaStats, traced};
use crate::camera::{Camera, SceneFrame, View};
use crate::trace::{RayCounts, TraceSettings, Tracer, parallel::Stop};
use glam::{DMat3, DVec3, Vec3};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// A picture by parallel rays.
#[derive(Clone, Copy, Debug)]
pub struct OrthographicPicture<'a> {
    /// The scene, ready to be traced.
    pub tracer: &'a Tracer,
    /// The middle of the plane at which the rays start, and their direction. What lies behind it is
    /// not shown.
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Width of what the picture shows, metres.
    pub width_m: f64,
    /// Samples, bounces and seed.
    pub trace: &'a TraceSettings,
    /// Points of each pixel that are sampled, at least one.
    pub points: u32,
}

impl OrthographicPicture<'_> {
    /// Renders all rows and hands them to `write`, band by band from the top. A stop ends the work
    /// after a band. `report` is called from several threads with the finished part, 0..1.
    ///
    /// # Errors
    /// The first error of `write`.
    pub fn render<E>(
        &self,
        stop: Stop<'_>,
        report: &(dyn Fn(f64) + Sync),
        write: &mut dyn FnMut(PanoramaBand) -> Result<(), E>,
    ) -> Result<PanoramaStats, E> {
        let (start, mut stats) = (Instant::now(), PanoramaStats::default());
        let (done, pixels) = (AtomicU64::new(0), self.size.map(u64::from).iter().product::<u64>().max(1));
        let note = |more| {
            let done = done.fetch_add(more, Ordering::Relaxed) + more;
            report(done as f64 / pixels as f64);
        };
        let mut bands = traced::traced_bands(self.size);
        stats.is_complete = loop {
            let Some(rows) = bands.next() else { break true };
            let radiance_of = |pixel, rays: &mut RayCounts| self.pixel(pixel, rays);
            let band = traced::trace_rows(self.size[0], rows, radiance_of, stop, &note);
            let Some(band) = band else { break false };
            stats.rays += band.rays;
            write(band)?;
        };
        stats.secs = start.elapsed().as_secs_f64();
        Ok(stats)
    }

    /// The mean radiance of a pixel's points. Points and seeds are those of the passes over a
    /// perspective picture.
    fn pixel(&self, pixel: u32, rays: &mut RayCounts) -> Vec3 {
        let count = self.points.max(1);
        let mut sum = Vec3::ZERO;
        for number in 0..count {
            let view = self.view_of(&self.tracer.scene().frame, pixel, offset_of_pass(number, count));
            let seed = self.trace.seed.wrapping_add(u64::from(number) << 48);
            sum += self.tracer.pixel(&view, pixel, &TraceSettings { seed, ..*self.trace }, rays).radiance;
        }
        sum / count as f32
    }

    /// A view whose ray through the centre of `pixel`, a row-major index, is that of the picture,
    /// moved by `offset` pixels: each pixel has an eye of its own. Only this pixel of it means
    /// anything.
    fn view_of(&self, frame: &SceneFrame, pixel: u32, offset: [f64; 2]) -> View {
        let [width, height] = self.size.map(|side| side.max(1));
        let (x, y) = (f64::from(pixel % width) + 0.5, f64::from(pixel / width) + 0.5);
        let axes = self.camera.world_from_camera();
        let (right, down, forward) = (axes.x_axis, -axes.y_axis, -axes.z_axis);
        let step_m = self.width_m / f64::from(width);
        let across = (x + offset[0] - f64::from(width) / 2.0) * step_m;
        let below = (y + offset[1] - f64::from(height) / 2.0) * step_m;
        let eye_f64 = frame.scene_from_world_f64(self.camera.eye + right * across + down * below);
        // The spread of a pinhole picture of 60 degrees: it is not seen in traced pixels.
        let step = 1.0 / f64::from(width);
        let matrix = DMat3::from_cols(right * step, down * step, forward - (right * x + down * y) * step);
        View {
            size: [width, height],
            eye: eye_f64.as_vec3(),
            eye_f64,
            scene_from_camera: DMat3::from_cols(right, down, forward).as_mat3(),
            scene_from_pixel: matrix.as_mat3(),
            scene_from_pixel_f64: matrix,
            tan_half_fov_y: (step * f64::from(height) / 2.0) as f32,
        }
    }
}

/// The width in metres at which a picture of `size` pixels shows all of a box in world metres, with
/// a rim of a twentieth.
pub fn fitting_width_m(camera: &Camera, size: [u32; 2], [low, high]: [DVec3; 2]) -> f64 {
    let axes = camera.world_from_camera();
    let reach = |axis: DVec3| {
        let corners = (0..8).map(|i| {
            let pick = |bit: u32, axis: usize| if i >> bit & 1 == 0 { low[axis] } else { high[axis] };
            DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2)) - camera.eye
        });
        corners.map(|corner| corner.dot(axis).abs()).fold(0.0, f64::max)
    };
    let aspect = f64::from(size[0].max(1)) / f64::from(size[1].max(1));
    2.0 * 1.05 * reach(axes.x_axis).max(reach(axes.y_axis) * aspect)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;
    use crate::trace::parallel::NEVER;
    use std::convert::Infallible;
    use std::sync::Arc;

    /// Equal lengths are equally many pixels at any depth: a closed room of 4 m that glows fills
    /// half of a picture of 8 m from the inside, and all of one of 4 m.
    #[test]
    fn parallel_rays_show_lengths_at_scale() {
        let tracer = Tracer::new(Arc::new(builtin::build("furnace").unwrap()));
        let trace = TraceSettings { samples: 1, bounces: 0, seed: 1 };
        for (yaw, pitch) in
            [(0.0, 0.0), (std::f64::consts::FRAC_PI_2, 0.0), (0.0, -std::f64::consts::FRAC_PI_2)]
        {
            let camera = Camera { yaw, pitch, ..*tracer.scene().start() };
            let lit = |width_m: f64| {
                let size = [40, 20];
                let picture = OrthographicPicture {
                    tracer: &tracer,
                    camera: &camera,
                    size,
                    width_m,
                    trace: &trace,
                    points: 1,
                };
                let mut lit = Vec::new();
                let stats = picture.render(NEVER, &|_| (), &mut |band| {
                    lit.extend(band.radiance.iter().map(|radiance| radiance.x > 0.5));
                    Ok::<(), Infallible>(())
                });
                assert!(stats.unwrap().is_complete);
                lit.chunks(40).map(|row| row.iter().filter(|is_lit| **is_lit).count()).collect::<Vec<_>>()
            };
            assert_eq!(lit(8.0), [20; 20], "{yaw} {pitch}");
            assert_eq!(
                lit(16.0)[4..16],
                [[0; 1].as_slice(), [10; 10].as_slice(), [0; 1].as_slice()].concat()
            );
            assert_eq!(lit(4.0), [40; 20]);
        }
    }

    #[test]
    fn a_fitting_width_shows_the_whole_box() {
        let camera = Camera::look_at(DVec3::new(0.0, 10.0, 0.0), DVec3::ZERO, 60.0);
        let width =
            fitting_width_m(&camera, [200, 100], [DVec3::new(-1.0, 0.0, -3.0), DVec3::new(2.0, 3.0, 3.0)]);
        assert!((width - 2.1 * 6.0).abs() < 1e-9, "{width}");
    }
}
