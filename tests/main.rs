//! All integration tests in one binary: one link, and tests of all modules share the cores.

mod import;
mod layers;
mod metrics;
mod room;
mod save;
mod tour;
