//! The command line: flags as typed become a checked job, the engine does it, and the result goes to stdout and files.
//!
//! stdout is data, stderr is for people. No command but `doctor` and the window touches graphics.

mod compare;
mod doctor;
mod experiment;
mod failure;
mod flags;
mod inspect;
mod interrupt;
mod memory;
mod output;
mod paths;
mod pose;
mod progress;
mod render;
mod report;
mod scene;
mod start;
mod throughput;
mod tour;

use crate::window::keymap::help_text;
use clap::{Parser, Subcommand};
use failure::Failure;
use flags::Flags;
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
    /// A model (.obj) or builtin:NAME; the embedded gallery when absent. Opens the window.
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
}

/// Runs the program on its arguments.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are no errors: clap knows where they go and how they end.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(1));
        }
    };
    let outcome =
        pose::check(&cli.flags).and_then(|()| start_threads(&cli.flags)).and_then(|()| dispatch(&cli));
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::say(&failure.to_string());
            ExitCode::from(failure.exit_code())
        }
    }
}

fn dispatch(cli: &Cli) -> Result<(), Failure> {
    let flags = &cli.flags;
    // The window is ended by the system's own answer to a signal.
    if cli.command.is_some() {
        interrupt::install();
    }
    match (&cli.scene, &cli.command) {
        (Some(scene), Some(_)) => {
            Err(Failure::Usage(format!("'{scene}' stands before the command; put the scene after it")))
        }
        (scene, None) => start::start(scene.as_deref(), flags),
        (None, Some(Command::Render(args))) => render::run(args, flags),
        (None, Some(Command::Tour(args))) => tour::run(args, flags),
        (None, Some(Command::Experiment(args))) => experiment::run(args, flags),
        (None, Some(Command::Inspect(args))) => inspect::run(args, flags),
        (None, Some(Command::Compare(args))) => compare::run(args, flags),
        (None, Some(Command::Doctor)) => doctor::run(flags),
    }
}

fn start_threads(flags: &Flags) -> Result<(), Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(flags.threads.unwrap_or(0))
        .thread_name(|i| format!("trace-{i}"))
        .build_global()
        .map_err(|e| Failure::Failed(format!("cannot start the threads that trace: {e}")))
}
