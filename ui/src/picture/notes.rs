//! What a picture's file says of itself: enough to make it again.

use afterimage::raster::color::ToneMap;
use afterimage::render::bands::Background;
use afterimage::{Camera, Mode, RefineState, RenderSettings, Scene};
use glam::DVec3;

/// What a picture was made from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Made<'a> {
    /// The scene as it was asked for.
    pub(crate) scene_name: &'a str,
    /// The scene.
    pub(crate) scene: &'a Scene,
    /// The pose.
    pub(crate) camera: &'a Camera,
    /// Width and height in pixels.
    pub(crate) size: [u32; 2],
    /// Mode, samples, bounces, seed.
    pub(crate) settings: &'a RenderSettings,
    /// How far it was refined.
    pub(crate) refined: RefineState,
    /// Whether the sky is seen.
    pub(crate) background: Background,
    /// In stops.
    pub(crate) exposure_ev: f32,
    /// From radiance to display.
    pub(crate) tone_map: ToneMap,
}

/// Names and texts, as files hold them. Whether it is complete is known only at its end.
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

/// As flags. What has converged is what the full tracer makes with anti-aliasing.
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
