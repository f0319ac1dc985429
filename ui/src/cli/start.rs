//! `afterimage [SCENE]`: the window, or without a display the same walk headless.

use super::failure::Failure;
use super::flags::Flags;
use super::{Common, interrupt, output, paths, pose, scene, tour};
use crate::picture::restore::{PictureView, beside, is_picture, read_view};
use crate::settings::suggestion;
use crate::window::state::{Appearance, WINDOW_SAMPLES};
use crate::window::{self, SceneSource, WindowRequest};
use clap::{CommandFactory, Parser};
use std::path::Path;

/// Where the headless walk leaves its records.
const OUT: &str = "afterimage-out";

pub(super) fn start(scene: Option<&str>, flags: &Flags, common: &Common) -> Result<(), Failure> {
    scene.map_or(Ok(()), check_is_no_command)?;
    if window::has_display() {
        return open_window(scene, flags, common);
    }
    interrupt::install();
    // As light as the window's own frames, where nothing else is asked for: some minutes at most.
    let given_size = flags.given_size.or(Some([640, 360]));
    let samples = flags.samples.or(Some(WINDOW_SAMPLES));
    let flags = Flags { given_size, samples, ..flags.clone() };
    let [width, height] = flags.size();
    output::say(&format!(
        "no display was found; walking the scene's tour headless at {width}x{height} into {OUT}/"
    ));
    let view = picture_view(scene)?;
    let scene = view.as_ref().map(|v| v.scene.as_str()).or(scene);
    tour::run(&headless_tour(scene), &flags)
}

/// A word that names no file and could not be a model's was meant as a command.
fn check_is_no_command(word: &str) -> Result<(), Failure> {
    if word.contains(['.', '/', '\\', ':']) || Path::new(word).exists() {
        return Ok(());
    }
    let commands = super::Cli::command();
    let names: Vec<&str> = commands.get_subcommands().map(clap::Command::get_name).collect();
    let hint = suggestion(word, &names);
    Err(Failure::Usage(format!("there is no command and no file '{word}'; {hint}")))
}

fn open_window(scene: Option<&str>, flags: &Flags, common: &Common) -> Result<(), Failure> {
    let options = scene::import_options(flags);
    let view = picture_view(scene)?;
    let scene = view.as_ref().map(|v| v.scene.as_str()).or(scene);
    let flags =
        &Flags { exposure: flags.exposure.or(view.as_ref().and_then(|v| v.exposure_ev)), ..flags.clone() };
    let mut request = WindowRequest {
        scene: scene.map(|name| SceneSource::named(name, options)),
        camera: pose::given(flags).or(view.as_ref().map(|v| v.camera)),
        view: flags.view.clone(),
        fov_y_deg: flags.fov_y,
        exposure_ev: flags.exposure,
        tone_map: flags.tone_map,
        threads: flags.threads,
        pictures: common.settings.pictures.clone(),
        appearance: Appearance::of(&common.settings),
        settings_file: common.user_file.clone(),
        state_folder: paths::state_folder(),
        warnings: common.warnings.clone(),
        ..WindowRequest::default()
    };
    let trace = &mut request.settings.render.trace;
    trace.samples = flags.samples.unwrap_or(trace.samples);
    trace.bounces = flags.bounces.unwrap_or(trace.bounces);
    request.model_bounces = flags.bounces.unwrap_or(request.model_bounces);
    trace.seed = flags.seed;
    request.settings.render.mode = flags.mode;
    window::run(request).map_err(|error| Failure::Failed(error.to_string()))
}

/// What a picture shows, where it is one that was named.
fn picture_view(scene: Option<&str>) -> Result<Option<PictureView>, Failure> {
    let picture = scene.map(Path::new).filter(|path| is_picture(path));
    let view = picture.map(|path| read_view(path).map(|view| beside(view, path))).transpose();
    view.map_err(Failure::Failed)
}

/// The tour with its defaults, as if its command had been typed.
fn headless_tour(scene: Option<&str>) -> tour::TourArgs {
    #[derive(Parser)]
    struct Typed {
        #[command(flatten)]
        args: tour::TourArgs,
    }
    let mut args = Typed::parse_from(["tour", "--out", OUT]).args;
    args.scene = scene.map(str::to_owned);
    args
}
