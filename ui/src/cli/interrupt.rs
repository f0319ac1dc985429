//! Ctrl+C: the first interrupt asks the work to stop and keep its results, the second exits at
//! once.

use std::sync::atomic::{AtomicBool, Ordering};

static CANCELLED: AtomicBool = AtomicBool::new(false);

/// Installs the handler.
pub(crate) fn install() {
    let on_interrupt = || {
        if CANCELLED.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    };
    if let Err(error) = ctrlc::set_handler(on_interrupt) {
        super::output::say(&format!("warning: Ctrl+C will discard unfinished results ({error})"));
    }
}

/// The flag that is set by the first interrupt.
pub(crate) fn flag() -> &'static AtomicBool {
    &CANCELLED
}

/// True after the first interrupt.
pub(crate) fn is_cancelled() -> bool {
    CANCELLED.load(Ordering::Relaxed)
}
