//! Metadata that a picture file stores: enough to render the picture again.

use afterimage::raster::color::ToneMap;
use afterimage::render::bands::Background;
use afterimage::{Camera, Mode, RefineState, RenderSettings, Scene};
use glam::DVec3;

/// What a picture was rendered from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Made<'a> {
    /// Name of the scene as given by the user.
    pub(crate) scene_name: &'a str,
    /// The scene.
    pub(crate) scene: &'a Scene,
    /// Camera of the picture.
    pub(crate) camera: &'a Camera,
    /// Width and height in pixels.
    pub(crate) size: [u32; 2],
    /// Mode, samples, bounces and seed.
    pub(crate) settings: &'a RenderSettings,
    /// State of progressive refinement.
    pub(crate) refined: RefineState,
    /// Whether the sky is shown.
    pub(crate) background: Background,
    /// Exposure in stops.
    pub(crate) exposure_ev: f32,
    /// Tone map from radiance to display.
    pub(crate) tone_map: ToneMap,
}

/// Names and values of the metadata. Whether the picture is complete is added when its file is
/// closed.
pub(crate) fn notes(made: &Made<'_>) -> Vec<(&'static str, String)> {
    let c = made.camera;
    let (eye, at) = (c.eye, c.eye + c.forward());
    let list = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
    vec![
        ("Software", format!("afterimage {}", env!("CARGO_PKG_VERSION"))),
        ("Scene", format!("{} {}", made.scene_name, made.scene.hash)),
        ("Pose", format!("--eye {} --look-at {} --fov-y {}", list(eye), list(at), c.fov_y.to_degrees())),
        ("Settings", settings(made)),
        ("Refined", format!("{} of {} passes", made.refined.pass, made.refined.of)),
        ("Tone map", format!("{} at {} EV", made.tone_map.name(), made.exposure_ev)),
    ]
}

/// The settings as flags of `afterimage render`. A converged picture is the one that the full
/// tracer renders with anti-aliasing.
fn settings(made: &Made<'_>) -> String {
    let (trace, refined) = (&made.settings.trace, made.refined);
    let has_converged = refined.is_complete && refined.of > 0;
    let mode = if has_converged { Mode::Full } else { made.settings.mode };
    let antialias = if has_converged { format!(" --antialias {}", refined.of) } else { String::new() };
    let (samples, bounces, seed) = (trace.samples, trace.bounces, trace.seed);
    let background = if made.background == Background::LeftOut { " --no-background" } else { "" };
    let [width, height] = made.size;
    format!(
        "--size {width}x{height} --mode {} --samples {samples} --bounces {bounces} --seed {seed}{antialias}{background}",
        mode.name()
    )
}
