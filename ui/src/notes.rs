//! What a picture's file says of itself: enough to make it again.

use afterimage::raster::color::ToneMap;
use afterimage::{Camera, RenderSettings, Scene};
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
    /// Mode, samples, bounces, seed.
    pub(crate) settings: &'a RenderSettings,
    /// False where it was stopped early.
    pub(crate) is_complete: bool,
    /// In stops.
    pub(crate) exposure_ev: f32,
    /// From radiance to display.
    pub(crate) tone_map: ToneMap,
}

/// Names and texts, as files hold them.
pub(crate) fn notes(made: &Made<'_>) -> Vec<(&'static str, String)> {
    let c = made.camera;
    let (eye, at) = (c.eye, c.eye + c.forward());
    let list = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
    let trace = &made.settings.trace;
    vec![
        ("Software", format!("afterimage {}", env!("CARGO_PKG_VERSION"))),
        ("Scene", format!("{} {}", made.scene_name, made.scene.hash)),
        ("Pose", format!("--eye {} --look-at {} --fov-y {}", list(eye), list(at), c.fov_y.to_degrees())),
        (
            "Settings",
            format!(
                "--mode {} --samples {} --bounces {} --seed {}",
                made.settings.mode.name(),
                trace.samples,
                trace.bounces,
                trace.seed
            ),
        ),
        ("Complete", if made.is_complete { "yes" } else { "no" }.to_owned()),
        ("Tone map", format!("{} at {} EV", made.tone_map.name(), made.exposure_ev)),
    ]
}
