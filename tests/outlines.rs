//! Lines along the edges of surfaces: where they are, and how wide.

use crate::rooms::{cuboid, dvec, quad};
use afterimage::render::outlines::{outlines_of_frame, outlines_of_view};
use afterimage::scene::{Material, MaterialId, SceneBuilder};
use afterimage::trace::section::CutPlane;
use afterimage::{Camera, FrameRequest, RenderSettings, Renderer, Tracer};
use glam::{DVec3, Vec3};
use std::sync::Arc;

const SIZE: [u32; 2] = [200, 120];

fn tracer(add: impl FnOnce(&mut SceneBuilder, MaterialId)) -> Tracer {
    let mut b = SceneBuilder::new("outlines");
    let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
    add(&mut b, grey);
    Tracer::new(Arc::new(b.finish().unwrap()))
}

/// Pixels that lines cover in all.
fn covered(tracer: &Tracer, camera: &Camera, width: u32) -> f32 {
    outlines_of_view(tracer, camera, SIZE, width).iter().sum()
}

/// A wall of two quads has lines around it, none between, as wide in pixels as they should be.
#[test]
fn lines_go_around_a_surface_and_are_as_wide_as_asked_for() {
    let wall = tracer(|b, m| {
        quad(b, dvec(-1.0, -0.8, 0.0), dvec(1.0, 0.0, 0.0), dvec(0.0, 1.6, 0.0), m);
        quad(b, dvec(0.0, -0.8, 0.0), dvec(1.0, 0.0, 0.0), dvec(0.0, 1.6, 0.0), m);
    });
    for distance in [3.0, 6.0] {
        let camera = Camera::look_at(dvec(0.0, 0.0, distance), DVec3::ZERO, 40.0);
        let pixels_per_m = 120.0 / (2.0 * distance * 20f64.to_radians().tan());
        for width in [1, 2, 4] {
            let expected = f64::from(width) * 7.2 * pixels_per_m;
            let found = f64::from(covered(&wall, &camera, width));
            assert!((found / expected - 1.0).abs() < 0.06, "{width}: {found} of {expected} at {distance}");
        }
    }
}

/// A floor has no lines at any angle, a fold has one, and a step of depth has one.
#[test]
fn a_plane_has_no_lines_however_it_is_seen() {
    let add_floor = |b: &mut SceneBuilder, m| {
        quad(b, dvec(-500.0, 0.0, 500.0), dvec(1000.0, 0.0, 0.0), dvec(0.0, 0.0, -1000.0), m);
    };
    // Looks down at the floor, without its end.
    for pitch in [0.3, 0.6, 1.2] {
        let camera = Camera::look_at(dvec(0.0, 1.6, 0.0), dvec(0.0, 1.6 - pitch, -1.0), 20.0);
        assert_eq!(covered(&tracer(add_floor), &camera, 2), 0.0, "{pitch}");
        let with_box = tracer(|b, m| {
            add_floor(b, m);
            cuboid(b, dvec(-0.1, 0.0, -1.9), dvec(0.1, 0.3, -1.7), m, false);
        });
        let at_box = Camera::look_at(dvec(0.0, 1.6, 0.0), dvec(0.0, 0.1, -1.8), 20.0);
        assert!(covered(&with_box, &at_box, 1) > 150.0);
    }
}

/// A cap is a surface of its own: the lines around it are those of the face that it takes the place
/// of. A frame has its lines where the view has them.
#[test]
fn sections_and_frames_have_lines_too() {
    let cube = tracer(|b, m| cuboid(b, dvec(-1.0, -1.0, -1.0), dvec(1.0, 1.0, 1.0), m, false));
    let cut = cube.with_section(&[CutPlane { axis: 0, at_m: 0.5, keeps_above: false }], [1.0, 0.0]);
    let camera = Camera::look_at(dvec(6.0, 2.0, 3.0), DVec3::ZERO, 30.0);
    for tracer in [&cube, &cut] {
        let view = outlines_of_view(tracer, &camera, SIZE, 1);
        let settings = RenderSettings::default();
        let mut renderer = Renderer::default();
        let frame = renderer.render(&FrameRequest::new(tracer, &camera, SIZE, &settings));
        let marked = outlines_of_frame(tracer, frame);
        let count = marked.iter().filter(|is_line| **is_line).count() as f32;
        let sum: f32 = view.iter().sum();
        assert!(sum > 300.0 && (count / sum - 1.0).abs() < 0.25, "{count} and {sum}");
        let apart = marked.iter().zip(&view).filter(|(is_line, covered)| **is_line && **covered == 0.0);
        let apart = apart.count() as f32;
        assert!(apart < 0.25 * count, "{apart} of {count}");
    }
}
