//! Lights that do not reach a cell cost nothing there, and culling them changes no visible light.

use crate::rooms::{cuboid, dvec, quad};
use afterimage::scene::{Material, Scene, SceneBuilder};
use afterimage::trace::{RayCounts, TraceSettings};
use afterimage::{Camera, FrameRequest, Mode, RenderSettings, Renderer, Tracer};
use glam::Vec3;
use std::sync::Arc;

/// A row of closed cells of 3 x 3 x 3 m with a lamp in each; the first two are joined by a doorway.
fn row_of_rooms(rooms: u32) -> Scene {
    let mut b = SceneBuilder::new("row");
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.6)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(6.0)));
    let length = 3.0 * f64::from(rooms);
    cuboid(&mut b, dvec(0.0, 0.0, 0.0), dvec(length, 3.0, 3.0), wall, true);
    for room in 0..rooms {
        let x = 3.0 * f64::from(room);
        quad(&mut b, dvec(x + 1.0, 2.9, 1.0), dvec(1.0, 0.0, 0.0), dvec(0.0, 0.0, 1.0), lamp);
        let front = if room == 1 { 1.2 } else { 0.0 };
        if room > 0 {
            cuboid(&mut b, dvec(x - 0.1, 0.0, front), dvec(x + 0.1, 3.0, 3.0), wall, false);
        }
    }
    b.finish().unwrap()
}

fn shadow_rays_and_radiance(rooms: u32) -> (RayCounts, Vec<Vec3>) {
    let tracer = Tracer::new(Arc::new(row_of_rooms(rooms)));
    let camera = Camera::look_at(dvec(0.4, 1.6, 2.5), dvec(3.0, 1.2, 0.8), 75.0);
    let settings =
        RenderSettings { mode: Mode::Full, trace: TraceSettings { samples: 4, ..Default::default() } };
    let mut renderer = Renderer::default();
    let frame = renderer.render(&FrameRequest::new(&tracer, &camera, [96, 72], &settings));
    (frame.stats.rays, frame.radiance.clone())
}

#[test]
fn time_does_not_grow_with_lights_in_closed_rooms() {
    let (few, _) = shadow_rays_and_radiance(4);
    let (many, _) = shadow_rays_and_radiance(40);
    // The size of cells is relative to that of the scene, so the longer row has coarser cells:
    // allow a factor of 2, not of 10.
    assert!(many.shadow < 2 * few.shadow, "{} shadow rays for 40 rooms, {} for 4", many.shadow, few.shadow);
}

#[test]
fn culled_lights_bring_no_light() {
    let rooms = 12;
    let scene = row_of_rooms(rooms);
    let (_, culled) = shadow_rays_and_radiance(rooms);
    let tracer = Tracer::new(Arc::new(scene));
    let camera = Camera::look_at(dvec(0.4, 1.6, 2.5), dvec(3.0, 1.2, 0.8), 75.0);
    let view = afterimage::View::new(&camera, &tracer.scene().frame, [96, 72]);
    // Render every light on its own and add them up: light is additive, and a scene of one light
    // culls none.
    let mut sum = vec![Vec3::ZERO; view.pixel_count()];
    for light in 0..tracer.scene().lights.len() {
        let mut one = (**tracer.scene()).clone();
        one.lights = vec![one.lights[light].clone()];
        one.materials.iter_mut().for_each(|m| m.emission = Vec3::ZERO);
        let tracer = Tracer::new(Arc::new(one));
        let trace = TraceSettings { samples: 64, ..Default::default() };
        for (pixel, sum) in sum.iter_mut().enumerate().step_by(7) {
            *sum += tracer.pixel(&view, pixel as u32, &trace, &mut RayCounts::default()).radiance;
        }
    }
    let compared = || culled.iter().zip(&sum).step_by(7).filter(|(_, s)| s.x < 1.0);
    let mean = |f: &dyn Fn(Vec3, Vec3) -> f32| {
        compared().map(|(c, s)| f(*c, *s)).sum::<f32>() / compared().count() as f32
    };
    let (with, without) = (mean(&|c, _| c.x), mean(&|_, s| s.x));
    // With 64 and 4 samples, the noise of the mean of some thousand pixels is well below this.
    assert!((with / without - 1.0).abs() < 0.01, "mean radiance {with} with culling, {without} without");
}

#[test]
fn culled_lights_are_counted() {
    let tracer = Tracer::new(Arc::new(row_of_rooms(12)));
    let camera = Camera::look_at(dvec(0.4, 1.6, 2.5), dvec(3.0, 1.2, 0.8), 75.0);
    let settings =
        RenderSettings { mode: Mode::Full, trace: TraceSettings { samples: 1, ..Default::default() } };
    Renderer::default().render(&FrameRequest::new(&tracer, &camera, [32, 24], &settings));
    let cuts = tracer.light_grid().cuts();
    assert_eq!(cuts.lights, 12);
    assert!(cuts.cells > 0 && cuts.kept_mean >= 1.0 && cuts.kept_mean < 4.0, "{cuts:?}");
}
