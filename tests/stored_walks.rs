//! Walks that read their references from a store.

use crate::rooms::{dvec, room_camera, room_tracer};
use afterimage::camera::{CameraKey, CameraPath};
use afterimage::experiment::{TourEvent, TourRecord, TourSettings, run_tour};
use afterimage::scene::{SceneEdit, builtin};
use afterimage::store::{RecordSummary, StoreIndex, StoreSession, StoreSettings, prune};
use afterimage::trace::{TraceSettings, parallel::NEVER};
use afterimage::{Mode, RenderSettings, Tracer, Walkthrough, WalkthroughSettings};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Walks two metres. Returns the record and the problems of the store.
fn walk(tracer: &Arc<Tracer>, mode: Mode, store: Option<&Path>) -> (TourRecord, Vec<String>) {
    let key = |z: f64| CameraKey::new(dvec(0.2, 1.5, z), dvec(-0.2, 1.2, z - 7.5));
    let path = CameraPath { fov_y_deg: 65.0, frames: 6, keyframes: vec![key(3.5), key(1.5)] };
    let trace = TraceSettings { samples: 2, bounces: 1, seed: 3 };
    let render = RenderSettings { mode, trace };
    let settings = TourSettings {
        walkthrough: WalkthroughSettings { render, ..WalkthroughSettings::default() },
        size: [64, 48],
        frames: 6,
        budget: None,
        measure: None,
        store: store.map(|folder| StoreSettings { folder: folder.to_owned(), max_bytes: 1 << 30 }),
        warms_up: true,
    };
    let mut problems = Vec::new();
    let record = run_tour(tracer, &path, &settings, &AtomicBool::new(false), |event| {
        if let TourEvent::StoreProblem(problem) = event {
            problems.push(problem.to_owned());
        }
    });
    (record.unwrap(), problems)
}

/// Shares of pixel types and references of each frame.
fn frames(record: &TourRecord) -> Vec<String> {
    record.frames.iter().map(|f| format!("{:?} {}", f.types, f.references_held)).collect()
}

#[test]
fn a_second_walk_reads_what_the_first_has_lit() {
    let tracer = Arc::new(room_tracer(true, true));
    for mode in [Mode::Exact, Mode::Fast, Mode::Paper] {
        let folder = tempfile::tempdir().unwrap();
        let (first, problems) = walk(&tracer, mode, Some(folder.path()));
        assert!(problems.is_empty() && first.store.references_from_store == 0);
        assert!(first.store.references_to_store > 0 && first.store.store_bytes > 0);
        // Writing changes nothing.
        assert_eq!(frames(&first), frames(&walk(&tracer, mode, None).0));
        let (second, problems) = walk(&tracer, mode, Some(folder.path()));
        assert!(problems.is_empty(), "{problems:?}");
        assert!(second.store.references_from_store > 0, "{mode:?}");
        assert!(second.references_added <= first.references_added);
        let traced = |record: &TourRecord| record.frames[0].types.type3_percent;
        assert!(traced(&second) < traced(&first) / 2.0, "{mode:?}: {}", traced(&second));
    }
}

#[test]
fn a_store_of_another_scene_or_without_a_whole_record_changes_nothing() {
    let tracer = Arc::new(room_tracer(true, true));
    let folder = tempfile::tempdir().unwrap();
    let right = frames(&walk(&tracer, Mode::Exact, None).0);
    walk(&Arc::new(room_tracer(false, true)), Mode::Exact, Some(folder.path()));
    let (record, problems) = walk(&tracer, Mode::Exact, Some(folder.path()));
    assert_eq!((frames(&record), record.store.references_from_store), (right.clone(), 0));
    assert!(problems.is_empty());
    for (segment, ..) in StoreIndex::read(folder.path()).unwrap().records() {
        let mut bytes = std::fs::read(segment).unwrap();
        bytes.chunks_mut(50).for_each(|part| part[0] ^= 0x55);
        std::fs::write(segment, bytes).unwrap();
    }
    let (record, problems) = walk(&tracer, Mode::Exact, Some(folder.path()));
    assert_eq!((frames(&record), record.store.references_from_store), (right, 0));
    assert!(!problems.is_empty());
}

#[test]
fn a_walk_without_access_to_its_store_goes_on_and_says_so_once() {
    let tracer = Arc::new(room_tracer(false, false));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "no folder").unwrap();
    let right = frames(&walk(&tracer, Mode::Exact, None).0);
    for store in [file.clone(), file.join("below")] {
        let (record, problems) = walk(&tracer, Mode::Exact, Some(&store));
        assert_eq!((frames(&record), problems.len()), (right.clone(), 1), "{problems:?}");
    }
}

#[test]
fn a_view_at_rest_goes_on_with_the_light_of_earlier_visits() {
    let tracer = Arc::new(room_tracer(true, true));
    let folder = tempfile::tempdir().unwrap();
    let store = StoreSettings { folder: folder.path().to_owned(), max_bytes: 1 << 30 };
    let trace = TraceSettings { samples: 1, bounces: 1, seed: 3 };
    let render = RenderSettings { mode: Mode::Exact, trace };
    let mut last = 0;
    for visit in 0..3 {
        let settings = WalkthroughSettings { render, ..WalkthroughSettings::default() };
        let mut walk = Walkthrough::new(Arc::clone(&tracer), settings);
        walk.set_store(Some(StoreSession::open(&store, &tracer, true).unwrap()));
        walk.render(&room_camera(), [45, 27], NEVER);
        let frame = walk.frame();
        assert_eq!(frame.stats.types.percentages().unseen_percent > 50.0, visit == 0);
        let state = walk.refine(NEVER);
        assert!(state.is_complete && state.light_samples >= last + 16, "{visit}: {state:?}");
        last = state.light_samples;
        // The process is killed: what was not written before the end of the visit is lost.
        let read = walk.store_mut().unwrap().report().references_read;
        assert!(read <= 3, "records of one view that were refined further are not read: {read}");
        walk.store_mut().unwrap().finish();
        std::mem::forget(walk);
    }
    // Of the records of the view, the last holds the light of all.
    let before = StoreIndex::read(folder.path()).unwrap().len();
    let after = prune(folder.path(), u64::MAX).unwrap();
    // The first visit also kept its frame.
    assert_eq!((before, after.records, after.duplicates), (4, 2, 2));
    let samples = |(_, summary, _): (_, &RecordSummary, _)| summary.settings.samples;
    assert_eq!(StoreIndex::read(folder.path()).unwrap().records().map(samples).max(), Some(last));
}

/// The same scene with other materials.
fn edited(tracer: &Tracer, change: impl FnOnce(&mut SceneEdit)) -> Arc<Tracer> {
    let mut edit = tracer.scene().to_edit();
    change(&mut edit);
    Arc::new(Tracer::new(Arc::new(tracer.scene().with_edit(&edit))))
}

#[test]
fn what_an_edit_left_of_stored_light_is_used_and_the_rest_is_marked() {
    let tracer = Arc::new(Tracer::new(Arc::new(builtin::build("cornell").unwrap())));
    let named = |name: &str| tracer.scene().materials.iter().position(|m| m.name == name).unwrap();
    let (green, lamp) = (named("green"), named("lamp"));
    let painted = edited(&tracer, |edit| edit.materials[green].diffuse *= 0.97);
    let dimmed = edited(&tracer, |edit| edit.materials[lamp].emission *= 0.5);
    let folder = tempfile::tempdir().unwrap();
    let store = StoreSettings { folder: folder.path().to_owned(), max_bytes: 1 << 30 };
    let visit = |tracer: &Arc<Tracer>| {
        let trace = TraceSettings { samples: 8, bounces: 2, seed: 3 };
        let render = RenderSettings { mode: Mode::Exact, trace };
        let settings = WalkthroughSettings { render, ..WalkthroughSettings::default() };
        let mut walk = Walkthrough::new(Arc::clone(tracer), settings);
        walk.set_store(Some(StoreSession::open(&store, tracer, true).unwrap()));
        walk.render(tracer.scene().start(), [48, 40], NEVER);
        let unseen = walk.frame().stats.types.percentages().unseen_percent;
        let read: Vec<[usize; 2]> =
            walk.cache().entries().iter().map(|entry| [entry.frame.lit(), entry.frame.stale()]).collect();
        drop(walk.set_store(None));
        (unseen, read)
    };
    let (all, _) = visit(&tracer);
    assert!(all > 30.0, "{all}");
    // Half of the light: all is stale, and kept as a preview.
    let (unseen, held) = visit(&dimmed);
    assert!(unseen > 0.95 * all && held[0][0] < 10 && held[0][1] > 1000, "{unseen} of {all} {held:?}");
    // A wall that is a little darker changes the light near it.
    let (unseen, held) = visit(&painted);
    assert!(unseen > 0.02 * all && unseen < 0.8 * all, "{unseen} of {all}");
    assert!(held[0].iter().all(|&count| count > 0), "{held:?}");
    // What was traced again is whole.
    for tracer in [&tracer, &painted, &dimmed] {
        let (unseen, _) = visit(tracer);
        assert!(unseen < 0.1 * all, "{unseen} of {all}");
    }
}
