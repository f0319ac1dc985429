//! Thread pools below the window's priority.

use rayon::ThreadPool;
use std::io;

/// Niceness of all threads that trace. The window and the threads of a software rasteriser run
/// first: on two cores without a graphics card, the window was updated every 300 ms while the
/// gallery was rendered, and every 75 ms with this value.
const NICENESS: i32 = 10;

/// What is added for threads that trace references: half the weight of frames, which must not be
/// late in motion. Not less, because references make the following frames cheaper.
const NICENESS_OF_REFERENCES: i32 = 3;

/// Lowers the priority of the calling thread.
pub(crate) fn lower_priority() {
    lower_priority_by(NICENESS);
}

fn lower_priority_by(niceness: i32) {
    // On other systems, this would lower the priority of the whole process. If the system refuses,
    // all threads have equal shares, which is correct but slower to react.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(niceness);
    #[cfg(not(target_os = "linux"))]
    let _ = niceness;
}

/// Returns a pool of at least one thread, named `name-0`, `name-1`, ..., of low priority.
///
/// # Errors
/// Where the system refuses to start the threads.
pub(crate) fn background_pool(name: &'static str, threads: usize) -> io::Result<ThreadPool> {
    pool_below(NICENESS, name, threads)
}

/// Returns a pool for references, whose priority is below that of frames.
///
/// # Errors
/// Where the system refuses to start the threads.
pub(crate) fn reference_pool(threads: usize) -> io::Result<ThreadPool> {
    pool_below(NICENESS + NICENESS_OF_REFERENCES, "reference", threads)
}

fn pool_below(niceness: i32, name: &'static str, threads: usize) -> io::Result<ThreadPool> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.max(1))
        .thread_name(move |i| format!("{name}-{i}"))
        .start_handler(move |_| lower_priority_by(niceness))
        .build()
        .map_err(io::Error::other)
}
