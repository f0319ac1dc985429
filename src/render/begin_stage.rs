//! The beginning of a stage of a frame.

/// Begins a stage: starts its clock, a variable of the given name, and names the stage for profilers
/// until the end of the block. Without a profiler, the name costs nothing.
macro_rules! begin_stage {
    ($start:ident, $name:literal) => {
        profiling::scope!($name);
        let $start = std::time::Instant::now();
    };
}

pub(super) use begin_stage;
