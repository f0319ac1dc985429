//! All integration tests in one binary: one link, and tests of all modules share the cores.

mod import;
