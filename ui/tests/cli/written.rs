//! Results that cannot be written are failures; a reader that has read enough is none.

use super::Bench;
use std::io::Read;
use std::process::{Command, Stdio};

fn program(bench: &Bench, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_afterimage"));
    command.args(line.split_whitespace()).current_dir(bench.dir.path());
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    command.env("XDG_CONFIG_HOME", bench.path("config")).env("XDG_CACHE_HOME", bench.path("cache"));
    command
}

const LINES: [&str; 9] = [
    "inspect room.obj --json",
    "inspect room.obj",
    "doctor --json",
    "completions bash",
    "man",
    "licences",
    "schema sidecar",
    "--help",
    "--version",
];

#[cfg(target_os = "linux")]
#[test]
fn a_result_that_cannot_be_written_ends_with_one_and_a_line_that_says_so() {
    let bench = Bench::new();
    for line in LINES {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = program(&bench, line).stdout(full).output().unwrap();
        let errors = super::stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{line}: {errors}");
        let last = errors.trim_end().lines().last().unwrap();
        assert!(last.starts_with("error: the result cannot be written to stdout: No space left"), "{errors}");
    }
}

#[test]
fn a_reader_that_has_read_enough_is_no_failure() {
    let bench = Bench::new();
    for line in LINES {
        let mut child = program(&bench, line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let mut errors = String::new();
        child.stderr.take().unwrap().read_to_string(&mut errors).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(0), "{line}: {errors}");
        assert!(!errors.contains("stdout"), "{line}: {errors}");
    }
}
