//! The list of experiments. No other file names them all.

use super::run::Experiment;
use super::{at_rest, error_time, placement, scaling, soak, stability, table1, throughput};

/// A row of the table: the name, the description, and the module with the four functions of an
/// experiment; then its limit of bounces, where it is fixed.
macro_rules! experiment {
    ($name:literal, $about:literal, $module:ident) => {
        experiment!($name, $about, $module, None)
    };
    ($name:literal, $about:literal, $module:ident, $fixed_bounces:expr) => {
        Experiment {
            name: $name,
            about: $about,
            fixed_bounces: $fixed_bounces,
            settings: $module::settings,
            cells: $module::cells,
            run_cell: $module::run_cell,
            report: $module::report,
        }
    };
}

/// Every experiment that can be run by its name, in the order in which they are listed to users.
pub const EXPERIMENTS: &[Experiment] = &[
    experiment!("table1", "the paper's Table 1 and figures 2 to 4", table1, Some(table1::BOUNCES)),
    experiment!("error-time", "error against seconds per frame, all modes", error_time),
    experiment!("at-rest", "error of the window's picture after given times at rest", at_rest),
    experiment!("placement", "where references should stand: all rules on the same walks", placement),
    experiment!(
        "scaling",
        "frame time by pixels, triangles, references, lights, samples and threads",
        scaling
    ),
    experiment!("throughput", "the speed of each stage against its lower bound", throughput),
    experiment!("stability", "ill-conditioned and extreme cases: what must hold, measured", stability),
    experiment!("soak", "walking for half an hour: memory and frame times must stay constant", soak),
];

/// Returns the experiment of a name.
pub fn find(name: &str) -> Option<&'static Experiment> {
    EXPERIMENTS.iter().find(|e| e.name == name)
}
