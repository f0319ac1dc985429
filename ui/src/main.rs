//! The program. Everything is in the library, so that tests drive the real thing.

fn main() -> std::process::ExitCode {
    afterimage_ui::cli::run()
}
