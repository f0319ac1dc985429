//! Sections: closed forms of depth and cap, light that does not see them, and real models against
//! models that were cut beforehand.

mod real;

use crate::rooms::{cuboid, dvec, quad, room_camera, room_tracer};
use afterimage::reference::{ReferenceCache, ReferenceFrame};
use afterimage::scene::{Material, MaterialId, SceneBuilder, shapes};
use afterimage::trace::section::{CutPlane, SectionError, check_planes};
use afterimage::trace::{NO_TRIANGLE, TraceSettings, parallel::NEVER};
use afterimage::{Camera, Frame, FrameRequest, Mode, RenderSettings, Renderer, Tracer, View};
use glam::{DVec3, Vec3};
use std::sync::Arc;

const TONES: [f32; 2] = [0.5, 0.25];

/// A plane that keeps the smaller coordinates.
fn below(axis: usize, at_m: f64) -> CutPlane {
    CutPlane { axis, at_m, keeps_above: false }
}

fn built(name: &str, add: impl FnOnce(&mut SceneBuilder, MaterialId)) -> Tracer {
    let mut b = SceneBuilder::new(name);
    let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
    add(&mut b, grey);
    Tracer::new(Arc::new(b.finish().unwrap()))
}

fn cube() -> Tracer {
    built("cube", |b, grey| cuboid(b, dvec(-1.0, -1.0, -1.0), dvec(1.0, 1.0, 1.0), grey, false))
}

fn settings(mode: Mode) -> RenderSettings {
    RenderSettings { mode, trace: TraceSettings { samples: 2, bounces: 1, seed: 7 } }
}

fn render(tracer: &Tracer, camera: &Camera, size: [u32; 2], mode: Mode) -> Frame {
    let settings = settings(mode);
    Renderer::default().render(&FrameRequest::new(tracer, camera, size, &settings)).clone()
}

/// Area in square metres of the caps that a camera sees through a plane across x at `at_m`, looking
/// along -x; and the largest relative error of their depth.
fn cap_area(tracer: &Tracer, eye: DVec3, at_m: f64) -> (f64, f64) {
    let camera = Camera::look_at(eye, eye - DVec3::X, 60.0);
    let view = View::new(&camera, &tracer.scene().frame, [300, 300]);
    let depth = (eye.x - at_m) * tracer.scene().frame.units_per_metre;
    let caps =
        (0..view.pixel_count() as u32).filter_map(|pixel| tracer.cap(&Tracer::primary_ray(&view, pixel)));
    let (count, worst) = caps.fold((0, 0.0f64), |(count, worst), cap| {
        (count + 1, worst.max((f64::from(cap.t) / depth - 1.0).abs()))
    });
    let pixel_m = 2.0 * view.tan_half_fov_y as f64 / 300.0 * (eye.x - at_m);
    (f64::from(count) * pixel_m * pixel_m, worst)
}

#[test]
fn the_cap_of_a_box_has_its_area_and_depth() {
    for at_m in [-0.7, 0.0, 0.3] {
        let cut = cube().with_section(&[below(0, at_m)], TONES);
        let (area, worst) = cap_area(&cut, dvec(6.0, 0.1, 0.2), at_m);
        assert!((area / 4.0 - 1.0).abs() < 0.02, "{area} m2 at {at_m}");
        assert!(worst < 1e-3, "{worst}");
    }
}

/// Winding, overlap, doubled faces and hollows: what a cut through each shows, in square metres.
#[test]
fn caps_fill_closed_bodies_of_any_winding() {
    type Add = fn(&mut SceneBuilder, MaterialId);
    let cases: [(&str, f64, Add); 8] = [
        ("wound inwards", 4.0, |b, m| cuboid(b, dvec(-1.0, -1.0, -1.0), dvec(1.0, 1.0, 1.0), m, true)),
        ("two that overlap", 6.0, |b, m| {
            cuboid(b, dvec(-1.0, -1.0, -1.0), dvec(1.0, 1.0, 1.0), m, false);
            cuboid(b, dvec(-1.5, -1.0, 0.0), dvec(1.25, 1.0, 2.0), m, false);
        }),
        ("two side by side that share a face", 8.0, |b, m| {
            cuboid(b, dvec(-1.0, -1.0, -1.0), dvec(1.0, 1.0, 1.0), m, false);
            cuboid(b, dvec(-1.0, -1.0, 1.0), dvec(1.0, 1.0, 3.0), m, false);
        }),
        ("a face for each side", 4.0, |b, m| {
            cuboid(b, dvec(-1.0, -1.0, -1.0), dvec(1.0, 1.0, 1.0), m, false);
            cuboid(b, dvec(-1.0, -1.0, -1.0), dvec(1.0, 1.0, 1.0), m, true);
        }),
        ("a hollow", 3.0, |b, m| {
            cuboid(b, dvec(-1.0, -1.0, -1.0), dvec(1.0, 1.0, 1.0), m, false);
            cuboid(b, dvec(-0.5, -0.5, -0.5), dvec(0.5, 0.5, 0.5), m, true);
        }),
        ("a room with a box in it", 1.0, |b, m| {
            cuboid(b, dvec(-2.0, -2.0, -2.0), dvec(2.0, 2.0, 2.0), m, true);
            cuboid(b, dvec(-0.5, -2.0, -0.5), dvec(0.5, -1.0, 0.5), m, false);
        }),
        ("open at one side", 0.0, |b, m| {
            cuboid(b, dvec(-1.0, -1.0, -1.0), dvec(1.0, 1.0, 1.0), m, false);
            b.triangles.pop();
            b.triangle_materials.pop();
        }),
        ("a sheet", 0.0, |b, m| quad(b, dvec(-1.0, -1.0, 0.0), dvec(2.0, 0.0, 0.0), dvec(0.0, 2.0, 0.0), m)),
    ];
    for (name, expected, add) in cases {
        let cut = built(name, add).with_section(&[below(0, 0.1)], TONES);
        let (area, _) = cap_area(&cut, dvec(8.0, 0.1, 0.2), 0.1);
        assert!((area - expected).abs() < 0.02 * expected.max(1.0), "{name}: {area} m2, not {expected}");
    }
}

#[test]
fn the_cap_of_a_sphere_is_its_circle() {
    let cut = built("sphere", |b, m| shapes::sphere(b, DVec3::ZERO, 1.0, 64, true, m));
    let cut = cut.with_section(&[below(0, 0.6)], TONES);
    let (area, _) = cap_area(&cut, dvec(6.0, 0.0, 0.0), 0.6);
    assert!((area / (0.64 * std::f64::consts::PI) - 1.0).abs() < 0.02, "{area}");
}

/// Two planes, and a box, keep the intersection of their half-spaces.
#[test]
fn several_planes_and_a_box_keep_what_all_of_them_keep() {
    let tracer = cube();
    let camera = Camera::look_at(dvec(5.0, 4.0, 3.0), DVec3::ZERO, 40.0);
    let boxed = CutPlane::of_box([dvec(-0.5, -0.4, -2.0), dvec(0.5, 0.2, 0.6)]);
    for (planes, low, high) in [
        (&[below(0, 0.5), below(1, 0.2)][..], dvec(-1.0, -1.0, -1.0), dvec(0.5, 0.2, 1.0)),
        (&boxed[..], dvec(-0.5, -0.4, -1.0), dvec(0.5, 0.2, 0.6)),
    ] {
        let cut = tracer.with_section(planes, TONES);
        let solid = built("cut", |b, m| cuboid(b, low, high, m, false));
        let views = [&cut, &solid].map(|t| View::new(&camera, &t.scene().frame, [120, 90]));
        let scales = [&cut, &solid].map(|t| t.scene().frame.units_per_metre as f32);
        let (mut differ, mut seen) = (0, 0);
        for pixel in 0..views[0].pixel_count() as u32 {
            let ray = Tracer::primary_ray(&views[0], pixel);
            let of_cut = cut.closest_seen(&ray).map(|hit| hit.t).or(cut.cap(&ray).map(|cap| cap.t));
            let of_solid = solid.closest(&Tracer::primary_ray(&views[1], pixel)).map(|hit| hit.t);
            seen += u32::from(of_cut.is_some());
            differ += u32::from(match (of_cut, of_solid) {
                (Some(a), Some(b)) => (a / scales[0] / (b / scales[1]) - 1.0).abs() > 0.002,
                (None, None) => false,
                _ => true,
            });
        }
        assert!(seen > 300 && differ * 50 < seen, "{differ} of {seen}");
    }
}

/// A mirror on the kept side shows a lamp without the part that is cut away.
#[test]
fn a_mirror_sees_the_cut() {
    let mut b = SceneBuilder::new("mirror");
    let mirror = b.add_material(Material::mirror("mirror", Vec3::ONE));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::ONE));
    quad(&mut b, dvec(-2.0, -2.0, -4.0), dvec(4.0, 0.0, 0.0), dvec(0.0, 4.0, 0.0), mirror);
    cuboid(&mut b, dvec(-1.0, -1.0, 2.0), dvec(1.0, 1.0, 3.0), lamp, false);
    let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
    let camera = Camera::look_at(dvec(-0.5, 0.0, 0.0), dvec(-0.5, 0.0, -4.0), 30.0);
    for mode in [Mode::Full, Mode::Exact, Mode::Fast] {
        let whole = render(&tracer, &camera, [81, 81], mode);
        let cut = render(&tracer.with_section(&[below(0, 0.0)], TONES), &camera, [81, 81], mode);
        // In the mirror, 6 m of way from 10: a lamp at x is seen where the mirror is at -0.5 + (x +
        // 0.5) * 0.4.
        let lit = |frame: &Frame, x: f64| {
            let tan = (x + 0.5) / (10.0 - 0.0) / (15f64.to_radians().tan());
            frame.radiance[40 * 81 + (40.5 + 40.5 * tan) as usize] == Vec3::ONE
        };
        assert!([-0.9, -0.2, 0.2, 0.9].iter().all(|&x| lit(&whole, x)), "{mode:?}");
        assert!([-0.9, -0.2].iter().all(|&x| lit(&cut, x)), "{mode:?}");
        assert!([0.2, 0.9].iter().all(|&x| !lit(&cut, x)), "{mode:?}");
    }
}

/// The camera looks in over a wall that is cut away; lamps and walls shine as if it were there.
#[test]
fn light_does_not_see_the_section() {
    let whole = room_tracer(true, true);
    let cut = whole.with_section(&[below(2, -0.2)], TONES);
    assert_eq!(cut.epoch(), whole.epoch());
    let (before, after) = ([&whole, &cut]).map(|t| render(t, &room_camera(), [64, 36], Mode::Full)).into();
    let same = |pixel: &usize| {
        let frames: [&Frame; 2] = [&before, &after];
        let [a, b] = frames.map(|f| (f.triangle[*pixel], f.disparity[*pixel]));
        a.0 != NO_TRIANGLE && a == b && !whole.scene().material_of(a.0).is_view_dependent()
    };
    let compared: Vec<usize> = (0..64 * 36).filter(same).collect();
    assert!(compared.len() > 500, "{}", compared.len());
    assert!(compared.iter().all(|&pixel| before.radiance[pixel] == after.radiance[pixel]));
    let at_all = (0..64 * 36).filter(|&pixel| before.triangle[pixel] != after.triangle[pixel]).count();
    assert!(at_all > 50, "the section changes the picture: {at_all}");
}

/// A reference that was traced through a section is light for the whole scene, and the other way
/// round.
#[test]
fn references_hold_with_and_without_the_section() {
    let whole = room_tracer(false, false);
    let cut = whole.with_section(&[below(2, 1.0)], TONES);
    let (size, trace) = ([64, 36], TraceSettings { samples: 4, bounces: 1, seed: 3 });
    let settings = RenderSettings { mode: Mode::Exact, trace };
    // The error of a reference with few samples, without any section.
    let mut usual = None;
    for (by, shown) in [(&whole, &whole), (&whole, &cut), (&cut, &whole)] {
        let reference = ReferenceFrame::trace_filtered(by, &room_camera(), size, &trace, NEVER).unwrap();
        let mut cache = ReferenceCache::new(whole.scene(), usize::MAX);
        cache.insert(Arc::new(reference));
        let camera = room_camera();
        let request = FrameRequest::new(shown, &camera, size, &settings);
        let mut renderer = Renderer::default();
        let reused = renderer.render(&request.reusing(&cache)).clone();
        let many = RenderSettings { mode: Mode::Full, trace: TraceSettings { samples: 64, ..trace } };
        let traced = Renderer::default().render(&FrameRequest { settings: &many, ..request }).clone();
        let (mut error, mut light) = (0.0, 0.0);
        for (a, b) in reused.radiance.iter().zip(&traced.radiance) {
            (error, light) = (error + (*a - *b).element_sum(), light + b.element_sum());
        }
        assert!(reused.stats.types.reused > 64 * 36 / 3, "{:?}", reused.stats.types);
        let error = error / light;
        let usual = *usual.get_or_insert(error);
        assert!((error - usual).abs() < 0.03, "{error} where it is {usual} without a section");
    }
}

#[test]
fn every_mode_has_the_same_bits_at_any_thread_count() {
    let cut = room_tracer(true, true).with_section(&[below(2, -0.25), below(1, 1.0)], TONES);
    let camera = Camera {
        eye: dvec(0.3, 5.0, 7.0),
        ..Camera::look_at(dvec(0.3, 5.0, 7.0), dvec(0.0, 1.0, 0.0), 60.0)
    };
    for mode in [Mode::Full, Mode::Exact, Mode::Fast] {
        let frames = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render(&cut, &camera, [72, 40], mode))
        });
        let bits =
            |frame: &Frame| frame.radiance.iter().map(|r| r.to_array().map(f32::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(&frames[0]), bits(&frames[1]), "{mode:?}");
        assert_eq!(frames[0].disparity, frames[1].disparity, "{mode:?}");
        let caps = |tone: f32| frames[0].radiance.iter().filter(|r| **r == Vec3::splat(tone)).count();
        assert!(caps(TONES[0]) > 4 && caps(TONES[1]) > 4, "{mode:?}: {} {}", caps(TONES[0]), caps(TONES[1]));
    }
}

#[test]
fn planes_that_cut_nothing_are_named() {
    let tracer = cube();
    let check = |planes: &[CutPlane]| check_planes(tracer.scene(), planes);
    assert_eq!(check(&[below(0, 0.5)]), Ok(()));
    assert!(matches!(check(&[below(0, 4.0)]), Err(SectionError::Outside { axis: 'x', .. })));
    assert!(matches!(check(&[below(0, 2.0), below(1, 3.0)]), Err(SectionError::Everything { .. })));
    let apart = [below(0, -0.5), CutPlane { keeps_above: true, ..below(1, 5.0) }];
    assert!(matches!(check(&apart), Err(SectionError::Nothing { .. })));
    assert!(check(&CutPlane::of_box([DVec3::splat(-9.0), DVec3::splat(0.5)])).is_ok());
    // A face that lies in the plane is removed, whichever side is kept.
    let at_face = tracer.with_section(&[below(0, 1.0)], TONES);
    let (area, _) = cap_area(&at_face, dvec(6.0, 0.1, 0.2), 1.0);
    assert!((area / 4.0 - 1.0).abs() < 0.02, "{area}");
}
