//! The command line: flags as typed become a checked job, the engine does it, and the result goes to stdout and files.
//!
//! stdout is data, stderr is for people. No command but `doctor` and the window touches graphics.

mod compare;
mod doctor;
mod experiment;
mod failure;
pub(crate) mod flags;
mod generate;
mod inspect;
mod interrupt;
mod output;
pub(crate) mod paths;
mod pose;
mod progress;
mod render;
mod report;
mod scene;
mod start;
mod throughput;
mod tour;

use crate::settings::{self, Settings};
use crate::window::input::keymap;
use crate::window::input::keymap::help_text;
use clap::parser::ValueSource;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use failure::Failure;
use flags::Flags;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

const EXIT_CODES: &str = "Exit codes: 0 ok, 1 failure, 2 usage, 3 the scene cannot be imported, \
    4 warnings under --strict, 130 interrupted.";

/// What `--help` says below the flags.
fn long_help() -> String {
    format!("Keys in the window:\n{}\n{EXIT_CODES}", help_text())
}

/// Walk through ray-traced buildings; reference images are reused.
#[derive(Debug, Parser)]
#[command(name = "afterimage", version, about, subcommand_precedence_over_arg = true)]
#[command(after_help = EXIT_CODES, after_long_help = long_help())]
struct Cli {
    /// A model (.obj, .gltf, .glb), builtin:NAME, or a picture saved by this program: its view; the embedded gallery when absent. Opens
    /// the window.
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
    /// Fly the scene's walk and record every frame.
    Tour(tour::TourArgs),
    /// Run a named experiment.
    Experiment(experiment::ExperimentArgs),
    /// Say what is in a scene, what it needs and what is doubtful.
    Inspect(inspect::InspectArgs),
    /// Compare two pictures of one size, the second being the truth.
    Compare(compare::CompareArgs),
    /// Say what a bug report needs: version, machine, graphics, paths.
    Doctor,
    /// Print completions for a shell, to be put where it looks for them.
    Completions(generate::CompletionsArgs),
    /// Print the manual page.
    Man,
    /// Print the licences of everything the program is made of.
    Licences,
}

impl Command {
    /// The scene that the command is about, where it is about one.
    fn scene(&self) -> Option<&str> {
        match self {
            Self::Render(args) => args.scene.as_deref(),
            Self::Tour(args) => args.scene.as_deref(),
            Self::Inspect(args) => Some(&args.scene),
            _ => None,
        }
    }
}

/// Runs the program on its arguments.
pub fn run() -> ExitCode {
    let user_file = user_settings(std::env::args_os());
    // Keys come first: `--help` prints them.
    let (settings, _) = settings::load(user_file.as_deref(), None, std::env::vars());
    let key_trouble = settings.keys.and_then(|keys| keymap::install(&keys).err());
    let parsed = Cli::command().try_get_matches().and_then(|m| Ok((Cli::from_arg_matches(&m)?, m)));
    let (mut cli, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => {
            // Help and version are no errors: clap knows where they go and how they end.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(1));
        }
    };
    let scene = cli.scene.as_deref().or_else(|| cli.command.as_ref().and_then(Command::scene));
    let (settings, mut warnings) = settings::load(user_file.as_deref(), scene, std::env::vars());
    warnings.extend(key_trouble);
    warnings.iter().for_each(|warning| output::say(&format!("warning: {warning}")));
    let is_given = |id: &str| matches.value_source(id).is_some_and(|s| s != ValueSource::DefaultValue);
    cli.flags.fill_in(&settings, is_given);
    let common = Common { settings, user_file, warnings };
    let outcome =
        check(&cli.flags).and_then(|()| start_threads(&cli.flags)).and_then(|()| dispatch(&cli, &common));
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::say(&failure.to_string());
            ExitCode::from(failure.exit_code())
        }
    }
}

/// What holds beside the flags.
#[derive(Debug)]
struct Common {
    settings: Settings,
    user_file: Option<PathBuf>,
    warnings: Vec<String>,
}

/// The file of the user's settings, found before anything else is known.
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
    let named = std::env::var_os(settings::CONFIG_VARIABLE).filter(|name| !name.is_empty());
    named.map(PathBuf::from).or_else(|| paths::config_folder().map(|f| f.join("settings.toml")))
}

fn check(flags: &Flags) -> Result<(), Failure> {
    match &flags.config {
        Some(path) if !path.is_file() => {
            Err(Failure::Usage(format!("--config {}: there is no such file", path.display())))
        }
        _ => pose::check(flags),
    }
}

fn dispatch(cli: &Cli, common: &Common) -> Result<(), Failure> {
    let flags = &cli.flags;
    // The window is ended by the system's own answer to a signal.
    if cli.command.is_some() {
        interrupt::install();
    }
    match (&cli.scene, &cli.command) {
        (Some(scene), Some(_)) => {
            Err(Failure::Usage(format!("'{scene}' stands before the command; put the scene after it")))
        }
        (scene, None) => start::start(scene.as_deref(), flags, common),
        (None, Some(Command::Render(args))) => render::run(args, flags),
        (None, Some(Command::Tour(args))) => tour::run(args, flags),
        (None, Some(Command::Experiment(args))) => experiment::run(args, flags),
        (None, Some(Command::Inspect(args))) => inspect::run(args, flags),
        (None, Some(Command::Compare(args))) => compare::run(args, flags),
        (None, Some(Command::Doctor)) => doctor::run(flags, common.user_file.as_deref()),
        (None, Some(Command::Completions(args))) => generate::completions(args, Cli::command()),
        (None, Some(Command::Man)) => generate::man(Cli::command()),
        (None, Some(Command::Licences)) => generate::licences(),
    }
}

fn start_threads(flags: &Flags) -> Result<(), Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(flags.threads.unwrap_or(0))
        .thread_name(|i| format!("trace-{i}"))
        .build_global()
        .map_err(|e| Failure::Failed(format!("cannot start the threads that trace: {e}")))
}
