//! Bakes: plans, shards, interruptions, and walks that use what was baked.

use crate::rooms::{dvec, quad, room_tracer};
use afterimage::camera::{CameraPath, View};
use afterimage::math::Ray;
use afterimage::render::bake::{BakeError, BakePlacement, BakePlan, BakeReport, BakeSettings, bake};
use afterimage::scene::{Material, SceneBuilder};
use afterimage::store::{StoreBuilder, StoreError, StoreIndex, StoreSession, StoreSettings, merge};
use afterimage::trace::{TraceSettings, parallel::NEVER, parallel::Stop};
use afterimage::{Camera, Mode, RenderSettings, Tracer, Walkthrough, WalkthroughSettings};
use glam::Vec3;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

const SIZE: [u32; 2] = [64, 48];
const TRACE: TraceSettings = TraceSettings { samples: 2, bounces: 1, seed: 3 };
const SETTINGS: BakeSettings = BakeSettings { trace: TRACE, shard: [0, 1], repeats: false };

static ROOM: LazyLock<Arc<Tracer>> = LazyLock::new(|| Arc::new(room_tracer(true, true).with_start_view()));
static PLAN: LazyLock<BakePlan> = LazyLock::new(|| plan(&ROOM, &BakePlacement::Greedy));

fn plan(tracer: &Tracer, placement: &BakePlacement) -> BakePlan {
    BakePlan::new(tracer, placement, SIZE, NEVER).unwrap()
}

fn open(folder: &Path) -> StoreBuilder {
    StoreBuilder::open(&StoreSettings { folder: folder.to_owned(), max_bytes: 1 << 30 }, &ROOM).unwrap()
}

/// Bakes the room into a folder.
fn bake_into(folder: &Path, settings: &BakeSettings, stop: Stop<'_>) -> BakeReport {
    bake(&PLAN, settings, &mut open(folder), stop, |_| {})
}

/// Checks that two stores have the same records, bit for bit, except for the time of writing.
fn assert_same(folder: &Path, other: &Path, records: usize) {
    let counts = [folder, other].map(|folder| StoreIndex::read(folder).unwrap().len());
    assert_eq!(counts, [records; 2]);
    let report = merge(folder, &[other.to_owned()]).unwrap();
    assert_eq!((report.added, report.duplicates, report.records), (0, records, records));
}

#[test]
fn shards_together_have_the_bits_of_one_process() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, joined] = ["whole", "joined"].map(|name| folder.path().join(name));
    let report = bake_into(&whole, &SETTINGS, NEVER);
    assert_eq!((report.traced, report.already_stored, report.passes), (PLAN.len(), 0, 1));
    assert!(report.covered > 0.9 && PLAN.len() > 4, "{report:?}, {} references", PLAN.len());
    let shards: Vec<_> = (0..4).map(|shard| folder.path().join(shard.to_string())).collect();
    // The order does not matter, nor does the number of threads.
    for shard in [2, 0, 3, 1] {
        let settings = BakeSettings { shard: [shard, 4], ..SETTINGS };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1 + shard as usize).build().unwrap();
        pool.install(|| bake_into(&shards[shard as usize], &settings, NEVER));
    }
    merge(&joined, &shards).unwrap();
    assert_same(&whole, &joined, PLAN.len());
    // Nothing is left to do.
    let report = bake_into(&joined, &SETTINGS, NEVER);
    assert_eq!(
        (report.traced, report.already_stored, report.covered),
        (0, PLAN.len(), report.progress.covered)
    );
}

#[test]
fn a_bake_that_was_interrupted_is_continued_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    bake_into(&whole, &SETTINGS, NEVER);
    let (mut runs, mut traced) = (0, 0);
    while runs < 100 {
        // Somewhere within a reference, sooner or later.
        let (asked, limit) = (AtomicUsize::new(0), 3000 + 1777 * runs);
        let stop = || asked.fetch_add(1, Ordering::Relaxed) > limit;
        let report = bake_into(&parts, &SETTINGS, &stop);
        assert_eq!(report.already_stored, traced);
        traced += report.traced;
        runs += 1;
        if report.passes == 1 {
            break;
        }
    }
    assert!(runs > 2 && traced == PLAN.len(), "{runs} runs, {traced} references");
    assert_same(&whole, &parts, PLAN.len());
}

#[test]
fn further_passes_have_twice_the_samples_and_random_numbers_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let passes = AtomicUsize::new(0);
    let settings = BakeSettings { shard: [1, 3], repeats: true, ..SETTINGS };
    let stop = || passes.load(Ordering::Relaxed) > 1;
    let mut store = open(folder.path());
    let report = bake(&PLAN, &settings, &mut store, &stop, |now| {
        passes.store(now.pass as usize, Ordering::Relaxed);
    });
    let own = PLAN.len().div_ceil(3) - usize::from(PLAN.len() % 3 == 1);
    assert_eq!((report.passes, report.traced), (2, 2 * own));
    let index = StoreIndex::read(folder.path()).unwrap();
    let all: Vec<_> = index.records().map(|(_, record, _)| record.settings).collect();
    assert_eq!(all.iter().filter(|settings| settings.samples == 2).count(), own);
    assert_eq!(all.iter().filter(|settings| settings.samples == 4).count(), own);
    for (at, settings) in all.iter().enumerate() {
        assert!(!all[..at].iter().any(|other| other.seed == settings.seed), "{settings:?}");
        assert_eq!(settings.seed as u32, 3);
    }
}

#[test]
fn a_plan_is_the_same_at_any_number_of_threads() {
    let words = |plan: &BakePlan| -> Vec<(Camera, TraceSettings)> {
        plan.cameras().enumerate().map(|(at, camera)| (*camera, plan.settings(at, &TRACE, 0))).collect()
    };
    for placement in [BakePlacement::Greedy, BakePlacement::Grid, BakePlacement::along(&short_walk())] {
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| words(&plan(&ROOM, &placement)))
        });
        // The settings contain a hash of the mask.
        assert!(one == three && !one.is_empty(), "{placement:?}");
    }
}

fn short_walk() -> CameraPath {
    CameraPath {
        frames: 8,
        ..CameraPath::turning(&Camera::look_at(dvec(0.2, 1.5, 3.0), dvec(0.0, 1.5, 0.0), 60.0))
    }
}

/// A point that a view sees.
struct Seen {
    position: Vec3,
    normal: Vec3,
    /// Samples of the view per area.
    density: f32,
}

/// True if a reference of a plan lights a point: the point is in its picture, it sees the point,
/// lights one of the pixels around it, and has at least a fifth of the samples per area.
fn is_lit(tracer: &Tracer, plan: &BakePlan, (number, view): (usize, &View), seen: &Seen) -> bool {
    let offset = seen.position - view.eye;
    let q = view.scene_from_pixel.inverse() * offset;
    let [x, y] = [q.x / q.z, q.y / q.z];
    let is_inside = q.z > 0.0 && x >= 0.0 && y >= 0.0 && x < SIZE[0] as f32 && y < SIZE[1] as f32;
    let faces = seen.normal.dot(offset) < 0.0;
    if !is_inside || !faces || 5.0 * density(view, offset, seen.normal, q.z) < seen.density {
        return false;
    }
    let near = |at: f32, edge: u32| [-0.5, 0.5].map(|d| (at + d).clamp(0.0, edge as f32 - 1.0) as u32);
    let rows = near(y, SIZE[1]).into_iter();
    let mut pixels = rows.flat_map(|y| near(x, SIZE[0]).map(|x| y * SIZE[0] + x));
    let ray = Ray { t_max: 0.999, ..Ray::new(view.eye, offset) };
    pixels.any(|pixel| plan.lights(number, pixel)) && tracer.closest(&ray).is_none()
}

fn density(view: &View, offset: Vec3, normal: Vec3, depth: f32) -> f32 {
    -normal.dot(offset) / (view.scene_from_pixel.x_axis.length_squared() * depth.powi(3))
}

#[test]
fn what_a_pose_of_the_plan_sees_some_reference_lights_as_finely() {
    let tracer = room_tracer(false, false).with_start_view();
    let plan = plan(&tracer, &BakePlacement::Greedy);
    let views: Vec<View> =
        plan.cameras().map(|camera| View::new(camera, &tracer.scene().frame, SIZE)).collect();
    let (mut pixels, mut dark) = (0, 0);
    for view in &views {
        for pixel in (0..SIZE[0] * SIZE[1]).step_by(7) {
            let ray = Tracer::primary_ray(view, pixel);
            let Some(hit) = tracer.closest(&ray) else { continue };
            let [a, b, c] = tracer.scene().corners(hit.triangle);
            let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
            let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
            let offset = ray.direction * hit.t;
            let density = density(view, offset, normal, hit.t);
            let seen = Seen { position: view.eye + offset, normal, density };
            pixels += 1;
            let mut references = views.iter().enumerate();
            dark += u32::from(!references.any(|reference| is_lit(&tracer, &plan, reference, &seen)));
        }
    }
    assert!(pixels > 1000 && dark * 200 < pixels, "{dark} of {pixels} pixels are left dark");
}

#[test]
fn a_walk_after_a_bake_has_little_left_to_trace() {
    let folder = tempfile::tempdir().unwrap();
    bake_into(folder.path(), &SETTINGS, NEVER);
    let settings = StoreSettings { folder: folder.path().to_owned(), max_bytes: 1 << 30 };
    let unseen = |store: bool| {
        let render = RenderSettings { mode: Mode::Exact, trace: TRACE };
        let mut walk = Walkthrough::new(ROOM.clone(), WalkthroughSettings { render, ..Default::default() });
        walk.set_store(store.then(|| StoreSession::open(&settings, &ROOM, true).unwrap()));
        let walk_to = |z: f64| Camera::look_at(dvec(0.2, 1.5, z), dvec(-0.2, 1.2, -4.0), 65.0);
        let frames = [3.4, 2.9, 2.0].map(|z| walk.render(&walk_to(z), SIZE, NEVER).stats.types.unseen);
        frames.iter().sum::<usize>()
    };
    let [without, with] = [false, true].map(unseen);
    assert!(with * 20 < without, "{with} of {without} unseen pixels are left");
}

#[test]
fn what_cannot_be_baked_is_said_in_one_line() {
    let mut dark = ROOM.scene().as_ref().clone();
    dark.lights.clear();
    let dark = Tracer::new(Arc::new(dark));
    let mut b = SceneBuilder::new("a wall in the air");
    let wall = b.add_material(Material::diffuse("wall", Vec3::ONE));
    quad(&mut b, dvec(-1.0, 0.0, -3.0), dvec(2.0, 0.0, 0.0), dvec(0.0, 2.0, 0.0), wall);
    let error = |tracer: &Tracer, placement: &BakePlacement| -> BakeError {
        BakePlan::new(tracer, placement, SIZE, NEVER).unwrap_err()
    };
    assert_eq!(error(&dark, &BakePlacement::Greedy), BakeError::NoLight);
    let lamp = b.add_material(Material::emissive("lamp", Vec3::ONE));
    quad(&mut b, dvec(3.0, 0.0, -3.0), dvec(2.0, 0.0, 0.0), dvec(0.0, 2.0, 0.0), lamp);
    let floating = Tracer::new(Arc::new(b.finish().unwrap()));
    assert_eq!(error(&floating, &BakePlacement::Greedy), BakeError::NoPlace);
    assert_eq!(error(&floating, &BakePlacement::Grid), BakeError::NoPlace);
    assert_eq!(error(&floating, &BakePlacement::along(&CameraPath::default())), BakeError::EmptyPath);
    let away = CameraPath::still(&Camera::look_at(dvec(0.0, 1.0, 5.0), dvec(0.0, 1.0, 9.0), 60.0));
    assert_eq!(error(&floating, &BakePlacement::along(&away)), BakeError::NothingSeen);
    let stopped = BakePlan::new(&ROOM, &BakePlacement::Greedy, SIZE, &|| true);
    assert_eq!(stopped.unwrap_err(), BakeError::Stopped);
}

#[test]
fn a_store_that_is_full_or_cannot_be_written_keeps_what_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let settings = StoreSettings { folder: folder.path().to_owned(), max_bytes: 100_000 };
    let mut store = StoreBuilder::open(&settings, &ROOM).unwrap();
    let report = bake(&PLAN, &SETTINGS, &mut store, NEVER, |_| {});
    assert!(matches!(report.problem, Some(StoreError::Full { .. })), "{report:?}");
    let index = StoreIndex::read(folder.path()).unwrap();
    assert!(index.len() == report.traced && report.traced > 0 && index.bytes() <= 100_000);
    let file = folder.path().join("file");
    std::fs::write(&file, "no folder").unwrap();
    for folder in [file.clone(), file.join("below")] {
        let opened = StoreBuilder::open(&StoreSettings { folder, max_bytes: 1 << 30 }, &ROOM);
        assert!(matches!(opened.err(), Some(StoreError::Write { .. } | StoreError::Folder { .. })));
    }
}
