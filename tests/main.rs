//! All integration tests in one binary: one link, and tests of all modules share the cores.

#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a test may fail where it stands, and says what it skips"
)]

mod import;
mod layers;
mod metrics;
mod room;
mod save;
mod tour;
