//! The hits of a tile of rays against those of each ray alone, its slow twin: the bits are the
//! same.

use crate::rooms::{cuboid, dvec, leafy_scene, quad, room_camera, room_tracer};
use afterimage::math::key::Key;
use afterimage::scene::{Material, SceneBuilder};
use afterimage::trace::{Hit, TILE_RAYS, TILE_SIDE, TileHits, primary_tile};
use afterimage::{Camera, Tracer, View};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// True for a hit exactly on an edge, where the triangle test and the boxes above it may disagree.
fn is_on_edge(hit: Option<Hit>) -> bool {
    hit.is_some_and(|h| h.b1 == 0.0 || h.b2 == 0.0 || h.b1 + h.b2 >= 1.0)
}

/// Compares every pixel of a picture. Returns the number of rays that hit a surface, and of those
/// that hit none.
fn assert_same(tracer: &Tracer, camera: &Camera, size: [u32; 2]) -> [usize; 2] {
    let view = View::new(camera, &tracer.scene().frame, size);
    let (mut tile, mut hits) = (primary_tile(&view, [0, 0]), TileHits::NONE);
    let (mut counts, mut grazing) = ([0; 2], 0);
    for y0 in (0..size[1]).step_by(TILE_SIDE) {
        for x0 in (0..size[0]).step_by(TILE_SIDE) {
            tracer.closest_in_tile(&view, [x0, y0], &mut tile, &mut hits);
            for ray in 0..TILE_RAYS {
                let (x, y) = (x0 + (ray % TILE_SIDE) as u32, y0 + (ray / TILE_SIDE) as u32);
                if x >= size[0] || y >= size[1] {
                    continue;
                }
                let bits = |h: Hit| (h.triangle, [h.t, h.b1, h.b2].map(f32::to_bits));
                let (together, alone) =
                    (hits.hit(ray), tracer.closest(&Tracer::primary_ray(&view, y * size[0] + x)));
                counts[usize::from(alone.is_none())] += 1;
                if together.map(bits) != alone.map(bits) {
                    grazing += 1;
                    let is_grazing = is_on_edge(together) || is_on_edge(alone);
                    assert!(is_grazing, "({x}, {y}) of {size:?}, {camera:?}: {together:?}, alone {alone:?}");
                }
            }
        }
    }
    assert!(grazing * 500 <= counts[0] + counts[1], "{grazing} rays of {counts:?} on edges");
    counts
}

/// A camera in the room with a given direction and field of view.
fn turned(yaw_deg: f64, pitch_deg: f64, fov_y_deg: f64) -> Camera {
    let fov_y = fov_y_deg.to_radians();
    // The eye lies in the plane of no wall.
    let eye = dvec(0.213, 1.517, 3.489);
    Camera { eye, yaw: yaw_deg.to_radians(), pitch: pitch_deg.to_radians(), fov_y, roll: 0.0 }
}

#[test]
fn ragged_pictures() {
    let tracer = room_tracer(true, true);
    let mut met = 0;
    for size in [[1, 1], [7, 5], [8, 8], [9, 17], [64, 3], [3, 40], [61, 47]] {
        met += assert_same(&tracer, &room_camera(), size)[0];
    }
    assert!(met > 3000, "{met}");
}

#[test]
fn extreme_views() {
    let tracer = room_tracer(true, true);
    for fov in [1.0, 20.0, 90.0, 150.0, 170.0] {
        for (yaw, pitch) in [(0.0, 0.0), (90.0, 90.0), (45.0, -90.0), (180.0, 10.0), (-30.0, 35.26)] {
            let [met, missed] = assert_same(&tracer, &turned(yaw, pitch, fov), [40, 24]);
            assert!(met > 900 && missed < 60, "{met} met and {missed} missed in a closed room");
        }
    }
}

#[test]
fn views_from_outside_and_from_far_away() {
    let tracer = room_tracer(false, false);
    for (distance, fov) in [(16.0, 70.0), (60.0, 20.0), (5000.0, 1.0)] {
        for eye in [DVec3::X, DVec3::ONE, dvec(0.3, 1.0, 0.0), DVec3::NEG_Z] {
            let camera = Camera::look_at(eye * distance, dvec(0.0, 1.5, 0.0), fov);
            let [met, missed] = assert_same(&tracer, &camera, [48, 40]);
            assert!(met > 0 && missed > 0, "{met} met, {missed} missed at {distance} m");
        }
    }
}

/// Eyes in the plane of a wall, at a corner and on an edge, where planes through the eye are
/// degenerate.
#[test]
fn eyes_on_surfaces() {
    let tracer = room_tracer(false, false);
    for eye in [dvec(-1.5, 1.2, -1.5), dvec(-0.5, 1.2, -1.0), dvec(0.6, 2.0, -0.25), dvec(0.0, 0.0, 0.0)] {
        for at in [dvec(3.0, 1.0, 3.0), dvec(-3.0, 2.0, -4.0), dvec(0.0, 3.0, 0.1)] {
            assert_same(&tracer, &Camera::look_at(eye, at, 100.0), [40, 40]);
        }
    }
}

#[test]
fn cut_out_textures() {
    let tracer = Tracer::new(Arc::new(leafy_scene()));
    let [mut met, mut missed] = [0; 2];
    for (x, fov) in [(0.0, 60.0), (0.7, 110.0), (-1.2, 15.0)] {
        let camera = Camera::look_at(dvec(x, 1.1, 3.0), dvec(0.1, 1.0, 0.0), fov);
        let counts = assert_same(&tracer, &camera, [75, 51]);
        (met, missed) = (met + counts[0], missed + counts[1]);
    }
    assert!(met > 1000 && missed > 1000, "{met} met, {missed} missed");
}

/// Needles, slivers and triangles smaller than a pixel, near and far.
#[test]
fn a_heap_of_needles() {
    let mut b = SceneBuilder::new("needles");
    let matte = b.add_material(Material::diffuse("matte", Vec3::ONE));
    let random = |i: u32, k: u32| {
        let [[x, y], [z, w]] = [0, 1].map(|d| Key::of_pixel(7, i).with(4 * k + d).pair());
        (DVec3::new(x.into(), y.into(), z.into()) * 2.0 - 1.0, f64::from(w))
    };
    for i in 0..4000 {
        let ((centre, size), (way, thickness), (side, _)) = (random(i, 0), random(i, 1), random(i, 2));
        let (long, short) = (way * size, side * thickness.powi(6) * 0.1);
        let corners = [centre, centre + long, centre + long + short];
        let vertices = corners.map(|p| b.add_vertex(p, Vec3::ZERO, Vec2::ZERO));
        b.add_triangle(vertices, matte);
    }
    cuboid(&mut b, DVec3::splat(1.5), DVec3::splat(1.6), matte, false);
    quad(&mut b, dvec(-1.0, -1.0, -2.0), DVec3::X, DVec3::Y, matte);
    let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
    for (eye, fov) in [(dvec(0.0, 0.1, 3.0), 50.0), (dvec(0.2, 0.1, 0.3), 100.0), (dvec(40.0, 3.0, 1.0), 4.0)]
    {
        let [met, missed] = assert_same(&tracer, &Camera::look_at(eye, DVec3::ZERO, fov), [70, 50]);
        assert!(met > 100 && missed + met == 3500, "{met} met, {missed} missed");
    }
}
