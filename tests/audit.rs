//! Audits of looked-up frames: wrong references are found, right ones are left alone, and the
//! estimate contains the true error.

use crate::rooms::{cuboid, dvec, quad, room_camera, room_tracer};
use afterimage::reference::{ReferenceCache, ReferenceFrame};
use afterimage::render::audit::{Audited, Auditor};
use afterimage::render::{AuditEstimate, render_antialiased};
use afterimage::scene::{Material, SceneBuilder};
use afterimage::{
    Camera, FrameRequest, Mode, RenderSettings, Renderer, Tracer, Walkthrough, WalkthroughSettings,
    raster::load::display_of, raster::metrics::psnr_db, trace::TraceSettings, trace::parallel::NEVER,
};
use glam::{DVec3, Vec3};
use std::sync::Arc;

const SIZE: [u32; 2] = [96, 64];
const TRACE: TraceSettings = TraceSettings { samples: 4, bounces: 0, seed: 5 };

fn moved(forward_m: f64, turn: f64) -> Camera {
    let start = room_camera();
    Camera { eye: start.eye + start.forward() * forward_m, yaw: start.yaw + turn, ..start }
}

fn insert(cache: &mut ReferenceCache, tracer: &Tracer, camera: &Camera, seed: u64) {
    let trace = TraceSettings { seed, ..TRACE };
    cache.insert(Arc::new(ReferenceFrame::trace(tracer, camera, SIZE, &trace, NEVER).unwrap()));
}

/// Renders a view and audits `count` pixels of it.
fn audited(
    tracer: &Tracer,
    camera: &Camera,
    cache: &mut ReferenceCache,
    auditor: &mut Auditor,
    count: usize,
) -> (Vec<Vec3>, AuditEstimate) {
    let settings = RenderSettings { mode: Mode::Exact, trace: TRACE };
    let mut renderer = Renderer::default();
    let frame = renderer.render(&FrameRequest::new(tracer, camera, SIZE, &settings).reusing(cache));
    let estimate = auditor.check(&Audited { tracer, frame, trace: &TRACE }, cache, count);
    (frame.radiance.clone(), estimate)
}

fn truth(tracer: &Tracer, camera: &Camera) -> Vec<Vec3> {
    let trace = TraceSettings { samples: 512, seed: 77, ..TRACE };
    let settings = RenderSettings { mode: Mode::Full, trace };
    render_antialiased(&FrameRequest::new(tracer, camera, SIZE, &settings), 1).radiance
}

/// A room with a lamp of a given brightness.
fn lit_room(brightness: f32) -> Tracer {
    let mut b = SceneBuilder::new("lit room");
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.5)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(brightness)));
    cuboid(&mut b, dvec(-3.0, 0.0, -4.0), dvec(3.0, 3.0, 4.0), wall, true);
    cuboid(&mut b, dvec(-1.5, 0.0, -2.0), dvec(-0.5, 1.2, -1.0), wall, false);
    quad(&mut b, dvec(-0.6, 2.2, 0.4), DVec3::X * 1.2, DVec3::Z * 1.2, lamp);
    Tracer::new(Arc::new(b.finish().unwrap()))
}

#[test]
fn wrong_light_of_a_reference_is_found_and_forgotten() {
    let (tracer, brighter) = (lit_room(4.0), lit_room(12.0));
    let camera = moved(0.1, 0.02);
    let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
    insert(&mut cache, &tracer, &moved(0.0, 0.0), 1);
    let mut poisoned = ReferenceFrame::trace(&brighter, &moved(0.3, 0.0), SIZE, &TRACE, NEVER).unwrap();
    poisoned.epoch = tracer.epoch();
    let lit = poisoned.lit();
    let innocent = cache.entries()[0].frame.lit();
    cache.insert(Arc::new(poisoned));
    let right = display_of(&truth(&tracer, &camera));
    let mut auditor = Auditor::default();
    let psnr = |radiance: &[Vec3]| psnr_db(&display_of(radiance), &right);
    let (before, first) = audited(&tracer, &camera, &mut cache, &mut auditor, 384);
    assert!(first.wrong_percent > 5.0, "{first:?}");
    for _ in 0..40 {
        audited(&tracer, &camera, &mut cache, &mut auditor, 384);
    }
    let (after, last) = audited(&tracer, &camera, &mut cache, &mut auditor, 384);
    // Where both lights are white on a screen, no pixel looks wrong.
    assert!(last.forgotten_blocks >= 8, "{last:?}");
    assert_eq!(cache.entries()[0].frame.lit(), innocent, "the other reference is left alone");
    assert!(
        cache.entries()[1].frame.lit() * 4 < 3 * lit,
        "{} of {lit} still lit",
        cache.entries()[1].frame.lit()
    );
    assert!(psnr(&after) > psnr(&before) + 3.0, "{} dB became {} dB", psnr(&before), psnr(&after));
}

#[test]
fn right_light_is_never_forgotten() {
    for tracer in [room_tracer(true, true), lit_room(4.0)] {
        let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
        for i in 0..3 {
            insert(&mut cache, &tracer, &moved(0.4 * f64::from(i), 0.1 * f64::from(i)), 1 + i as u64);
        }
        let mut auditor = Auditor::default();
        let mut looked_up = 0;
        for i in 0..60 {
            let camera = moved(0.02 * f64::from(i), 0.004 * f64::from(i));
            let (_, estimate) = audited(&tracer, &camera, &mut cache, &mut auditor, 384);
            assert_eq!(estimate.forgotten_blocks, 0, "frame {i}");
            looked_up += 384;
        }
        assert!(looked_up > 20_000);
        assert!(cache.entries().iter().all(|e| e.frame.is_dense()));
    }
}

#[test]
fn the_estimate_covers_the_true_error() {
    let tracer = lit_room(4.0);
    for (turn, forward) in [(0.0, 0.15), (0.15, 0.5), (0.3, 1.2)] {
        let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
        insert(&mut cache, &tracer, &moved(0.0, 0.0), 1);
        insert(&mut cache, &tracer, &moved(0.3, 0.05), 2);
        let camera = moved(forward, turn);
        let mut auditor = Auditor::default();
        let (mut shown, mut estimate) = (Vec::new(), AuditEstimate::default());
        for _ in 0..100 {
            (shown, estimate) = audited(&tracer, &camera, &mut cache, &mut auditor, 384);
        }
        let right = psnr_db(&display_of(&shown), &display_of(&truth(&tracer, &camera)));
        let (low, high) = (estimate.psnr_low_db.unwrap(), estimate.psnr_high_db.unwrap());
        // The curvature of the display curve under noise adds a little to the interval.
        assert!((low - 0.5..high + 0.5).contains(&right), "{right} dB is not in {low}..{high} dB");
        assert!(estimate.plus_minus_db().unwrap() < 1.5 && estimate.pixels > 30_000, "{estimate:?}");
    }
}

#[test]
fn a_walk_is_audited_if_that_is_enabled() {
    let tracer = Arc::new(lit_room(4.0));
    let render = RenderSettings { mode: Mode::Exact, trace: TRACE };
    for (audits, mode) in [(true, Mode::Exact), (false, Mode::Exact), (true, Mode::Paper)] {
        let render = RenderSettings { mode, ..render };
        let mut walk = Walkthrough::new(
            tracer.clone(),
            WalkthroughSettings { render, audits, ..WalkthroughSettings::default() },
        );
        let stats = walk.render(&room_camera(), SIZE, NEVER).stats;
        let is_audited = audits && mode == Mode::Exact;
        assert_eq!(stats.audit.is_some_and(|a| a.pixels > 0), is_audited);
        assert_eq!(stats.secs.audit > 0.0, is_audited);
        assert!(stats.secs.frame >= stats.secs.audit);
    }
}
