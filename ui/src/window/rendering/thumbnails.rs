//! Small pictures of views and references, traced on a thread of their own while nothing else is to be done.

use crate::window::rendering::exchange::locked;
use crate::window::rendering::render_thread::{Wake, give_way};
use afterimage::raster::color::{ToneMap, metered_exposure_ev, srgb8};
use afterimage::trace::{SceneEpoch, TraceSettings};
use afterimage::{Camera, FrameRequest, Mode, RenderSettings, Renderer, Tracer};
use crossbeam_channel::{Receiver, Sender, unbounded};
use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use std::collections::HashMap;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// Width and height in pixels.
pub const SIZE: [u32; 2] = [96, 60];

/// One to start with: rooms that no lamp reaches are dark without any.
const TRACE: TraceSettings = TraceSettings { samples: 1, bounces: 1, seed: 0 };

/// Pictures kept before all are dropped: a day of references.
const MOST: usize = 512;

/// The pose of a picture, bit for bit.
type Pose = [u64; 6];

fn pose(camera: &Camera) -> Pose {
    let Camera { eye, yaw, pitch, fov_y } = *camera;
    [eye.x, eye.y, eye.z, yaw, pitch, fov_y].map(f64::to_bits)
}

struct Made {
    pose: Pose,
    epoch: SceneEpoch,
    image: Option<ColorImage>,
}

/// The picture that is wanted next.
#[derive(Default)]
struct Wanted {
    cancel: AtomicBool,
    tracer: Mutex<Option<Arc<Tracer>>>,
}

/// All small pictures of the scene that is shown.
pub struct Thumbnails {
    wanted: Arc<Wanted>,
    jobs: Sender<Camera>,
    made: Receiver<Made>,
    epoch: Option<SceneEpoch>,
    /// `None` while it is traced, and for ever where that failed.
    textures: HashMap<Pose, Option<TextureHandle>>,
    is_busy: bool,
}

impl std::fmt::Debug for Thumbnails {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Thumbnails").field("count", &self.textures.len()).finish_non_exhaustive()
    }
}

impl Thumbnails {
    /// Starts the thread. It ends when this is dropped, after the picture it is at.
    ///
    /// # Errors
    /// Where the system gives no more threads.
    pub fn start(wake: Wake) -> io::Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .thread_name(|_| "thumbnails-0".to_owned())
            .start_handler(|_| give_way())
            .build()
            .map_err(io::Error::other)?;
        let wanted = Arc::new(Wanted::default());
        let ((jobs, asked), (sender, made)) = (unbounded(), unbounded());
        let shared = wanted.clone();
        let serve = move || {
            for camera in asked {
                // The window may be gone.
                let _ = sender.send(pool.install(|| make(&shared, &camera)));
                wake();
            }
        };
        std::thread::Builder::new().name("afterimage-thumbnails".to_owned()).spawn(serve)?;
        Ok(Self { wanted, jobs, made, epoch: None, textures: HashMap::new(), is_busy: false })
    }

    /// Another scene, or the same in another light: its pictures are made anew.
    pub fn set_tracer(&mut self, tracer: Arc<Tracer>) {
        self.epoch = Some(tracer.epoch());
        self.textures.clear();
        self.wanted.cancel.store(true, Ordering::Release);
        *locked(&self.wanted.tracer) = Some(tracer);
    }

    /// The picture of a pose, where it is there.
    pub fn of(&self, camera: &Camera) -> Option<&TextureHandle> {
        self.textures.get(&pose(camera))?.as_ref()
    }

    /// Takes in what was made.
    pub fn poll(&mut self, ctx: &Context) {
        for made in self.made.try_iter() {
            self.is_busy = false;
            if self.epoch == Some(made.epoch) {
                let load = |image| ctx.load_texture("thumbnail", image, TextureOptions::LINEAR);
                self.textures.insert(made.pose, made.image.map(load));
            } else {
                self.textures.remove(&made.pose);
            }
        }
    }

    /// Has the first of these poses made that has no picture yet, one at a time.
    pub fn want<'a>(&mut self, mut poses: impl Iterator<Item = &'a Camera>) {
        if self.is_busy || self.epoch.is_none() {
            return;
        }
        let Some(camera) = poses.find(|camera| !self.textures.contains_key(&pose(camera))) else { return };
        if self.textures.len() >= MOST {
            self.textures.clear();
        }
        self.textures.insert(pose(camera), None);
        self.wanted.cancel.store(false, Ordering::Release);
        self.is_busy = self.jobs.send(*camera).is_ok();
    }
}

impl Drop for Thumbnails {
    fn drop(&mut self) {
        self.wanted.cancel.store(true, Ordering::Release);
    }
}

/// Traces one; each is exposed by itself, so that it is legible whatever the viewport is set to.
fn make(wanted: &Wanted, camera: &Camera) -> Made {
    let Some(tracer) = locked(&wanted.tracer).clone() else {
        unreachable!("nothing is asked for before there is a scene")
    };
    let stop = || wanted.cancel.load(Ordering::Acquire);
    let settings = RenderSettings { mode: Mode::Full, trace: TRACE };
    let trace = || {
        let mut renderer = Renderer::default();
        let frame = renderer.render(&FrameRequest::new(&tracer, camera, SIZE, &settings).with_stop(&stop));
        frame.stats.is_complete.then(|| {
            let ev = metered_exposure_ev(&frame.radiance).unwrap_or(0.0);
            let rgb = frame.radiance.iter().flat_map(|&c| srgb8(c, ev, ToneMap::default()));
            ColorImage::from_rgb(SIZE.map(|s| s as usize), &rgb.collect::<Vec<u8>>())
        })
    };
    // A picture that cannot be made stays grey; the frames' thread says what is wrong with the scene.
    let image = catch_unwind(AssertUnwindSafe(trace)).ok().flatten();
    Made { pose: pose(camera), epoch: tracer.epoch(), image }
}
