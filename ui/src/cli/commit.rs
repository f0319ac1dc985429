//! The commit of the source that the program was built from, as `build.rs` found it.

/// The commit, as hexadecimal digits; `None` in a debug build, and where the source was no checkout.
pub(crate) const COMMIT: Option<&str> = option_env!("AFTERIMAGE_COMMIT");

/// How the program was built: `release` or `debug`.
pub(crate) const BUILD: &str = if cfg!(debug_assertions) { "debug" } else { "release" };

/// Number of digits that name a commit for people.
const SHOWN_DIGITS: usize = 12;

/// The version as `--version` and `doctor` say it.
pub(crate) fn version() -> String {
    let version = env!("CARGO_PKG_VERSION");
    match COMMIT {
        Some(commit) => format!("{version} (commit {})", &commit[..commit.len().min(SHOWN_DIGITS)]),
        None if cfg!(debug_assertions) => format!("{version} (debug build)"),
        None => format!("{version} (built from a package, commit unknown)"),
    }
}
