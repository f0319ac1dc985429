//! The list of experiments. No other file names them all.

use super::run::Experiment;
use super::{error_time, placement, scaling, soak, stability, table1, throughput};

/// Every experiment that can be run by its name, in the order in which they are listed to users.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment {
        name: "table1",
        about: "the paper's Table 1 and figures 2 to 4",
        settings: table1::settings,
        cells: table1::cells,
        run_cell: table1::run_cell,
        report: table1::report,
    },
    Experiment {
        name: "error-time",
        about: "error against seconds per frame, every mode against full ray tracing",
        settings: error_time::settings,
        cells: error_time::cells,
        run_cell: error_time::run_cell,
        report: error_time::report,
    },
    Experiment {
        name: "placement",
        about: "where references should stand: all placement rules on the same walks",
        settings: placement::settings,
        cells: placement::cells,
        run_cell: placement::run_cell,
        report: placement::report,
    },
    Experiment {
        name: "scaling",
        about: "how frame time grows with pixels, triangles, references, lights, samples and threads",
        settings: scaling::settings,
        cells: scaling::cells,
        run_cell: scaling::run_cell,
        report: scaling::report,
    },
    Experiment {
        name: "throughput",
        about: "the speed of each stage against its lower bound",
        settings: throughput::settings,
        cells: throughput::cells,
        run_cell: throughput::run_cell,
        report: throughput::report,
    },
    Experiment {
        name: "stability",
        about: "ill-conditioned and extreme cases: what must hold, measured",
        settings: stability::settings,
        cells: stability::cells,
        run_cell: stability::run_cell,
        report: stability::report,
    },
    Experiment {
        name: "soak",
        about: "walking for half an hour: memory and frame times must stay constant",
        settings: soak::settings,
        cells: soak::cells,
        run_cell: soak::run_cell,
        report: soak::report,
    },
];

/// Returns the experiment of a name.
pub fn find(name: &str) -> Option<&'static Experiment> {
    EXPERIMENTS.iter().find(|e| e.name == name)
}
