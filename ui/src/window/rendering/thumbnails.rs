//! Small pictures of views and references, traced one at a time while the renderer is idle.

use super::{Task, TaskError, TaskHandle, Wake, background_pool, spawn_task, take_result};
use afterimage::raster::color::{ToneMap, srgb8};
use afterimage::reference::{ReferenceCache, ReferenceFrame};
use afterimage::render::schedule::WINDOW_SAMPLES;
use afterimage::trace::{TraceSettings, parallel::Stop};
use afterimage::{Camera, FrameRequest, Mode, RenderSettings, Renderer, Tracer};
use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use glam::Vec3;
use std::collections::HashMap;
use std::sync::Arc;

/// Width and height of a thumbnail in pixels.
pub const SIZE: [u32; 2] = [96, 60];

/// As the first picture of a view has it: few samples, which neighbours share.
const TRACE: TraceSettings =
    TraceSettings { samples: WINDOW_SAMPLES, bounces: TraceSettings::ALL_BOUNCES, seed: 0 };

/// Number of pictures at which all are dropped: more than the references of a day.
const MAX_PICTURES: usize = 512;

/// Bits of the pose of a picture.
type Pose = [u64; 7];

fn pose(camera: &Camera) -> Pose {
    let Camera { eye, yaw, pitch, fov_y, roll } = *camera;
    [eye.x, eye.y, eye.z, yaw, pitch, fov_y, roll].map(f64::to_bits)
}

/// All small pictures of the scene that is shown.
#[derive(Default)]
pub struct Thumbnails {
    tracer: Option<Arc<Tracer>>,
    /// Pose of the picture that is being traced.
    pending: Pose,
    task: Option<Task<ColorImage>>,
    /// `None` until the picture is traced, and for good where that failed.
    textures: HashMap<Pose, Option<TextureHandle>>,
}

impl std::fmt::Debug for Thumbnails {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Thumbnails").field("count", &self.textures.len()).finish_non_exhaustive()
    }
}

impl Thumbnails {
    /// Changes to another scene, or to the same scene with other materials or light; all pictures
    /// are dropped.
    pub fn set_tracer(&mut self, tracer: Arc<Tracer>) {
        *self = Self { tracer: Some(tracer), ..Self::default() };
    }

    /// Returns the picture of a pose, once it is traced.
    pub fn of(&self, camera: &Camera) -> Option<&TextureHandle> {
        self.textures.get(&pose(camera))?.as_ref()
    }

    /// Takes over a picture that was traced. One that failed stays grey: the render thread reports
    /// what is wrong with the scene.
    pub fn poll(&mut self, ctx: &Context) {
        if let Some(Ok(image)) = take_result(&mut self.task) {
            let texture = ctx.load_texture("thumbnail", image, TextureOptions::LINEAR);
            self.textures.insert(self.pending, Some(texture));
        }
    }

    /// Starts to trace the first of these poses that has no picture yet, unless one is being
    /// traced. It has the exposure of the scene or, while that is not known, the given one, in
    /// stops.
    pub fn request<'a>(
        &mut self,
        mut poses: impl Iterator<Item = &'a Camera>,
        exposure_ev: f32,
        wake: &Wake,
    ) {
        let (Some(tracer), None) = (&self.tracer, &self.task) else { return };
        let exposure_ev = tracer.stops(tracer.scene().exposure).unwrap_or(exposure_ev);
        let Some(camera) = poses.find(|camera| !self.textures.contains_key(&pose(camera))) else { return };
        if self.textures.len() >= MAX_PICTURES {
            self.textures.clear();
        }
        self.pending = pose(camera);
        self.textures.insert(self.pending, None);
        let (tracer, camera) = (tracer.clone(), *camera);
        self.task = Some(spawn_task("thumbnails", wake.clone(), move |task| {
            trace(&tracer, &camera, exposure_ev, task)
        }));
    }
}

/// Traces a picture at an exposure in stops.
fn trace(
    tracer: &Tracer,
    camera: &Camera,
    exposure_ev: f32,
    task: &TaskHandle,
) -> Result<ColorImage, TaskError> {
    let pool = background_pool("thumbnails", 1).map_err(TaskError::failed)?;
    let radiance = pool.install(|| radiance(tracer, camera, &|| task.is_cancelled()));
    let radiance = radiance.ok_or(TaskError::Cancelled)?;
    let rgb = radiance.iter().flat_map(|&c| srgb8(c, exposure_ev, ToneMap::default()));
    Ok(ColorImage::from_rgb(SIZE.map(|s| s as usize), &rgb.collect::<Vec<u8>>()))
}

/// The radiance of a picture, whose light is that of a reference of the view: without a filter, so
/// few samples would show noise. `None` after a stop.
fn radiance(tracer: &Tracer, camera: &Camera, stop: Stop<'_>) -> Option<Vec<Vec3>> {
    let reference = ReferenceFrame::trace_filtered(tracer, camera, SIZE, &TRACE, stop)?;
    let mut references = ReferenceCache::new(tracer.scene(), reference.bytes());
    references.insert(Arc::new(reference));
    let settings = RenderSettings { mode: Mode::Exact, trace: TRACE };
    let request = FrameRequest::new(tracer, camera, SIZE, &settings).reusing(&references).with_stop(stop);
    let mut renderer = Renderer::default();
    renderer.render(&request);
    let frame = renderer.into_frame();
    frame.stats.is_complete.then_some(frame.radiance)
}
