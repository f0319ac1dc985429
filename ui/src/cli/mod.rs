//! The command line: each command checks its flags, calls the engine, and writes results to stdout
//! and files.
//!
//! Data goes to stdout, messages to stderr. Only `doctor` and the window use graphics.

mod bake;
mod commit;
mod compare;
mod doctor;
#[cfg(test)]
mod documented;
mod experiment;
mod failure;
mod film;
pub(crate) mod flags;
mod generate;
mod glare;
mod headless;
mod inspect;
mod interrupt;
mod jpeg;
mod logging;
mod measure;
mod output;
mod panorama;
pub(crate) mod paths;
mod pose;
#[cfg(feature = "profile")]
mod profile;
mod progress;
mod projection;
mod render;
mod render_store;
mod report;
mod scene;
mod section;
mod show;
mod show_flags;
mod start;
mod store;
mod sun;
mod tour;
mod tour_export;
mod tour_show;
mod walk;

use crate::settings::{CONFIG_VARIABLE, Layers};
use crate::window::input::keymap::{self, KeysError};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use failure::Failure;
use flags::Flags;
use std::{ffi::OsString, io::Write, path::PathBuf, process::ExitCode};

const EXIT_CODES: &str = "Exit codes: 0 ok, 1 failure, 2 usage, 3 the scene cannot be imported, \
    4 warnings under --strict, 130 interrupted.";

/// Text of `--help` below the flags.
fn long_help() -> String {
    format!("Keys in the window:\n{}\n{EXIT_CODES}", keymap::help_text())
}

/// Interactive walkthrough of ray-traced buildings that reuses reference images.
#[derive(Debug, Parser)]
#[command(name = "afterimage", version = commit::version(), about, subcommand_precedence_over_arg = true)]
#[command(after_help = EXIT_CODES, after_long_help = long_help())]
struct Cli {
    /// A model (.obj, .gltf, .glb), builtin:NAME, or a picture saved by this program, whose view is
    /// restored [default: the embedded gallery]. Opens the window.
    scene: Option<String>,
    #[command(flatten)]
    flags: Flags,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render one picture.
    Render(render::RenderArgs),
    /// Render the scene's camera path and record every frame.
    Tour(tour::TourArgs),
    /// Render the scene's camera path as a film (MP4), without another program.
    Film(film::FilmArgs),
    /// Write the scene's views as panoramas into one HTML file, to walk through in a browser.
    TourExport(tour_export::TourExportArgs),
    /// Fill a store with references of the whole scene, before anybody walks there.
    Bake(bake::BakeArgs),
    /// Run a named experiment.
    Experiment(experiment::ExperimentArgs),
    /// List a scene's contents, the features it uses, and the warnings about its files.
    Inspect(inspect::InspectArgs),
    /// Measure the illuminance of a work plane or at points, in lux.
    Measure(measure::MeasureArgs),
    /// Find the glare of a view: light at the eye, glare sources, and DGP.
    Glare(glare::GlareArgs),
    /// Render a view through a day, or through a year at one hour.
    Sun(sun::SunArgs),
    /// Compare a picture with a ground-truth picture of the same size.
    Compare(compare::CompareArgs),
    /// List, check, tidy and join stores of references.
    Store(store::StoreArgs),
    /// Print what a bug report needs: version, machine, graphics, paths.
    Doctor,
    /// Print the completion script for a shell.
    Completions(generate::CompletionsArgs),
    /// Print the manual page.
    Man,
    /// Print the licences of the libraries in the program, with their texts.
    Licences,
    /// Print the JSON Schema of settings.toml or of the file next to a model.
    Schema(generate::SchemaArgs),
}

impl Command {
    /// The scene argument of commands that have one.
    fn scene(&self) -> Option<&str> {
        match self {
            Self::Render(args) => args.scene.as_deref(),
            Self::Tour(args) => args.scene.as_deref(),
            Self::Film(args) => args.scene.as_deref(),
            Self::TourExport(args) => args.scene.as_deref(),
            Self::Bake(args) => args.scene.as_deref(),
            Self::Measure(args) => args.scene.as_deref(),
            Self::Glare(args) => args.scene.as_deref(),
            Self::Sun(args) => args.scene.as_deref(),
            Self::Inspect(args) => Some(&args.scene),
            _ => None,
        }
    }
}

/// Runs the program with the arguments of the process.
pub fn run() -> ExitCode {
    let user_file = user_settings(std::env::args_os());
    // Keys are installed first because `--help` lists them.
    let layers = Layers::load(user_file.clone(), None, std::env::vars());
    let key_error = layers.settings().keys.and_then(|keys| keymap::install(&keys).err());
    match with_settings(user_file, key_error) {
        Ok(()) => ExitCode::SUCCESS,
        Err(exit_code) => exit_code,
    }
}

/// Parses the arguments, with the settings as defaults of flags, and runs the command.
fn with_settings(user_file: Option<PathBuf>, key_error: Option<KeysError>) -> Result<(), ExitCode> {
    let cli = parse(Cli::command())?;
    let scene = cli.scene.as_deref().or_else(|| cli.command.as_ref().and_then(Command::scene));
    let mut layers = Layers::load(user_file, scene, std::env::vars());
    layers.warnings.extend(key_error.map(|error| error.to_string()));
    for warning in &layers.warnings {
        output::say(&format!("warning: {warning}"));
    }
    let command = Cli::command().mut_args(|arg| {
        let name = arg.get_long().unwrap_or_default().replace('-', "_");
        match layers.flag_value(&name) {
            Some(value) => arg.default_value(value),
            None => arg,
        }
    });
    let cli = parse(command)?;
    logging::start(cli.flags.verbose);
    log::info!(
        "settings: {}",
        layers.user_file.as_deref().map_or("none".into(), |path| path.display().to_string())
    );
    #[cfg(feature = "profile")]
    profile::start();
    let outcome = check(&cli.flags)
        .and_then(|()| start_threads(&cli.flags))
        .and_then(|()| dispatch(&cli, &layers))
        .and_then(|()| output::check());
    #[cfg(feature = "profile")]
    let outcome = profile::finish().and(outcome);
    outcome.map_err(fail)
}

/// Says why a command failed, and returns its exit code.
fn fail(failure: Failure) -> ExitCode {
    output::say(&failure.to_string());
    ExitCode::from(failure.exit_code())
}

/// Parses the arguments of the process. Prints clap's errors, and the texts of `--help` and
/// `--version`.
fn parse(command: clap::Command) -> Result<Cli, ExitCode> {
    command.try_get_matches().and_then(|matches| Cli::from_arg_matches(&matches)).map_err(|error| {
        let written = error.print();
        if error.use_stderr() {
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(1));
        }
        output::note(written.and_then(|()| std::io::stdout().flush()));
        output::check().map_or_else(fail, |()| ExitCode::SUCCESS)
    })
}

/// Path of the user's settings file. It is needed before the arguments are parsed.
fn user_settings(arguments: impl Iterator<Item = OsString>) -> Option<PathBuf> {
    let mut arguments = arguments.skip(1);
    while let Some(argument) = arguments.next() {
        if argument == "--config" {
            return arguments.next().map(PathBuf::from);
        }
        if let Some(path) = argument.to_str().and_then(|a| a.strip_prefix("--config=")) {
            return Some(PathBuf::from(path));
        }
    }
    let from_variable = std::env::var_os(CONFIG_VARIABLE).filter(|path| !path.is_empty());
    from_variable.map(PathBuf::from).or_else(|| paths::config_folder().map(|f| f.join("settings.toml")))
}

fn check(flags: &Flags) -> Result<(), Failure> {
    match &flags.config {
        Some(path) if !path.is_file() => {
            Err(Failure::Usage(format!("--config {}: there is no such file", path.display())))
        }
        _ => flags.daylight().map_err(Failure::Usage).and_then(|_| pose::check(flags)),
    }
}

fn dispatch(cli: &Cli, layers: &Layers) -> Result<(), Failure> {
    let flags = &cli.flags;
    // In the window, signals keep their default action.
    if cli.command.is_some() {
        interrupt::install();
    }
    match (&cli.scene, &cli.command) {
        (Some(scene), Some(_)) => Err(Failure::Usage(format!(
            "the scene '{scene}' is given before the command; put it after the command"
        ))),
        (scene, None) => start::start(scene.as_deref(), flags, layers, &Cli::command()),
        (None, Some(Command::Render(args))) => render::run(args, flags),
        (None, Some(Command::Tour(args))) => tour::run(args, flags),
        (None, Some(Command::Film(args))) => film::run(args, flags),
        (None, Some(Command::TourExport(args))) => tour_export::run(args, flags),
        (None, Some(Command::Bake(args))) => bake::run(args, flags),
        (None, Some(Command::Experiment(args))) => experiment::run(args, flags),
        (None, Some(Command::Inspect(args))) => inspect::run(args, flags),
        (None, Some(Command::Measure(args))) => measure::run(args, flags),
        (None, Some(Command::Glare(args))) => glare::run(args, flags),
        (None, Some(Command::Sun(args))) => sun::run(args, flags),
        (None, Some(Command::Compare(args))) => compare::run(args, flags),
        (None, Some(Command::Store(args))) => store::run(args, flags),
        (None, Some(Command::Doctor)) => doctor::run(flags, layers.user_file.as_deref()),
        (None, Some(Command::Completions(args))) => generate::completions(args, Cli::command()),
        (None, Some(Command::Man)) => generate::man(Cli::command()),
        (None, Some(Command::Licences)) => generate::licences(),
        (None, Some(Command::Schema(args))) => generate::schema(args),
    }
}

fn start_threads(flags: &Flags) -> Result<(), Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(flags.threads.unwrap_or(0))
        .thread_name(|i| format!("trace-{i}"))
        .build_global()
        .map_err(|e| Failure::Failed(format!("cannot start the threads that trace rays: {e}")))
}
