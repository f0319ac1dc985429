//! `afterimage [SCENE]`: opens the window or, without a display, runs the tour of the scene.

use super::flags::{Flags, StoreChoice};
use super::{failure::Failure, headless, interrupt, paths, pose, scene};
use crate::picture::restore::{PictureView, beside, is_picture, read_view};
use crate::settings::{Layers, suggestion};
use crate::window::state::Appearance;
use crate::window::{self, LaunchOptions, SceneSource};
use afterimage::raster::exposure::Exposure;
use std::path::Path;

pub(super) fn start(
    scene: Option<&str>,
    flags: &Flags,
    layers: &Layers,
    commands: &clap::Command,
) -> Result<(), Failure> {
    scene.map_or(Ok(()), |scene| check_is_no_command(scene, commands))?;
    if window::has_display() {
        return open_window(scene, flags, layers);
    }
    interrupt::install();
    let view = picture_view(scene)?;
    let scene = view.as_ref().map(|v| v.scene.as_str()).or(scene);
    headless::run(scene, flags)
}

/// Refuses a word that is neither a file nor could be the name of a model: it is a misspelled
/// command.
fn check_is_no_command(word: &str, commands: &clap::Command) -> Result<(), Failure> {
    if word.contains(['.', '/', '\\', ':']) || Path::new(word).exists() {
        return Ok(());
    }
    let names: Vec<&str> = commands.get_subcommands().map(clap::Command::get_name).collect();
    let hint = suggestion(word, &names);
    Err(Failure::Usage(format!("there is no command and no file '{word}'; {hint}")))
}

fn open_window(scene: Option<&str>, flags: &Flags, layers: &Layers) -> Result<(), Failure> {
    let (options, settings) = (scene::import_options(flags), layers.settings());
    let view = picture_view(scene)?;
    let scene = view.as_ref().map(|v| v.scene.as_str()).or(scene);
    let mut request = LaunchOptions {
        scene: scene.map(|name| SceneSource::named(name, options)),
        daylight: flags.daylight().map_err(Failure::Usage)?,
        camera: pose::given(flags).or(view.as_ref().map(|v| v.camera)),
        view: flags.view.clone(),
        fov_y_deg: flags.fov_y,
        exposure: flags.exposure.or(view.as_ref().and_then(|v| v.exposure_ev).map(Exposure::Stops)),
        tone_map: flags.tone_map,
        keeps_improving: settings.keep_improving.unwrap_or(false),
        threads: flags.threads,
        pictures: settings.pictures.clone(),
        appearance: Appearance::of(&settings),
        settings_file: layers.user_file.clone(),
        state_folder: paths::state_folder(),
        store: flags.store(&StoreChoice::Default),
        warnings: layers.warnings.clone(),
        ..LaunchOptions::default()
    };
    let trace = &mut request.settings.render.trace;
    trace.samples = flags.samples.unwrap_or(trace.samples);
    trace.bounces = flags.bounces.map_or(trace.bounces, |limit| limit.0);
    trace.seed = flags.seed;
    request.settings.render.mode = flags.mode;
    Ok(window::run(request)?)
}

/// The view of the picture, if `scene` names a picture.
fn picture_view(scene: Option<&str>) -> Result<Option<PictureView>, Failure> {
    let picture = scene.map(Path::new).filter(|path| is_picture(path));
    Ok(picture.map(|path| read_view(path).map(|view| beside(view, path))).transpose()?)
}
