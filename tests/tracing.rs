//! The ordinary tracer against closed forms.

use crate::rooms::{cuboid, dvec, quad, room_camera, room_tracer};
use afterimage::scene::{Light, Material, MaterialKind, SceneBuilder, SolidSide};
use afterimage::trace::{RayCounts, TraceSettings, truncation_bound};
use afterimage::{Camera, FrameRequest, Mode, RenderSettings, Renderer, Tracer, View};
use glam::Vec3;
use std::sync::Arc;

fn full(samples: u32, bounces: u32) -> RenderSettings {
    RenderSettings { mode: Mode::Full, trace: TraceSettings { samples, bounces, seed: 1 } }
}

fn mean(radiance: &[Vec3]) -> Vec3 {
    radiance.iter().copied().sum::<Vec3>() / radiance.len() as f32
}

/// The walls of a cube emit 1 and reflect rho. The radiance after n bounces is 1 + rho + ... +
/// rho^(n+1); the last term exists because light straight from the walls does not count as a
/// bounce.
#[test]
fn furnace_has_its_closed_form_within_one_percent() {
    let rho = 0.5f32;
    let mut b = SceneBuilder::new("furnace");
    let wall =
        b.add_material(Material { emission: Vec3::ONE, ..Material::diffuse("wall", Vec3::splat(rho)) });
    cuboid(&mut b, dvec(-2.0, -2.0, -2.0), dvec(2.0, 2.0, 2.0), wall, true);
    let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
    let camera = Camera::look_at(dvec(0.1, 0.2, 0.3), dvec(1.0, 0.4, -0.7), 70.0);
    for bounces in [0, 1, 4] {
        let mut renderer = Renderer::default();
        let frame = renderer.render(&FrameRequest::new(&tracer, &camera, [24, 24], &full(64, bounces)));
        let expected: f32 = (0..=bounces + 1).map(|n| rho.powi(n as i32)).sum();
        let measured = mean(&frame.radiance);
        assert!(
            (measured / expected - 1.0).abs().max_element() < 0.01,
            "{bounces}: {measured} for {expected}"
        );
    }
}

/// No light is lost at white walls, so only the tracer's own bound ends a path.
#[test]
fn all_bounces_end_in_a_white_room_without_and_with_light() {
    for emission in [0.0, 1.0] {
        let mut b = SceneBuilder::new("white");
        let emission = Vec3::splat(emission);
        let wall = b.add_material(Material { emission, ..Material::diffuse("wall", Vec3::ONE) });
        cuboid(&mut b, dvec(-2.0, -2.0, -2.0), dvec(2.0, 2.0, 2.0), wall, true);
        let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
        let camera = Camera::look_at(dvec(0.1, 0.2, 0.3), dvec(1.0, 0.4, -0.7), 70.0);
        for mode in [Mode::Full, Mode::Exact] {
            let trace = TraceSettings { samples: 1, bounces: TraceSettings::ALL_BOUNCES, seed: 1 };
            let settings = RenderSettings { mode, trace };
            let mut renderer = Renderer::default();
            let frame = renderer.render(&FrameRequest::new(&tracer, &camera, [8, 8], &settings));
            let radiance = mean(&frame.radiance);
            assert!(radiance.is_finite(), "{radiance}");
            if emission == Vec3::ZERO {
                assert_eq!(radiance, Vec3::ZERO);
            } else {
                assert!(radiance.min_element() > 2.0, "each bounce adds the light of the walls: {radiance}");
            }
        }
    }
}

/// Two emitting mirrors of reflectance r face each other: each bounce adds r times the one before.
/// The sum may differ from the geometric series by at most the bound that `inspect` prints.
#[test]
fn parallel_mirrors_stay_within_the_printed_bound() {
    for r in [0.5f32, 0.8, 0.98] {
        let mut b = SceneBuilder::new("mirrors");
        let mirror = b.add_material(Material {
            emission: Vec3::splat(0.1),
            ..Material::mirror("mirror", Vec3::splat(r))
        });
        quad(&mut b, dvec(-50.0, -50.0, -2.0), dvec(100.0, 0.0, 0.0), dvec(0.0, 100.0, 0.0), mirror);
        quad(&mut b, dvec(-50.0, -50.0, 2.0), dvec(100.0, 0.0, 0.0), dvec(0.0, 100.0, 0.0), mirror);
        let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
        let view = View::new(
            &Camera::look_at(dvec(0.0, 0.0, 0.0), dvec(0.0, 0.0, -1.0), 1.0),
            &tracer.scene().frame,
            [1, 1],
        );
        let traced = tracer.pixel(
            &view,
            0,
            &TraceSettings { samples: 1, ..Default::default() },
            &mut RayCounts::default(),
        );
        let whole = 0.1 / (1.0 - r);
        let missing = whole - traced.radiance.x;
        let bound = truncation_bound(r, 0.1);
        // Allow for the rounding of a sum of some hundred terms.
        assert!(
            missing > -1e-3 * whole && missing <= bound * 1.001,
            "r {r}: missing {missing}, bound {bound}"
        );
        assert!(traced.reflections >= 8, "r {r}: {} bounces", traced.reflections);
    }
}

#[test]
fn an_area_light_gives_the_form_factor_of_parallel_squares() {
    // Two unit squares face each other at distance 1; the form factor of the lower one's middle has
    // a closed form.
    let mut b = SceneBuilder::new("squares");
    let floor = b.add_material(Material::diffuse("floor", Vec3::ONE));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::ONE));
    quad(&mut b, dvec(-0.5, 0.0, 0.5), dvec(1.0, 0.0, 0.0), dvec(0.0, 0.0, -1.0), floor);
    quad(&mut b, dvec(-0.5, 1.0, -0.5), dvec(1.0, 0.0, 0.0), dvec(0.0, 0.0, 1.0), lamp);
    let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
    assert!(matches!(tracer.scene().lights.as_slice(), [Light::Quad { .. }]));
    let view = View::new(
        &Camera::look_at(dvec(0.0, 0.5, 0.0), dvec(0.0, 0.0, 0.0), 1.0),
        &tracer.scene().frame,
        [1, 1],
    );
    let traced = tracer.pixel(
        &view,
        0,
        &TraceSettings { samples: 4096, ..Default::default() },
        &mut RayCounts::default(),
    );
    // Four times the form factor from a point to a parallel rectangle a x b at distance c, one
    // corner of which lies above the point (a = b = 1/2, c = 1).
    let (x, y) = (0.5f64, 0.5f64);
    let (rx, ry) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    let corner = (x / rx * (y / rx).atan() + y / ry * (x / ry).atan()) / (2.0 * std::f64::consts::PI);
    let expected = 4.0 * corner;
    assert!(
        (f64::from(traced.radiance.x) - expected).abs() < 0.002 * expected,
        "{} {expected}",
        traced.radiance.x
    );
}

#[test]
fn a_point_light_falls_with_the_square_of_the_distance() {
    let radiance_at = |height: f64| {
        let mut b = SceneBuilder::new("lamp");
        let floor = b.add_material(Material::diffuse("floor", Vec3::splat(0.5)));
        quad(&mut b, dvec(-5.0, 0.0, 5.0), dvec(10.0, 0.0, 0.0), dvec(0.0, 0.0, -10.0), floor);
        b.point_lights.push((dvec(0.0, height, 0.0), Vec3::splat(10.0)));
        let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
        let camera = Camera::look_at(dvec(0.0, 0.3, 0.0), dvec(0.0, 0.0, 0.0), 1.0);
        let view = View::new(&camera, &tracer.scene().frame, [1, 1]);
        tracer.pixel(&view, 0, &TraceSettings::default(), &mut RayCounts::default()).radiance.x
    };
    let expected = |h: f32| 0.5 / std::f32::consts::PI * 10.0 / (h * h);
    for h in [0.5, 1.0, 3.0] {
        let got = radiance_at(f64::from(h));
        assert!((got / expected(h) - 1.0).abs() < 1e-3, "{h} m: {got} for {}", expected(h));
    }
}

#[test]
fn closed_glass_is_solid_whatever_its_winding_and_a_sheet_is_thin() {
    for inside_out in [false, true] {
        let mut b = SceneBuilder::new("glass");
        let glass = b.add_material(Material::glass("glass", 1.5, Vec3::ONE));
        cuboid(&mut b, dvec(0.0, 0.0, 0.0), dvec(1.0, 1.0, 0.1), glass, inside_out);
        quad(&mut b, dvec(3.0, 0.0, 0.0), dvec(1.0, 0.0, 0.0), dvec(0.0, 1.0, 0.0), glass);
        let scene = b.finish().unwrap();
        let side = if inside_out { SolidSide::InsideInFront } else { SolidSide::InsideBehind };
        assert!(scene.solids[..12].iter().all(|s| *s == side));
        assert!(scene.solids[12..].iter().all(|s| *s == SolidSide::Thin));
    }
}

#[test]
fn glass_of_index_one_changes_nothing() {
    let pixel = |with_glass: bool| {
        let mut b = SceneBuilder::new("pane");
        let wall = b.add_material(Material {
            emission: Vec3::new(0.3, 0.5, 0.7),
            ..Material::diffuse("w", Vec3::ZERO)
        });
        quad(&mut b, dvec(-2.0, -2.0, -3.0), dvec(4.0, 0.0, 0.0), dvec(0.0, 4.0, 0.0), wall);
        if with_glass {
            let glass = b.add_material(Material::glass("glass", 1.0, Vec3::ONE));
            cuboid(&mut b, dvec(-0.5, -0.5, -1.6), dvec(0.5, 0.5, -1.0), glass, false);
        }
        let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
        let camera = Camera::look_at(dvec(0.3, 0.2, 1.0), dvec(0.0, 0.0, -3.0), 10.0);
        let view = View::new(&camera, &tracer.scene().frame, [3, 3]);
        tracer.pixel(&view, 4, &TraceSettings::default(), &mut RayCounts::default()).radiance
    };
    assert_eq!(pixel(true), pixel(false));
}

#[test]
fn every_thread_count_gives_the_same_bits() {
    let tracer = room_tracer(true, true);
    let render = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut renderer = Renderer::default();
            renderer
                .render(&FrameRequest::new(&tracer, &room_camera(), [96, 64], &full(4, 1)))
                .radiance
                .clone()
        })
    };
    let one = render(1);
    for threads in [2, 3, 8] {
        assert!(render(threads) == one, "{threads} threads");
    }
    assert!(one.iter().all(|r| r.is_finite() && r.min_element() >= 0.0));
}

#[test]
fn scenes_scaled_by_powers_of_two_and_moved_by_whole_units_have_the_same_bits() {
    let picture = |scale: f64, shift: glam::DVec3| {
        let mut b = SceneBuilder::new("scaled");
        let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.6)));
        let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(5.0)));
        let at = |x: f64, y: f64, z: f64| dvec(x, y, z) * scale + shift;
        cuboid(&mut b, at(-3.0, 0.0, -4.0), at(3.0, 3.0, 4.0), wall, true);
        cuboid(&mut b, at(-1.0, 0.0, -2.0), at(0.25, 1.125, -1.0), wall, false);
        quad(&mut b, at(-0.5, 2.875, 0.0), dvec(scale, 0.0, 0.0), dvec(0.0, 0.0, scale), lamp);
        let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
        let camera = Camera::look_at(at(0.5, 1.5, 3.0), at(0.0, 1.0, -4.0), 65.0);
        let mut renderer = Renderer::default();
        renderer.render(&FrameRequest::new(&tracer, &camera, [64, 48], &full(4, 1))).radiance.clone()
    };
    let base = picture(1.0, glam::DVec3::ZERO);
    for k in [-20, -3, 5, 30] {
        assert!(picture(2f64.powi(k), glam::DVec3::ZERO) == base, "scaled by 2^{k}");
    }
    for shift in [2f64.powi(20), 2f64.powi(23)] {
        assert!(picture(1.0, dvec(shift, -shift, shift)) == base, "moved by {shift}");
    }
}

/// Returns the brightness of a floor that is lit by a lamp and by way of a wall; `add` adds to the
/// scene.
fn floor_brightness(bounces: u32, add: impl Fn(&mut SceneBuilder)) -> f32 {
    let mut b = SceneBuilder::new("corner");
    let white = b.add_material(Material::diffuse("white", Vec3::splat(0.8)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(4.0)));
    quad(&mut b, dvec(-2.0, 0.0, 2.0), dvec(4.0, 0.0, 0.0), dvec(0.0, 0.0, -4.0), white);
    quad(&mut b, dvec(-2.0, 0.0, -2.0), dvec(4.0, 0.0, 0.0), dvec(0.0, 3.0, 0.0), white);
    quad(&mut b, dvec(-1.0, 2.5, -1.0), dvec(2.0, 0.0, 0.0), dvec(0.0, 0.0, 2.0), lamp);
    add(&mut b);
    let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
    let camera = Camera::look_at(dvec(0.0, 1.0, 1.5), dvec(0.0, 0.0, 0.0), 30.0);
    let mut renderer = Renderer::default();
    mean(&renderer.render(&FrameRequest::new(&tracer, &camera, [16, 16], &full(256, bounces))).radiance).x
}

#[test]
fn light_that_bounces_through_glass_is_counted_once() {
    let open = floor_brightness(1, |_| {});
    // A pane between lamp and floor, of index one and without absorption, changes nothing.
    let behind_glass = floor_brightness(1, |b| {
        let glass = b.add_material(Material::glass("pane", 1.0, Vec3::ONE));
        quad(b, dvec(-1.9, 2.0, -1.9), dvec(3.8, 0.0, 0.0), dvec(0.0, 0.0, 3.8), glass);
    });
    assert!((behind_glass / open - 1.0).abs() < 0.01, "{behind_glass} behind glass, {open} without");
    assert!(open > 1.03 * floor_brightness(0, |_| {}), "a bounce adds light");
}

#[test]
fn a_polished_wall_still_scatters_light() {
    // The wall's diffuse part must bounce light as a matte wall of the same colour does; its mirror
    // adds more.
    let wall = |kind: MaterialKind| {
        move |b: &mut SceneBuilder| {
            let m = b.add_material(Material { kind, ..Material::diffuse("wall", Vec3::splat(0.6)) });
            quad(b, dvec(-1.8, 0.0, -1.5), dvec(0.0, 2.4, 0.0), dvec(0.0, 0.0, 3.0), m);
        }
    };
    let matte = floor_brightness(1, wall(MaterialKind::Diffuse));
    let none = MaterialKind::Mirror { reflectance: Vec3::ZERO, fresnel: false };
    let polished = MaterialKind::Mirror { reflectance: Vec3::splat(0.3), fresnel: false };
    assert!((floor_brightness(1, wall(none)) / matte - 1.0).abs() < 0.01);
    assert!(floor_brightness(1, wall(polished)) > matte);
}
