//! The hits of rasterised candidates against those of single rays, their slow twin: the bits are
//! the same in every pixel, whatever the scene and the camera.

use crate::rooms::{cuboid, dvec, leafy_scene, quad, room_camera, room_tracer};
use afterimage::math::key::Key;
use afterimage::scene::{Material, MaterialId, SceneBuilder};
use afterimage::trace::{Hit, TILE_RAYS, TILE_SIDE, TileHits, VisibilityBuffer, primary_tile};
use afterimage::{Camera, Tracer, View};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

const SIZE: [u32; 2] = [75, 50];

/// Pixels of pictures: all of them, those that show a surface, those that needed a single ray.
#[derive(Clone, Copy, Default)]
struct Counts {
    all: usize,
    met: usize,
    traced: u32,
}

/// Compares every pixel of a picture.
fn compare(tracer: &Tracer, camera: &Camera, size: [u32; 2], counts: &mut Counts) {
    let view = View::new(camera, &tracer.scene().frame, size);
    let (mut tile, mut hits) = (primary_tile(&view, [0, 0]), TileHits::NONE);
    let mut visible = VisibilityBuffer::default();
    visible.find(tracer, &view, false);
    let bits = |h: Hit| (h.triangle, [h.t, h.b1, h.b2].map(f32::to_bits));
    for corner in (0..size[1]).step_by(8).flat_map(|y| (0..size[0]).step_by(8).map(move |x| [x, y])) {
        let traced = visible.hits_of_tile(tracer, &view, corner, &mut tile, &mut hits);
        for ray in 0..TILE_RAYS {
            let [x, y] = [corner[0] + (ray % TILE_SIDE) as u32, corner[1] + (ray / TILE_SIDE) as u32];
            if x >= size[0] || y >= size[1] {
                continue;
            }
            let pixel = y * size[0] + x;
            let alone = tracer.closest(&Tracer::primary_ray(&view, pixel)).map(bits);
            assert_eq!(hits.hit(ray).map(bits), alone, "({x}, {y}) of {size:?}, {camera:?}");
            assert_eq!(visible.hit_of_pixel(tracer, &view, pixel).map(bits), alone, "{pixel}, {camera:?}");
            counts.all += 1;
            counts.met += usize::from(alone.is_some());
            counts.traced += (traced >> ray & 1) as u32;
        }
    }
}

fn compared(tracer: &Tracer, cameras: &[Camera], size: [u32; 2]) -> Counts {
    let mut counts = Counts::default();
    cameras.iter().for_each(|camera| compare(tracer, camera, size, &mut counts));
    counts
}

/// Random numbers 0..1 of item `i`.
fn random(i: u32, k: u32) -> [f64; 4] {
    let [[x, y], [z, w]] = [0, 1].map(|d| Key::of_pixel(11, i).with(4 * k + d).pair());
    [x, y, z, w].map(f64::from)
}

fn random_point(i: u32, k: u32) -> DVec3 {
    let [x, y, z, _] = random(i, k);
    dvec(x, y, z) * 2.0 - 1.0
}

fn random_cameras(count: u32, reach: f64) -> Vec<Camera> {
    let camera = |i: u32| {
        let [yaw, pitch, fov, roll] = random(i, 91);
        Camera {
            eye: random_point(i, 90) * reach,
            yaw: yaw * 6.3,
            pitch: (pitch - 0.5) * 3.1,
            fov_y: (3.0 + 160.0 * fov * fov).to_radians(),
            roll: if i.is_multiple_of(2) { 0.0 } else { roll * 6.3 },
        }
    };
    (0..count).map(camera).collect()
}

fn add_triangle(b: &mut SceneBuilder, corners: [DVec3; 3], material: MaterialId) {
    let vertices = corners.map(|p| b.add_vertex(p, Vec3::ZERO, Vec2::ZERO));
    b.add_triangle(vertices, material);
}

fn matte(b: &mut SceneBuilder) -> MaterialId {
    b.add_material(Material::diffuse("matte", Vec3::ONE))
}

fn tracer_of(b: SceneBuilder) -> Tracer {
    Tracer::new(Arc::new(b.finish().unwrap()))
}

/// Triangles of all sizes and shapes around the origin, scaled, then moved.
fn soup(count: u32, scale: f64, centre: DVec3) -> Tracer {
    let mut b = SceneBuilder::new("soup");
    let matte = matte(&mut b);
    for i in 0..count {
        let [size, thickness, shape, _] = random(i, 3);
        let (at, size) = (random_point(i, 0), size.powi(4));
        let second = random_point(i, 1) * size;
        let third = if shape < 0.3 {
            second * thickness + random_point(i, 2) * size * thickness.powi(8)
        } else {
            random_point(i, 2) * size
        };
        add_triangle(&mut b, [at, at + second, at + third].map(|p| p * scale + centre), matte);
    }
    tracer_of(b)
}

#[test]
fn ragged_pictures() {
    let tracer = room_tracer(true, true);
    let mut counts = Counts::default();
    for size in [[1, 1], [7, 5], [64, 64], [65, 63], [129, 17], [3, 140]] {
        compare(&tracer, &room_camera(), size, &mut counts);
    }
    assert!(counts.met > 3000 && counts.traced < 100, "{} met, {} traced", counts.met, counts.traced);
}

#[test]
fn random_soups_from_random_cameras() {
    let tracer = soup(3000, 1.0, DVec3::ZERO);
    let counts = compared(&tracer, &random_cameras(24, 1.5), SIZE);
    assert!(counts.met * 4 > counts.all, "{} of {}", counts.met, counts.all);
    assert!(counts.traced as usize * 4 < counts.all, "{} of {}", counts.traced, counts.all);
}

#[test]
fn scenes_of_any_scale_and_place() {
    for (scale, centre) in
        [(2f64.powi(-20), DVec3::ZERO), (2f64.powi(12), DVec3::ZERO), (4.0, dvec(3e5, -2e5, 7e4))]
    {
        let tracer = soup(500, scale, centre);
        let mut cameras = random_cameras(6, scale);
        cameras.iter_mut().for_each(|camera| camera.eye += centre);
        let counts = compared(&tracer, &cameras, SIZE);
        assert!(counts.met > 1000, "{} of {} at {scale}", counts.met, counts.all);
    }
}

/// Eyes in the plane of a wall, inside one, at a corner and on an edge; directions along the axes,
/// for which boxes and planes through the eye are degenerate.
#[test]
fn eyes_on_surfaces_and_directions_along_axes() {
    let tracer = room_tracer(false, false);
    let mut counts = Counts::default();
    for eye in [
        dvec(-1.5, 1.2, -1.5), // edge of a box
        dvec(-0.5, 1.2, -1.0), // corner of a box
        dvec(0.8, 1.0, -0.2),  // inside a box
        dvec(0.0, 0.0, 0.0),   // on the floor
        dvec(0.0, 0.0, 4.0),   // where floor and wall meet
        dvec(0.213, 1.517, 3.489),
    ] {
        for at in [dvec(3.0, 1.0, 3.0), dvec(-3.0, 2.0, -4.0)] {
            compare(&tracer, &Camera::look_at(eye, at, 100.0), SIZE, &mut counts);
        }
        for along in [DVec3::X, DVec3::NEG_Y, DVec3::Y, DVec3::NEG_Z] {
            compare(&tracer, &Camera::look_at(eye, eye + along, 60.0), SIZE, &mut counts);
        }
    }
    assert!(counts.met > 10_000);
}

#[test]
fn cameras_that_make_no_sense() {
    let tracer = room_tracer(true, true);
    let at = |eye: DVec3, fov_y: f64| Camera { eye, yaw: 0.3, pitch: 0.1, fov_y, roll: 0.0 };
    let nan = f64::NAN;
    for camera in [
        at(DVec3::splat(nan), 1.0),
        at(DVec3::splat(1e7), 1.0),
        at(DVec3::splat(1e30), 1.0),
        at(dvec(0.0, 1.0, f64::INFINITY), 1.0),
        at(dvec(0.0, 1.0, 0.0), nan),
        at(dvec(0.0, 1.0, 0.0), 0.0),
        at(dvec(0.0, 1.0, 0.0), 1e-9),
        at(dvec(0.0, 1.0, 0.0), std::f64::consts::PI),
        Camera { yaw: nan, ..room_camera() },
    ] {
        compare(&tracer, &camera, [70, 9], &mut Counts::default());
    }
    // From 10,000 km away the room is smaller than a pixel.
    let far = Camera::look_at(dvec(1e7, 1e6, 3.0), DVec3::ZERO, 1.0);
    assert_eq!(compared(&tracer, &[far], SIZE).traced, 0);
}

#[test]
fn nothing_in_view_and_one_triangle_that_fills_it() {
    let mut b = SceneBuilder::new("one triangle");
    let matte = matte(&mut b);
    add_triangle(&mut b, [dvec(-90.0, -90.0, -1.0), dvec(90.0, -90.0, -1.0), dvec(0.0, 90.0, -1.0)], matte);
    let tracer = tracer_of(b);
    let towards = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0);
    let away = Camera::look_at(DVec3::ZERO, DVec3::Z, 60.0);
    let counts = compared(&tracer, &[towards], SIZE);
    assert_eq!((counts.met, counts.traced), (counts.all, 0));
    let counts = compared(&tracer, &[away], SIZE);
    assert_eq!((counts.met, counts.traced), (0, 0));
}

/// Faces in one plane, cut into triangles in different ways: the nearer by rounding, or the one
/// with the lower index, wins.
#[test]
fn coincident_faces() {
    let mut b = SceneBuilder::new("coincident faces");
    let matte = matte(&mut b);
    for i in 0..6 {
        let [x, y, w, h] = random(i, 4);
        quad(&mut b, dvec(-x, -y, 0.0), DVec3::X * (x + w), DVec3::Y * (y + h), matte);
    }
    let corners = [dvec(-1.0, -1.0, 0.0), dvec(1.0, -1.0, 0.0), dvec(1.0, 1.0, 0.0)];
    for i in 0..3 {
        add_triangle(&mut b, [corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]], matte);
    }
    cuboid(&mut b, dvec(-1.0, -1.0, -2.0), dvec(1.0, 1.0, 0.0), matte, false);
    let tracer = tracer_of(b);
    let cameras = [dvec(0.2, 0.1, 2.0), dvec(3.0, 0.3, 0.1), dvec(0.1, -2.0, 0.01)]
        .map(|eye| Camera::look_at(eye, dvec(0.1, 0.1, 0.0), 60.0));
    assert!(compared(&tracer, &cameras, SIZE).met > 3000);
}

#[test]
fn cut_outs_everywhere() {
    let tracer = Tracer::new(Arc::new(leafy_scene()));
    let cameras = [(0.0, 60.0), (0.7, 110.0), (-1.2, 15.0)]
        .map(|(x, fov)| Camera::look_at(dvec(x, 1.1, 3.0), dvec(0.1, 1.0, 0.0), fov));
    let counts = compared(&tracer, &cameras, SIZE);
    assert!(counts.met > 1000 && counts.met + 1000 < counts.all);
    assert!(counts.traced as usize * 10 < counts.all * 9, "{} of {}", counts.traced, counts.all);
}

/// Needles, slivers and triangles smaller than a pixel, near and far.
#[test]
fn a_heap_of_needles() {
    let mut b = SceneBuilder::new("needles");
    let matte = matte(&mut b);
    for i in 0..4000 {
        let [size, thickness, side, _] = random(i, 6);
        let (centre, long) = (random_point(i, 4), random_point(i, 5) * size);
        let short = random_point(i, 7) * side * thickness.powi(6) * 0.1;
        add_triangle(&mut b, [centre, centre + long, centre + long + short], matte);
    }
    cuboid(&mut b, DVec3::splat(1.5), DVec3::splat(1.6), matte, false);
    quad(&mut b, dvec(-1.0, -1.0, -2.0), DVec3::X, DVec3::Y, matte);
    let tracer = tracer_of(b);
    let mut cameras = random_cameras(8, 1.0);
    cameras.push(Camera::look_at(dvec(40.0, 3.0, 1.0), DVec3::ZERO, 4.0));
    assert!(compared(&tracer, &cameras, SIZE).met > 1000);
}

/// More triangles under a bin than it may enter: it is left to single rays.
#[test]
fn a_crowd_under_every_pixel() {
    let mut b = SceneBuilder::new("crowd");
    let matte = matte(&mut b);
    for i in 0..120_000 {
        let [x, y, z, _] = random(i, 8);
        let (at, size) = (dvec(x, y, z) - 0.5, 0.01);
        add_triangle(&mut b, [at, at + random_point(i, 9) * size, at + random_point(i, 10) * size], matte);
    }
    let tracer = tracer_of(b);
    let camera = Camera::look_at(dvec(0.1, 0.2, 30.0), DVec3::ZERO, 2.0);
    let counts = compared(&tracer, &[camera], [40, 40]);
    assert!(counts.met > 500 && counts.traced as usize >= counts.all, "{} met", counts.met);
}

#[test]
fn any_number_of_threads() {
    let tracer = soup(2000, 1.0, DVec3::ZERO);
    let view = View::new(&random_cameras(3, 1.0)[2], &tracer.scene().frame, [200, 130]);
    let find = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut visible = VisibilityBuffer::default();
        pool.install(|| visible.find(&tracer, &view, false));
        visible
    };
    assert_eq!(find(1), find(3));
}
