//! Metadata that a picture file stores: enough to render the picture again.

use afterimage::raster::color::ToneMap;
use afterimage::render::bands::Background;
use afterimage::scene::{Sky, solar::SunPosition};
use afterimage::trace::section::CutPlane;
use afterimage::{Camera, Mode, RefineState, RenderSettings, Scene};
use glam::DVec3;

/// Name of the note that holds a session.
pub(crate) const DOCUMENT: &str = "Document";

/// Scene, camera and settings from which a picture was rendered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PictureOrigin<'a> {
    /// Name of the scene as given by the user.
    pub(crate) scene_name: &'a str,
    /// Scene that the picture shows.
    pub(crate) scene: &'a Scene,
    /// Pose and field of view of the camera.
    pub(crate) camera: &'a Camera,
    /// Width and height in pixels.
    pub(crate) size: [u32; 2],
    /// Mode, samples, bounces and seed.
    pub(crate) settings: &'a RenderSettings,
    /// State of progressive refinement when the picture was saved.
    pub(crate) refined: RefineState,
    /// Whether the sky is shown.
    pub(crate) background: Background,
    /// Exposure of the picture in stops.
    pub(crate) exposure_ev: f32,
    /// Tone map from radiance to display.
    pub(crate) tone_map: ToneMap,
    /// Planes that cut the scene open.
    pub(crate) section: &'a [CutPlane],
    /// Width of the lines along edges, pixels.
    pub(crate) outlines: Option<u32>,
    /// Session with the changes of the scene, if there are any.
    pub(crate) document: Option<&'a str>,
}

/// Names and values of the metadata. Whether the picture is complete is added when its file is
/// closed.
pub(crate) fn metadata(origin: &PictureOrigin<'_>) -> Vec<(&'static str, String)> {
    let c = origin.camera;
    let (eye, at) = (c.eye, c.eye + c.forward());
    let list = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
    let mut notes = vec![
        ("Software", format!("afterimage {}", env!("CARGO_PKG_VERSION"))),
        ("Scene", format!("{} {}", origin.scene_name, origin.scene.hash)),
        ("Pose", format!("--eye {} --look-at {} --fov-y {}", list(eye), list(at), c.fov_y.to_degrees())),
        ("Settings", settings(origin)),
        ("Daylight", daylight(origin.scene)),
        ("Refined", format!("{} of {} passes", origin.refined.pass, origin.refined.of)),
        ("Tone map", format!("{} at {} EV", origin.tone_map.name(), origin.exposure_ev)),
    ];
    notes.extend(origin.document.map(|text| (DOCUMENT, text.to_owned())));
    notes
}

/// The settings as flags of `afterimage render`. A converged picture is the one that the full
/// tracer renders with anti-aliasing.
fn settings(origin: &PictureOrigin<'_>) -> String {
    let (trace, refined) = (&origin.settings.trace, origin.refined);
    let has_converged = refined.is_complete && refined.of > 0 && refined.pass <= refined.of;
    let mode = if has_converged { Mode::Full } else { origin.settings.mode };
    let antialias = if has_converged { format!(" --antialias {}", refined.of) } else { String::new() };
    let (samples, bounces, seed) = (trace.samples, trace.bounce_limit(), trace.seed);
    let background = if origin.background == Background::LeftOut { " --no-background" } else { "" };
    let section: String = origin.section.iter().map(|plane| format!(" --section {plane}")).collect();
    let outlines = origin.outlines.map_or(String::new(), |width| format!(" --outlines {width}"));
    let [width, height] = origin.size;
    format!(
        "--size {width}x{height} --mode {} --samples {samples} --bounces {bounces} --seed {seed}{antialias}{background}{section}{outlines}",
        mode.name()
    )
}

/// Sun and sky of a scene, in words: they may be those of the file, of `--sky` and `--sun-time`, or
/// of the window's controls.
fn daylight(scene: &Scene) -> String {
    let sun = scene.sun.map(|sun| {
        let SunPosition { azimuth_deg, height_deg } = SunPosition::of_direction(sun.direction);
        format!("sun {height_deg:.1} degrees high, {azimuth_deg:.1} degrees from -Z towards +X")
    });
    let sky = scene.sky.as_ref().map(|sky: &Sky| format!("sky {}", sky.kind().name()));
    let parts: Vec<String> = sun.into_iter().chain(sky).collect();
    if parts.is_empty() { "none".to_owned() } else { parts.join(", ") }
}
