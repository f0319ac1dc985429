//! A bake of the scene that is shown, and what the store lights of its floor, in the background.

use super::{Task, TaskError, TaskHandle, Wake, reference_pool, spawn_activity, spawn_task};
use afterimage::Tracer;
use afterimage::render::bake::{
    BakePlacement, BakePlan, BakeProgress, BakeReport, BakeSettings, FloorCover, bake,
};
use afterimage::store::{StoreBuilder, StoreIndex, StoreSettings};
use afterimage::trace::{TraceSettings, parallel::Stop};
use glam::DVec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Size of baked references. It does not follow the window, so that the next session continues the
/// same plan.
const SIZE: [u32; 2] = [1280, 720];

/// Samples of baked references, as of `afterimage bake`.
const SAMPLES: u32 = 16;

/// Time between two looks at whether the viewer is at rest.
const PAUSE: Duration = Duration::from_millis(20);

/// A bake that is running.
pub(crate) struct Baking {
    pub(crate) task: Task<BakeReport>,
    /// The scene that is baked.
    pub(crate) tracer: Arc<Tracer>,
    /// While this is set, the bake waits.
    pub(crate) waits: Arc<AtomicBool>,
}

/// The floor as it is shown: the places and what the store lights from them.
pub(crate) struct ShownFloor {
    pub(crate) cover: Arc<FloorCover>,
    pub(crate) places: Vec<(DVec3, f32)>,
}

/// Starts to bake a scene into a store, with bounces and seed of `trace`.
pub(crate) fn start_baking(
    tracer: &Arc<Tracer>,
    store: &StoreSettings,
    trace: &TraceSettings,
    threads: usize,
    wake: Wake,
) -> Baking {
    let waits = Arc::<AtomicBool>::default();
    let (scene, store, is_waiting) = (tracer.clone(), store.clone(), waits.clone());
    let trace = TraceSettings { samples: SAMPLES, ..*trace };
    let task = spawn_activity("bake", "baking", wake, move |task| {
        let pool = reference_pool(threads).map_err(TaskError::failed)?;
        let stop = || {
            while is_waiting.load(Ordering::Relaxed) && !task.is_cancelled() {
                std::thread::sleep(PAUSE);
            }
            task.is_cancelled()
        };
        pool.install(|| work(&scene, &store, &trace, &stop, task))
    });
    Baking { task, tracer: tracer.clone(), waits }
}

fn work(
    tracer: &Arc<Tracer>,
    store: &StoreSettings,
    trace: &TraceSettings,
    stop: Stop<'_>,
    task: &TaskHandle,
) -> Result<BakeReport, TaskError> {
    task.begin("planning")?;
    let plan = BakePlan::new(tracer, &BakePlacement::Greedy, SIZE, stop);
    if task.is_cancelled() {
        return Err(TaskError::Cancelled);
    }
    let plan = plan.map_err(|error| TaskError::Failed(format!("the scene cannot be baked: {error}")))?;
    let mut store = StoreBuilder::open(store, tracer).map_err(TaskError::failed)?;
    let settings = BakeSettings { trace: *trace, shard: [0, 1], repeats: false };
    let (start, mut first) = (Instant::now(), None);
    let report = bake(&plan, &settings, &mut store, stop, |now| {
        let first = *first.get_or_insert(now.part);
        let left = remaining(start.elapsed(), [first, now.part]);
        task.report(&words(now, left), now.part as f32);
    });
    match report.problem {
        Some(problem) => Err(TaskError::failed(problem)),
        None => Ok(report),
    }
}

/// Time that is left, from the time in which a part of the work rose from one value to another.
fn remaining(elapsed: Duration, [from, now]: [f64; 2]) -> Option<Duration> {
    let left = elapsed.as_secs_f64() * (1.0 - now) / (now - from);
    Duration::try_from_secs_f64(left).ok().filter(|_| now > from)
}

fn words(now: &BakeProgress, left: Option<Duration>) -> String {
    let left = left.map_or(String::new(), |left| match left.as_secs() {
        secs @ 0..90 => format!(", about {secs} s left"),
        secs => format!(", about {} min left", secs.div_ceil(60)),
    });
    format!("{} of {} references, {:.0} % lit{left}", now.stored, now.planned, 100.0 * now.covered)
}

/// Starts to find out what a store lights of the floor. `cover` is what is known of the same scene.
pub(crate) fn start_floor(
    tracer: &Arc<Tracer>,
    cover: Option<Arc<FloorCover>>,
    store: &StoreSettings,
    bounces: u32,
    wake: Wake,
) -> Task<ShownFloor> {
    let (tracer, folder) = (tracer.clone(), store.folder.clone());
    spawn_task("floor", wake, move |task| {
        let pool = reference_pool(1).map_err(TaskError::failed)?;
        pool.install(|| {
            let find = || FloorCover::new(&tracer, SIZE, &|| task.is_cancelled()).map(Arc::new);
            let cover = cover.or_else(find).ok_or(TaskError::Cancelled)?;
            let index = StoreIndex::read(&folder).map_err(TaskError::failed)?;
            let places = cover.shares(&index, bounces);
            Ok(ShownFloor { cover, places })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::scene::builtin;

    #[test]
    fn the_remaining_time_follows_from_the_part_that_was_done_since_the_start() {
        let after = |secs, parts| remaining(Duration::from_secs(secs), parts);
        assert_eq!(after(10, [0.5, 0.75]), Some(Duration::from_secs(10)));
        assert_eq!(after(10, [0.5, 0.5]), None);
        assert_eq!(after(10, [0.0, 1.0]), Some(Duration::ZERO));
    }

    #[test]
    fn a_bake_that_is_cancelled_while_it_waits_ends() {
        let tracer = Tracer::new(Arc::new(builtin::build("cornell").unwrap())).with_start_view();
        let folder = tempfile::tempdir().unwrap();
        let store = StoreSettings { folder: folder.path().to_owned(), max_bytes: 1 << 30 };
        let baking = start_baking(&Arc::new(tracer), &store, &TraceSettings::default(), 1, Arc::new(|| {}));
        baking.waits.store(true, Ordering::Relaxed);
        baking.task.cancel_and_wait();
    }
}
