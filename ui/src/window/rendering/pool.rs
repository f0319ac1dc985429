//! Thread pools below the window's priority.

use rayon::ThreadPool;
use std::io;

/// Niceness of all threads that trace. The window and the threads of a software rasteriser run
/// first: on two cores without a graphics card, the window was updated every 300 ms while the
/// gallery was rendered, and every 75 ms with this value. References have the same priority as
/// frames, because they make the following frames cheaper.
const NICENESS: i32 = 10;

/// Lowers the priority of the calling thread.
pub(crate) fn lower_priority() {
    // On other systems, this would lower the priority of the whole process. If the system refuses,
    // all threads have equal shares, which is correct but slower to react.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(NICENESS);
    #[cfg(not(target_os = "linux"))]
    let _ = NICENESS;
}

/// Returns a pool of at least one thread, named `name-0`, `name-1`, ..., of low priority.
///
/// # Errors
/// Where the system refuses to start the threads.
pub(crate) fn background_pool(name: &'static str, threads: usize) -> io::Result<ThreadPool> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.max(1))
        .thread_name(move |i| format!("{name}-{i}"))
        .start_handler(|_| lower_priority())
        .build()
        .map_err(io::Error::other)
}
