//! Small pictures of views and references, traced one at a time while the renderer is idle.

use super::{Task, TaskError, TaskHandle, Wake, background_pool, spawn_task, take_result};
use afterimage::raster::color::{ToneMap, srgb8};
use afterimage::trace::TraceSettings;
use afterimage::{Camera, FrameRequest, Mode, RenderSettings, Renderer, Tracer};
use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use std::collections::HashMap;
use std::sync::Arc;

/// Width and height of a thumbnail in pixels.
pub const SIZE: [u32; 2] = [96, 60];

/// One sample and one bounce: rooms that no lamp reaches are dark without a bounce.
const TRACE: TraceSettings = TraceSettings { samples: 1, bounces: 1, seed: 0 };

/// Number of pictures at which all are dropped: more than the references of a day.
const MAX_PICTURES: usize = 512;

/// Bits of the pose of a picture.
type Pose = [u64; 6];

fn pose(camera: &Camera) -> Pose {
    let Camera { eye, yaw, pitch, fov_y } = *camera;
    [eye.x, eye.y, eye.z, yaw, pitch, fov_y].map(f64::to_bits)
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
    let settings = RenderSettings { mode: Mode::Full, trace: TRACE };
    let mut renderer = Renderer::default();
    let stop = || task.is_cancelled();
    let request = FrameRequest::new(tracer, camera, SIZE, &settings).with_stop(&stop);
    let frame = pool.install(|| renderer.render(&request));
    if !frame.stats.is_complete {
        return Err(TaskError::Cancelled);
    }
    let rgb = frame.radiance.iter().flat_map(|&c| srgb8(c, exposure_ev, ToneMap::default()));
    Ok(ColorImage::from_rgb(SIZE.map(|s| s as usize), &rgb.collect::<Vec<u8>>()))
}
