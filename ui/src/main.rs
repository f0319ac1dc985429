//! The program. All code is in the library, so that tests can use it.

fn main() -> std::process::ExitCode {
    afterimage_ui::cli::run()
}
