//! All tests of the program in one binary.

#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a test may fail where it stands, and says what it skips"
)]

#[path = "../../tests/film/boxes.rs"]
#[allow(dead_code, reason = "the engine's tests read more of it")]
mod boxes;
mod cli;
#[path = "../build/commit.rs"]
mod commit;
mod commits;
mod licences;
mod window;
