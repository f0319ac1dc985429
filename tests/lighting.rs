//! Illuminance against closed forms, and the points and errors of work planes.

use crate::rooms::{cuboid, dvec};
use afterimage::render::lighting::{
    LightMeter, PlaneArea, PlaneError, PlaneStatistics, Sensor, SurfaceLight, WorkPlane,
};
use afterimage::scene::{CieSky, Material, SceneBuilder, Sky};
use afterimage::trace::{TraceSettings, parallel::NEVER};
use afterimage::{Camera, Tracer};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

fn tracer(builder: SceneBuilder) -> Tracer {
    Tracer::new(Arc::new(builder.finish().unwrap()))
}

fn settings(samples: u32, bounces: u32) -> TraceSettings {
    TraceSettings { samples, bounces, seed: 3 }
}

fn measured<'a>(
    tracer: &'a Tracer,
    sensors: Vec<Sensor>,
    trace: TraceSettings,
    passes: u32,
) -> LightMeter<'a> {
    let mut meter = LightMeter::new(tracer, sensors, trace);
    (0..passes).for_each(|_| assert!(meter.pass(NEVER)));
    meter
}

/// In a closed room of walls that emit 1 and reflect rho, the radiance is 1 / (1 - rho) everywhere,
/// so a sensor reads pi / (1 - rho) however it lies.
#[test]
fn a_white_room_has_its_closed_form_within_one_percent() {
    let rho = 0.5f32;
    let mut b = SceneBuilder::new("white room");
    let wall =
        b.add_material(Material { emission: Vec3::ONE, ..Material::diffuse("wall", Vec3::splat(rho)) });
    cuboid(&mut b, dvec(-2.0, -2.0, -2.0), dvec(2.0, 2.0, 2.0), wall, true);
    let tracer = tracer(b);
    let facings = [Vec3::Y, Vec3::NEG_Y, Vec3::new(0.6, -0.64, 0.48)];
    let places = [dvec(0.0, 0.0, 0.0), dvec(1.9, -1.9, 0.4), dvec(-1.2, 1.99, -1.9)];
    let sensors = facings.into_iter().zip(places);
    let sensors = sensors.map(|(facing, position_m)| Sensor { position_m, facing }).collect();
    let meter = measured(&tracer, sensors, settings(256, TraceSettings::ALL_BOUNCES), 8);
    let expected = PI / f64::from(1.0 - rho) * f64::from(tracer.scene().nits_per_unit());
    for reading in meter.readings() {
        assert!((reading.lux / expected - 1.0).abs() < 0.01, "{reading:?} for {expected}");
    }
}

/// The same for what a picture of the room shows: the light of each pixel is that of its surface.
#[test]
fn a_picture_of_the_light_in_a_white_room_has_its_closed_form() {
    let rho = 0.5f32;
    let mut b = SceneBuilder::new("white room");
    let wall =
        b.add_material(Material { emission: Vec3::ONE, ..Material::diffuse("wall", Vec3::splat(rho)) });
    let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(0.9)));
    cuboid(&mut b, dvec(-2.0, -2.0, -2.0), dvec(2.0, 2.0, 2.0), wall, true);
    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    b.add_quad(corners.map(|[x, y]| dvec(x, y, -1.9)), Vec2::ONE, mirror);
    let tracer = tracer(b);
    let camera = Camera::look_at(dvec(0.0, 0.0, 1.5), dvec(0.0, 0.0, -1.0), 60.0);
    let trace = settings(64, TraceSettings::ALL_BOUNCES);
    let light = SurfaceLight::trace(&tracer, &camera, [32, 32], &trace, NEVER).unwrap();
    let lux = light.lux(tracer.scene().nits_per_unit());
    let known: Vec<f64> = lux.iter().filter(|v| v.is_finite()).map(|v| f64::from(*v)).collect();
    // The mirror has no illuminance, and dims the room a little.
    assert!(lux[16 * 32 + 16].is_nan() && known.len() > 900, "{} pixels", known.len());
    let expected = PI / f64::from(1.0 - rho) * f64::from(tracer.scene().nits_per_unit());
    let mean = known.iter().sum::<f64>() / known.len() as f64;
    assert!((mean / expected - 1.0).abs() < 0.03, "{mean} for {expected}");
}

/// A black room with a window to an overcast sky: the light of a point is the integral of the sky's
/// luminance over the window.
#[test]
fn an_overcast_window_has_its_closed_form_within_one_percent() {
    let sky = CieSky::overcast(Vec3::splat(1.0), Vec3::ZERO);
    for bounces in [0, 4] {
        let mut b = SceneBuilder::new("window");
        let black = b.add_material(Material::diffuse("black", Vec3::ZERO));
        cuboid_without_window(&mut b, black);
        b.sky = Some(Sky::Cie(sky));
        let tracer = tracer(b);
        let places = [dvec(0.0, 0.8, 1.0), dvec(-1.2, 0.8, -0.5), dvec(0.7, 0.0, -1.8)];
        let sensors = places.map(|position_m| Sensor { position_m, facing: Vec3::Y });
        let meter = measured(&tracer, sensors.into(), settings(4096, bounces), 64);
        for (sensor, reading) in meter.sensors().iter().zip(meter.readings()) {
            let expected =
                through_window(&sky, sensor.position_m) * f64::from(tracer.scene().nits_per_unit());
            assert!(
                (reading.lux / expected - 1.0).abs() < 0.01,
                "{bounces} bounces: {reading:?} for {expected}"
            );
        }
    }
}

const WINDOW_X_M: [f64; 2] = [-1.0, 1.0];
const WINDOW_Y_M: [f64; 2] = [1.0, 2.2];
const WINDOW_Z_M: f64 = 2.0;

/// A room from -2 to 2 m and 2.5 m high, whose wall at the largest z has an opening.
fn cuboid_without_window(b: &mut SceneBuilder, material: afterimage::scene::MaterialId) {
    let ([x0, x1], [y0, y1], z) = (WINDOW_X_M, WINDOW_Y_M, WINDOW_Z_M);
    let wall = |b: &mut SceneBuilder, [left, right]: [f64; 2], [low, high]: [f64; 2]| {
        let corners = [[left, low], [right, low], [right, high], [left, high]];
        b.add_quad(corners.map(|[x, y]| dvec(x, y, z)), Vec2::ONE, material);
    };
    wall(b, [-2.0, x0], [0.0, 2.5]);
    wall(b, [x1, 2.0], [0.0, 2.5]);
    wall(b, [x0, x1], [0.0, y0]);
    wall(b, [x0, x1], [y1, 2.5]);
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    for y in [0.0, 2.5] {
        b.add_quad(square.map(|[x, z]| dvec(2.0 * x, y, 2.0 * z)), Vec2::ONE, material);
    }
    for x in [-2.0, 2.0] {
        b.add_quad(square.map(|[y, z]| dvec(x, 1.25 * (y + 1.0), 2.0 * z)), Vec2::ONE, material);
    }
    b.add_quad(square.map(|[x, y]| dvec(2.0 * x, 1.25 * (y + 1.0), -2.0)), Vec2::ONE, material);
}

/// The irradiance of a sensor that faces up, by the midpoint rule over the window.
fn through_window(sky: &CieSky, at: DVec3) -> f64 {
    const STEPS: u32 = 400;
    let middle = |[from, to]: [f64; 2], i: u32| from + (to - from) * (f64::from(i) + 0.5) / f64::from(STEPS);
    let area = (WINDOW_X_M[1] - WINDOW_X_M[0]) * (WINDOW_Y_M[1] - WINDOW_Y_M[0]) / f64::from(STEPS).powi(2);
    let piece = |(i, j): (u32, u32)| {
        let way = dvec(middle(WINDOW_X_M, i), middle(WINDOW_Y_M, j), WINDOW_Z_M) - at;
        let direction = way.normalize_or(DVec3::Y);
        let radiance = f64::from(sky.radiance(direction.as_vec3()).y);
        radiance * direction.y.max(0.0) * direction.z * area / way.length_squared()
    };
    (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))).map(piece).sum()
}

/// An L-shaped room with a table: the plane fills the room, and nothing else.
#[test]
fn a_plane_fills_its_room_and_stays_inside() {
    let mut b = SceneBuilder::new("L");
    let wall = b.add_material(Material { emission: Vec3::ONE, ..Material::diffuse("w", Vec3::splat(0.5)) });
    cuboid(&mut b, dvec(0.0, 0.0, 0.0), dvec(6.0, 3.0, 6.0), wall, true);
    // The corner that is not of the room, and a cupboard in it that is higher than the plane.
    cuboid(&mut b, dvec(3.0, 0.0, 3.0), dvec(6.0, 3.0, 6.0), wall, false);
    cuboid(&mut b, dvec(0.9, 0.0, 0.9), dvec(2.1, 2.0, 1.6), wall, false);
    let tracer = tracer(b);
    let area = PlaneArea::Room(dvec(0.25, 1.6, 0.25));
    let plane = WorkPlane { height_m: 0.85, grid_m: 0.5, margin_m: 0.0, area };
    let sensors = plane.sensors(&tracer).unwrap();
    let expected = |p: DVec3| {
        let in_corner = p.x > 3.0 && p.z > 3.0;
        let in_cupboard = (0.9..2.1).contains(&p.x) && (0.9..1.6).contains(&p.z);
        !in_corner && !in_cupboard
    };
    let all = (0..12).flat_map(|j| (0..12).map(move |i| (i, j)));
    let all = all.map(|(i, j)| dvec(0.25 + 0.5 * f64::from(i), 0.85, 0.25 + 0.5 * f64::from(j)));
    let all: Vec<DVec3> = all.filter(|p| expected(*p)).collect();
    assert_eq!(sensors.len(), all.len());
    for (sensor, expected) in sensors.iter().zip(&all) {
        assert!(sensor.position_m.distance(*expected) < 1e-4, "{sensor:?} for {expected}");
    }
    // With a margin, what is near walls is left out.
    let inner = WorkPlane { margin_m: 0.5, ..plane }.sensors(&tracer).unwrap();
    assert!(!inner.is_empty() && inner.len() < sensors.len());
    assert!(inner.iter().all(|s| s.position_m.x > 0.5 && s.position_m.z > 0.5));
    // A rectangle over everything leaves out the bodies.
    let area = PlaneArea::Rectangle { x_m: [0.0, 3.0], z_m: [0.0, 6.0], above_m: 1.6 };
    assert_eq!(WorkPlane { area, ..plane }.sensors(&tracer).unwrap().len(), 6 * 12 - 2);
    let area = PlaneArea::Rectangle { x_m: [8.0, 9.0], z_m: [0.0, 6.0], above_m: 1.6 };
    assert_eq!(WorkPlane { area, ..plane }.sensors(&tracer), Err(PlaneError::NoFloor(dvec(8.5, 1.6, 3.0))));
}

#[test]
fn planes_that_cannot_be_say_why() {
    let mut b = SceneBuilder::new("room");
    let wall = b.add_material(Material { emission: Vec3::ONE, ..Material::diffuse("w", Vec3::splat(0.5)) });
    cuboid(&mut b, dvec(0.0, 0.0, 0.0), dvec(4.0, 3.0, 4.0), wall, true);
    let tracer = tracer(b);
    let plane =
        |grid_m, area| WorkPlane { height_m: 0.8, grid_m, margin_m: 0.0, area }.sensors(&tracer).unwrap_err();
    let inside = PlaneArea::Room(dvec(2.0, 1.0, 2.0));
    assert_eq!(plane(0.5, PlaneArea::Room(dvec(9.0, 1.0, 2.0))), PlaneError::NoFloor(dvec(9.0, 1.0, 2.0)));
    assert_eq!(plane(0.01, inside), PlaneError::TooMany);
    for grid in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(plane(grid, inside), PlaneError::BadNumbers);
    }
    let high = WorkPlane { height_m: 5.0, grid_m: 1.0, margin_m: 0.0, area: inside };
    assert!(high.sensors(&tracer).is_err(), "above the ceiling");
}

/// The error bars hold the converged readings as often as they say, and the readings have the same
/// bits at any number of threads.
#[test]
fn error_bars_hold_and_readings_do_not_depend_on_threads() {
    let mut b = SceneBuilder::new("lit room");
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.6)));
    let lamp = Material { emits_from_front: true, ..Material::emissive("lamp", Vec3::splat(20.0)) };
    let lamp = b.add_material(lamp);
    cuboid(&mut b, dvec(0.0, 0.0, 0.0), dvec(6.0, 3.0, 4.0), wall, true);
    let corners = [[2.5, 1.6], [3.5, 1.6], [3.5, 2.4], [2.5, 2.4]];
    b.add_quad(corners.map(|[x, z]| dvec(x, 2.6, z)), Vec2::ONE, lamp);
    let tracer = tracer(b);
    let area = PlaneArea::Room(dvec(0.25, 1.6, 0.25));
    let plane = WorkPlane { height_m: 0.85, grid_m: 0.5, margin_m: 0.0, area };
    let sensors = plane.sensors(&tracer).unwrap();
    let trace = settings(16, TraceSettings::ALL_BOUNCES);
    let truth = measured(&tracer, sensors.clone(), TraceSettings { seed: 99, samples: 512, ..trace }, 16);
    let meter = measured(&tracer, sensors.clone(), trace, 16);
    let pairs = meter.readings().into_iter().zip(truth.readings());
    let held = pairs.filter(|(r, t)| (r.lux - t.lux).abs() < 1.96 * r.standard_error_lux);
    let share = held.count() as f64 / sensors.len() as f64;
    assert!((0.85..=1.0).contains(&share), "{share} of the bars hold");
    let [s, t] = [&meter, &truth].map(|meter| PlaneStatistics::new(&meter.readings()).unwrap());
    assert!((s.mean_lux / t.mean_lux - 1.0).abs() < 0.02, "{s:?} {t:?}");
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone = one.install(|| measured(&tracer, sensors, trace, 16).readings());
    assert_eq!(alone, meter.readings());
}
