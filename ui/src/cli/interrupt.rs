//! Ctrl+C: the first asks the work to end and keep what is done, the second ends the program.

use std::sync::atomic::{AtomicBool, Ordering};

static CANCELLED: AtomicBool = AtomicBool::new(false);

/// Listens from now on.
pub(crate) fn install() {
    let heard = || {
        if CANCELLED.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    };
    if let Err(error) = ctrlc::set_handler(heard) {
        super::output::say(&format!("warning: Ctrl+C will end the program at once ({error})"));
    }
}

/// Set once the user wants the work to end.
pub(crate) fn flag() -> &'static AtomicBool {
    &CANCELLED
}

/// True once the user wants the work to end.
pub(crate) fn is_cancelled() -> bool {
    CANCELLED.load(Ordering::Relaxed)
}
