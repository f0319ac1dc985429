//! The measured walk on a small room.

use crate::rooms::{dvec, room_camera, room_tracer};
use afterimage::camera::{CameraKey, CameraPath};
use afterimage::experiment::run::csv;
use afterimage::experiment::statistics::{geometric_mean, median, percentile};
use afterimage::experiment::throughput::{ThroughputSettings, measure_throughput};
use afterimage::experiment::{MeasureSettings, Measurement, TourEvent, TourRecord, TourSettings, run_tour};
use afterimage::reference::PlacementPolicy;
use afterimage::reference::placement::{NONE, THRESHOLD};
use afterimage::trace::TraceSettings;
use afterimage::{Mode, RenderSettings, WalkthroughSettings};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Two metres through a room with a mirror.
fn path() -> CameraPath {
    let key = |z: f64| CameraKey::new(dvec(0.2, 1.5, z), dvec(-0.2, 1.2, z - 7.5));
    CameraPath { fov_y_deg: 65.0, frames: 9, keyframes: vec![key(3.5), key(1.5)] }
}

fn settings(measure: Option<&Path>) -> TourSettings {
    let trace = TraceSettings { samples: 4, bounces: 0, seed: 3 };
    let walkthrough = WalkthroughSettings {
        render: RenderSettings { mode: Mode::Paper, trace },
        placement: PlacementPolicy::new(&THRESHOLD, 5.0),
        ..WalkthroughSettings::default()
    };
    let measure = measure.map(|folder| MeasureSettings {
        every: 4,
        truth_samples: 64,
        truth_folder: Some(folder.to_owned()),
        exposure_ev: 0.0,
    });
    TourSettings {
        walkthrough,
        size: [64, 48],
        frames: 9,
        budget: None,
        measure,
        store: None,
        warms_up: true,
    }
}

fn walk(settings: &TourSettings, cancel: &AtomicBool) -> TourRecord {
    let tracer = Arc::new(room_tracer(true, false));
    run_tour(&tracer, &path(), settings, cancel, |_| ()).unwrap()
}

/// The parts of a record that do not depend on the clock.
fn without_times(record: &TourRecord) -> Vec<String> {
    record
        .frames
        .iter()
        .map(|f| format!("{:?} {:?} {:?} {:?}", f.pose, f.types, f.rays, f.references_used))
        .collect()
}

#[test]
fn a_walk_starts_without_references_and_reuses_them_later() {
    let record = walk(&settings(None), &AtomicBool::new(false));
    assert_eq!(record.frames.len(), 9);
    assert!(record.is_complete && record.warm_up_secs > 0.0);
    let first = &record.frames[0];
    assert_eq!((first.types.type3_percent, first.references_used, first.warped_pixels), (100.0, 0, 0));
    assert!(first.reference_added && first.reference_secs > 0.0);
    let second = &record.frames[1];
    assert_eq!(second.references_used, 1);
    assert!(second.types.type1_percent > 50.0 && second.types.type2_percent > 0.0, "{second:?}");
    for f in &record.frames {
        let t = &f.types;
        assert!((t.type1_percent + t.type2_percent + t.type3_percent - 100.0).abs() < 1e-9);
        assert!((t.unseen_percent + t.uncertain_percent - t.type3_percent).abs() < 1e-9);
        assert_eq!(f.reference_added, f.reference_secs > 0.0);
    }
    assert_eq!(record.references_added, record.frames.iter().filter(|f| f.reference_added).count());
    let spent: f64 = record.references.iter().map(|r| r.secs).sum();
    assert!((spent - record.reference_secs_total).abs() < 1e-12);
    assert!(!record.frames[8].reference_added, "no frame would use a reference after the last one");
}

#[test]
fn a_walk_is_reproducible() {
    let [a, b] = [0, 1].map(|_| walk(&settings(None), &AtomicBool::new(false)));
    assert_eq!(without_times(&a), without_times(&b));
}

#[test]
fn without_a_policy_every_frame_is_traced_in_full() {
    let mut settings = settings(None);
    settings.walkthrough.placement = PlacementPolicy::new(&NONE, 0.0);
    let record = walk(&settings, &AtomicBool::new(false));
    assert_eq!(record.references_added, 0);
    assert!(record.frames.iter().all(|f| f.types.type3_percent == 100.0));
}

#[test]
fn a_stopped_walk_keeps_its_frames() {
    let tracer = Arc::new(room_tracer(true, false));
    let cancel = AtomicBool::new(false);
    let observe = |event: TourEvent<'_>| {
        if matches!(event, TourEvent::Frame(record, _) if record.frame == 2) {
            cancel.store(true, Ordering::Relaxed);
        }
    };
    let record = run_tour(&tracer, &path(), &settings(None), &cancel, observe).unwrap();
    assert_eq!((record.frames.len(), record.is_complete), (3, false));
}

#[test]
fn a_measured_walk_has_errors_and_stores_converged_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let settings = settings(Some(folder.path()));
    let first = walk(&settings, &AtomicBool::new(false));
    let measured: Vec<_> = first.frames.iter().filter_map(|f| f.measurement).collect();
    assert_eq!(measured.len(), 3);
    // Frame 0 has no reference, so it is the fully traced picture itself.
    assert_eq!(measured[0].psnr_db, measured[0].full_psnr_db);
    assert_eq!(measured[0].see_through_percent, 0.0);
    assert!(measured.iter().all(|m| m.full_psnr_db > 20.0 && m.full_psnr_db < 900.0), "{measured:?}");
    let sum = first.summary.measured.as_ref().unwrap();
    assert!(sum.speedup > 0.0 && sum.speedup_with_references < sum.speedup);
    let kept =
        || -> Vec<_> { std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().path()).collect() };
    assert_eq!(kept().len(), 3);
    // A damaged picture is traced again and the others are reused; the figures are the same.
    std::fs::write(&kept()[0], b"rubbish").unwrap();
    let second = walk(&settings, &AtomicBool::new(false));
    let figures = |r: &TourRecord| -> Vec<f64> {
        r.frames.iter().filter_map(|f| f.measurement).map(|m| m.psnr_db).collect()
    };
    assert_eq!(figures(&first), figures(&second));
    assert_eq!(kept().len(), 3);
}

#[test]
fn the_equal_error_speedup_counts_measured_frames_with_references() {
    let folder = tempfile::tempdir().unwrap();
    let record = walk(&settings(Some(folder.path())), &AtomicBool::new(false));
    let measured: Vec<_> = record.frames.iter().filter(|f| f.measurement.is_some()).collect();
    // Frame 0 is fully traced: it would add a ratio of one.
    assert_eq!(measured.iter().map(|f| f.references_used > 0).collect::<Vec<_>>(), [false, true, true]);
    let ratio = |m: &Measurement| m.full_mse / m.mse;
    let ratios = measured[1..].iter().filter_map(|f| f.measurement.as_ref()).map(ratio);
    let sum = record.summary.measured.unwrap();
    let expected = geometric_mean(ratios).unwrap() * sum.speedup_with_references;
    assert!((sum.equal_error_speedup.unwrap() / expected - 1.0).abs() < 1e-12);
    assert_eq!((sum.measured_frames, sum.measured_frames_with_references), (3, 2));
    let mut alone = settings(Some(folder.path()));
    alone.walkthrough.placement = PlacementPolicy::new(&NONE, 0.0);
    let sum = walk(&alone, &AtomicBool::new(false)).summary.measured.unwrap();
    assert_eq!((sum.equal_error_speedup, sum.measured_frames_with_references), (None, 0));
}

#[test]
fn all_pictures_of_a_measured_walk_are_compared_at_one_exposure() {
    let folder = tempfile::tempdir().unwrap();
    let measured = |exposure_ev: f32| {
        let mut settings = settings(Some(folder.path()));
        settings.measure = settings.measure.map(|m| MeasureSettings { exposure_ev, ..m });
        walk(&settings, &AtomicBool::new(false))
    };
    let [at_zero, darker] = [0.0, -6.0].map(measured);
    let of = |record: &TourRecord| record.frames.iter().find_map(|f| f.measurement).unwrap();
    assert_eq!([of(&at_zero).exposure_ev, of(&darker).exposure_ev], [0.0, -6.0]);
    assert_eq!(darker.summary.measured.as_ref().unwrap().exposure_ev, -6.0);
    for m in [of(&at_zero), of(&darker)] {
        assert!((m.psnr_db + 10.0 * m.mse.log10()).abs() < 1e-9, "{m:?}");
        assert!((m.full_psnr_db + 10.0 * m.full_mse.log10()).abs() < 1e-9, "{m:?}");
    }
    // Six stops darker, the noise is a sixty-fourth in linear light, and less in display values.
    assert!(of(&darker).mse < of(&at_zero).mse && of(&darker).full_mse < of(&at_zero).full_mse);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "truth is stored as radiance");
}

#[test]
fn a_table_has_a_column_per_number() {
    let folder = tempfile::tempdir().unwrap();
    let record = walk(&settings(Some(folder.path())), &AtomicBool::new(false));
    let table = csv(&record.frames);
    let lines: Vec<Vec<&str>> = table.lines().map(|l| l.split(',').collect()).collect();
    assert_eq!(lines.len(), 10);
    assert!(lines.iter().all(|l| l.len() == lines[0].len()));
    for name in
        ["frame", "pose.eye.x", "types.type3_percent", "rays.shadow", "frame_secs", "measurement.psnr_db"]
    {
        assert!(lines[0].contains(&name), "{name} in {:?}", lines[0]);
    }
    assert!(!lines[0].contains(&"measurement"));
    assert_eq!(csv::<TourRecord>(&[]), "\n");
}

#[test]
fn throughput_times_every_stage_and_dumps_its_rays() {
    let tracer = room_tracer(true, false);
    let trace = TraceSettings { samples: 2, bounces: 0, seed: 0 };
    let settings = ThroughputSettings { camera: room_camera(), size: [64, 48], trace };
    let (t, rays) = measure_throughput(&tracer, &settings, &|| false, |_| ()).unwrap();
    assert!(t.primary_mrays_per_sec > 0.0 && t.warp.warp_ns_per_reference_pixel > 0.0 && t.build_secs > 0.0);
    assert!(t.visibility.visibility_ns_per_pixel_one_core > 0.0);
    assert!(t.warp.warp_ns_per_reference_pixel_one_core > 0.0 && t.warp.warp_over_memory_floor > 0.0);
    assert_eq!((rays.any.len(), rays.closest.len()), (t.shadow_rays, t.primary_rays + t.diffuse_rays));
    let bytes = rays.to_bytes(&tracer);
    assert_eq!(&bytes[..8], b"RAYS0001");
    assert_eq!(bytes.len(), 8 + 8 + t.triangles * 36 + 16 + (rays.any.len() + rays.closest.len()) * 32);
    assert!(measure_throughput(&tracer, &settings, &|| true, |_| ()).is_none());
}

#[test]
fn medians_and_ranks() {
    assert_eq!(median([3.0, 1.0, 2.0]), Some(2.0));
    assert_eq!(median([4.0, 1.0, 2.0, 3.0]), Some(2.5));
    assert_eq!(median([]), None);
    assert_eq!(percentile((1..=200).map(f64::from), 99.0), Some(198.0));
    assert_eq!(percentile([5.0], 99.0), Some(5.0));
    assert_eq!(percentile([], 50.0), None);
    assert!((geometric_mean([0.5, 8.0, 2.0]).unwrap() - 2.0).abs() < 1e-12);
    assert_eq!(geometric_mean([]), None);
}
