//! The log on stderr, which is off unless `-v` or `RUST_LOG` asks for it.

use std::io::Write;
use std::time::Instant;

/// Environment variable that selects by module what is logged, such as `afterimage=debug,wgpu=warn`.
const VARIABLE: &str = "RUST_LOG";

/// Starts the log; without `-v` and without `RUST_LOG` there is none.
pub(super) fn start(verbose: u8) {
    let chosen = std::env::var(VARIABLE).ok().filter(|text| !text.is_empty());
    let filter = match (chosen, verbose) {
        (Some(filter), _) => filter,
        (None, 0) => return,
        (None, 1) => "afterimage=info,afterimage_ui=info".to_owned(),
        (None, 2) => "afterimage=debug,afterimage_ui=debug,warn".to_owned(),
        (None, _) => "trace".to_owned(),
    };
    let start = Instant::now();
    let mut builder = env_logger::Builder::new();
    builder.parse_filters(&filter).format(move |out, record| {
        let (secs, level) = (start.elapsed().as_secs_f64(), record.level());
        writeln!(out, "[{secs:9.3} s {level:5} {}] {}", record.target(), record.args())
    });
    // It fails where there is a log already: in tests that start the program twice.
    let _ = builder.try_init();
    log::info!("afterimage {}, {}", super::commit::version(), super::commit::BUILD);
    log::info!("arguments: {:?}", std::env::args().skip(1).collect::<Vec<_>>());
}
